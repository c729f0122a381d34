from __future__ import annotations

import numpy as np
import pytest
from orbiframe_polygons.off_reader import read
from orbiframe_polygons.off_writer import write
from written import written

from orbiframe import FormatError, Polyhedron
from orbiframe.testing import contract_tests

test_reader_laws = contract_tests("reader", read, suffix=".off", counterpart=write)
test_writer_laws = contract_tests("writer", write, suffix=".off", counterpart=read)

POINTS = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
FACES = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"
PLAIN = "OFF\n4 4 6\n" + POINTS + FACES
TETRAHEDRON = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


def of(tmp_path, content: str | bytes):
    return written(tmp_path / "mesh.off", content)


@pytest.mark.parametrize(
    "content",
    [
        PLAIN,
        PLAIN.replace("OFF\n", "OFF "),
        PLAIN.replace("OFF\n", ""),
        PLAIN.replace("4 4 6", "4 4"),
        PLAIN.replace("\n", "\r\n"),
        PLAIN.replace("\n", "\r"),
        "\ufeff" + PLAIN,
        "# a comment\n\n" + PLAIN.replace("3 0 2 1", "# here too: é\n\t3  0 2\t1 # and here"),
        PLAIN.encode().replace(b"OFF\n", b"OFF\n# latin-1: \xe9\n"),
        PLAIN.rstrip("\n"),
        PLAIN.replace("1 0 0", "1.e0 +0.0 -0"),
    ],
)
def test_one_mesh_in_many_spellings(tmp_path, content):
    found = read(of(tmp_path, content))
    assert np.array_equal(found.vertices, np.vstack([np.zeros(3), np.eye(3)]))
    assert found.triangles.tolist() == TETRAHEDRON


def test_normals_and_colours_in_the_order_of_the_header(tmp_path):
    points = "0 0 0 0 0 1 255 0 51 255\n1 0 0 0 0 1 0 255 0 255\n0 1 0 0 0 1 0 0 255 0\n"
    found = read(of(tmp_path, "CNOFF\n3 2 3\n" + points + "3 0 1 2 1 0.5 0\n3 2 1 0 0 0.25 1\n"))
    assert np.array_equal(found.normals, [[0, 0, 1]] * 3)
    assert np.array_equal(found.colors, [[1, 0, 0.2, 1], [0, 1, 0, 1], [0, 0, 1, 0]])
    assert np.array_equal(found.face_colors, [[1, 0.5, 0], [0, 0.25, 1]])


def test_texture_coordinates_and_colour_indices_are_skipped(tmp_path):
    found = read(of(tmp_path, "STOFF\n3 1 3\n0 0 0 .5 .5\n1 0 0 0 1\n0 1 0 1 0\n3 0 1 2 7\n"))
    assert found.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    assert found.face_colors is None


def test_colours_of_some_faces_only_are_left_out_with_a_warning(tmp_path):
    with pytest.warns(UserWarning, match="left out"):
        assert read(of(tmp_path, PLAIN.replace("3 0 2 1", "3 0 2 1 1 0 0"))).face_colors is None


@pytest.mark.parametrize(
    ("content", "place"),
    [
        ("", "no words"),
        ("OFF\n", "line 1"),
        ("hello\n", "line 1"),
        (PLAIN.replace("OFF", "4OFF"), "line 1.*another dimension"),
        (PLAIN.replace("OFF", "nOFF"), "line 1.*another dimension"),
        (PLAIN.replace("OFF\n", "OFF BINARY\n"), "byte 11.*binary"),
        (PLAIN.replace("4 4 6", "-4 4 6"), "line 2"),
        (PLAIN.replace("4 4 6", "4 4 6 8"), "line 2"),
        (PLAIN.replace("4 4 6", "4000000000 4 6"), "line 2.*cut short"),
        (PLAIN.replace("4 4 6", "4 999999999999999999999 6"), "line 2"),
        (PLAIN[: len(PLAIN) - 9], "line 2.*cut short"),
        (PLAIN + "0 0\n", "line 11.*goes on"),
        (PLAIN.replace("1 0 0", "1 nan 0"), "line 4.*'nan'"),
        (PLAIN.replace("1 0 0", "1 -inf 0"), "line 4.*'-inf'"),
        (PLAIN.replace("1 0 0", "1 1e400 0"), "line 4.*'1e400'"),
        (PLAIN.replace("1 0 0", "1 0x1p3 0"), "line 4.*'0x1p3'"),
        (PLAIN.replace("1 0 0", "1 1d3 0"), "line 4.*'1d3'"),
        (PLAIN.replace("1 0 0", "1 1,5 0"), "line 4.*'1,5'"),
        (PLAIN.replace("1 0 0", "1-2 0 0"), "line 4.*'1-2'"),
        (PLAIN.replace("1 0 0", "1 0"), "line 4.*2 numbers"),
        (PLAIN.replace("3 1 2 3", "3 1 2 4"), "line 9.*face 2 names vertex 4"),
        (PLAIN.replace("3 1 2 3", "3 1 -2 3"), "line 9.*face 2 names vertex -2"),
        (PLAIN.replace("3 1 2 3", "3 1 1.5 3"), "line 9.*1.5"),
        (PLAIN.replace("3 1 2 3", "3 1 99999999999999999999 3"), "line 9"),
        (PLAIN.replace("3 1 2 3", "-3 1 2 3"), "line 9.*-3 corners"),
        (PLAIN.replace("3 1 2 3", "2 1 2"), "line 9.*2 corners"),
        (PLAIN.replace("3 1 2 3", "3000000000 1 2 3"), "line 9"),
        (PLAIN.replace("3 1 2 3", "3 1 2"), "line 9"),
        (PLAIN.replace("3 1 2 3", "3 1 2 3 255 0"), "line 9.*5 numbers after the count 3"),
        (PLAIN.replace("3 1 2 3", "3 1 2 3 1 0 0 1 1"), "line 9.*8 numbers after the count 3"),
        (PLAIN.replace("OFF", "COFF"), "line 3.*6 or 7"),
        (PLAIN.encode("utf-16"), "UTF-16"),
        (PLAIN.encode() + b"\0\0", "line 11.*zero byte"),
    ],
)
def test_bad_files_are_refused_with_their_place(tmp_path, content, place):
    with pytest.raises(FormatError, match=f"mesh.off.*{place}"):
        read(of(tmp_path, content))


def test_all_that_a_polyhedron_has_survives(tmp_path):
    rng = np.random.default_rng(3)
    faces = [[0, 1, 2], [0, 3, 2, 1], [2, 3, 4, 0, 1]]
    tables = {"normals": rng.normal(size=(5, 3)), "colors": rng.random((5, 4)), "face_colors": rng.random((3, 3))}
    made = Polyhedron.from_corners(
        rng.normal(size=(5, 3)), [0, 3, 7, 12], [corner for face in faces for corner in face], **tables
    )
    write(tmp_path / "a.off", made)
    found = read(tmp_path / "a.off")
    for table in ("vertices", "offsets", "tail", *tables):
        assert np.array_equal(getattr(found, table), getattr(made, table)), table


def test_faces_beyond_the_declared_ones_are_left_out_with_a_warning(tmp_path):
    path = tmp_path / "more.off"
    path.write_text(PLAIN.replace("4 4 6", "4 3 6"))
    with pytest.warns(UserWarning, match="line 10: 1 face line more than the 3"):
        assert read(path).face_count == 3
