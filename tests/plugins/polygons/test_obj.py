from __future__ import annotations

import numpy as np
import pytest
from orbiframe_polygons.obj_reader import read
from orbiframe_polygons.obj_writer import write
from written import written

from orbiframe import FormatError, Polyhedron
from orbiframe.testing import contract_tests

test_reader_laws = contract_tests("reader", read, suffix=".obj", counterpart=write)
test_writer_laws = contract_tests("writer", write, suffix=".obj", counterpart=read)

POINTS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
PLAIN = POINTS + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
TETRAHEDRON = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


def of(tmp_path, content: str):
    return written(tmp_path / "mesh.obj", content)


@pytest.mark.parametrize(
    "content",
    [
        PLAIN,
        "\ufeff# é\n" + PLAIN.replace("\n", "\r\n"),
        PLAIN.replace("\n", "\r").rstrip("\r"),
        POINTS + "f -4 -2 -3\nf -4 -3 -1\nf -3 -2 -1\nf -2 -4 -1\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -1 -2\nv 0 0 1\nf 1 2 4\nf -3 -2 -1\nf -2 -4 -1\n",
        "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n" + POINTS,
        PLAIN.replace("f 1 3 2", "f 1 \\\n 3 \\\n2"),
        "mtllib ../../secret.mtl\no a\ng b c\ns off\nusemtl red\nvt 0 0\nvp 1\nl 1 2\np 1\n" + PLAIN,
        "vt 0 0\nvn 0 0 1\n" + PLAIN.replace("f 1 3 2", "f 1/1 3//1 2/1/1").replace("f 2 3 4", "  f\t2/ 3/-1 4/1/-1"),
        PLAIN.replace("v 1 0 0", "v 1 0 0 1.0"),
    ],
)
def test_one_mesh_in_many_spellings(tmp_path, content):
    found = read(of(tmp_path, content))
    assert np.array_equal(found.vertices, np.vstack([np.zeros(3), np.eye(3)]))
    assert found.triangles.tolist() == TETRAHEDRON
    assert found.normals is None


def test_colours_after_the_coordinates(tmp_path):
    colored = "v 0 0 0 1 0 0\nv 1 0 0 0 0.5 0\nv 0 1 0 0 0 1\nf 1 2 3\n"
    found = read(of(tmp_path, colored))
    assert np.array_equal(found.colors, [[1, 0, 0], [0, 0.5, 0], [0, 0, 1]])


def test_normals_are_kept_where_the_corners_of_a_vertex_agree(tmp_path):
    normals = "vn 0 0 -1\nvn 1 0 0\nvn 0 1 0\nvn 0 0 1\n"
    smooth = POINTS + normals + "f 1//1 3//3 2//2\nf 1//1 2//2 4//4\n"
    assert np.array_equal(read(of(tmp_path, smooth)).normals, [[0, 0, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert read(of(tmp_path, smooth.replace("f 1//1 2//2", "f 1//1 2//1"))).normals is None


@pytest.mark.parametrize(
    ("content", "place"),
    [
        ("", "no faces"),
        (POINTS, "no faces"),
        ("hello\n" + PLAIN, "line 1.*'hello'"),
        (PLAIN.replace("f 2 3 4", "f 2 3 5"), "line 7.*face 2 names vertex 4.*only 4"),
        (PLAIN.replace("f 2 3 4", "f 2 0 4"), "line 7.*index 0"),
        (PLAIN.replace("f 2 3 4", "f 2 -9 4"), "line 7.*names vertex -5"),
        (PLAIN.replace("f 2 3 4", "f 2 3"), "line 7.*2 corners"),
        (PLAIN.replace("f 2 3 4", "f 2 3 x"), "line 7.*'x'"),
        (PLAIN.replace("f 2 3 4", "f 2 3/1/1/1 4"), "line 7.*'3/1/1/1'"),
        (PLAIN.replace("f 2 3 4", "f 2 /3 4/1"), "line 7.*'/3'"),
        (PLAIN.replace("f 2 3 4", "f 2.5 3 4"), "line 7.*2.5"),
        (PLAIN.replace("f 2 3 4", "f 2 3 \\\n5"), "line 7.*names vertex 4"),
        (PLAIN.replace("f 2 3 4", "f 2 3 99999999999999999999"), "line 7"),
        (POINTS + "vn 0 0 1\nf 1//1 2//2 3//1\n", "line 6.*names normal 1"),
        (PLAIN.replace("v 1 0 0", "v 1 0"), "line 2.*2 numbers"),
        (PLAIN.replace("v 1 0 0", "v 1 nan 0"), "line 2.*'nan'"),
        (PLAIN.replace("v 1 0 0", "v 1 0 1e400"), "line 2.*'1e400'"),
        (PLAIN.replace("v 1 0 0", "v 1 0 0\n\n# c\nv 1 zero 0"), "line 5.*'zero'"),
        ("vn 0 1\n" + PLAIN, "line 1.*2 numbers"),
        (PLAIN + "cstype bezier\n", "line 9.*'cstype'"),
        (PLAIN + "\0", "line 9.*zero byte"),
    ],
)
def test_bad_files_are_refused_with_their_place(tmp_path, content, place):
    with pytest.raises(FormatError, match=f"mesh.obj.*{place}"):
        read(of(tmp_path, content))


def test_normals_and_colours_survive_and_the_rest_is_named(tmp_path):
    rng = np.random.default_rng(3)
    tables = {"normals": rng.normal(size=(5, 3)), "colors": rng.random((5, 3)), "face_colors": rng.random((2, 3))}
    made = Polyhedron.from_corners(rng.normal(size=(5, 3)), [0, 5, 8], [2, 3, 4, 0, 1, 2, 1, 0], **tables)
    with pytest.warns(UserWarning, match=r"a\.obj: OBJ files hold no colours of faces"):
        write(tmp_path / "a.obj", made)
    found = read(tmp_path / "a.obj")
    for table in ("vertices", "offsets", "tail", "normals", "colors"):
        assert np.array_equal(getattr(found, table), getattr(made, table)), table
