from __future__ import annotations

import struct
from functools import partial

import numpy as np
import pytest
from corpus.ply_text_files import PLY_HEADER as HEADER
from hypothesis import HealthCheck, given, settings, strategies as st
from orbiframe_polygons.ply_reader import read
from orbiframe_polygons.ply_writer import write
from written import written

from orbiframe import FormatError, Polyhedron
from orbiframe.testing import contract_tests

SPELLINGS = [{"ascii": True}, {}, {"big_endian": True}]

test_reader_laws = contract_tests("reader", read, suffix=".ply", counterpart=write)
test_text_reader_laws = contract_tests("reader", read, suffix=".ply", counterpart=partial(write, ascii=True))
test_writer_laws = contract_tests("writer", write, suffix=".ply", counterpart=read)
test_big_endian_writer_laws = contract_tests(
    "writer", write, params={"big_endian": True}, suffix=".ply", counterpart=read
)

POINTS = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
PLAIN = HEADER + POINTS + "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"
TETRAHEDRON = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
CORNERS = np.vstack([np.zeros(3), np.eye(3)])


def of(tmp_path, content):
    return written(tmp_path / "mesh.ply", content)


def binary(order: str = "<", faces=TETRAHEDRON, rows=CORNERS) -> bytes:
    name = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    body = struct.pack(f"{order}12f", *np.ravel(rows))
    return (
        HEADER.replace("ascii", name).encode()
        + body
        + b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in faces)
    )


@pytest.mark.parametrize(
    "content",
    [
        PLAIN,
        PLAIN.replace("\n", "\r\n"),
        PLAIN.replace("\n", "\r"),
        "\ufeff" + PLAIN.rstrip("\n"),
        PLAIN.replace("comment made by hand", "obj_info é " + "x" * 5_000_000),
        PLAIN.replace("vertex_indices", "vertex_index").replace("uchar", "uint8").replace("float", "float64"),
        binary("<"),
        binary(">"),
        binary("<").replace(b"\n", b"\r\n", HEADER.count("\n")),
    ],
)
def test_one_mesh_in_many_spellings(tmp_path, content):
    found = read(of(tmp_path, content))
    assert np.array_equal(found.vertices, CORNERS)
    assert found.triangles.tolist() == TETRAHEDRON


SKIPPED = """ply
format {} 1.0
element camera 1
property list ushort double pose
property char kind
element vertex 3
property list uchar float weights
property uchar red
property double x
property double y
property ushort green
property double z
property float blue
element edge 0
property int a
element face 2
property float quality
property list uchar uint vertex_indices
property list char short texcoord
end_header
"""


def skipped(order: str) -> bytes:
    rows = [
        ("H2db", 2, 0.5, 0.25, -3),
        ("B2fBddHdf", 2, 9, 9, 255, 1, 2, 65535, 3, 0.5),
        ("B0fBddHdf", 0, 51, 4, 5, 0, 6, 0.25),
        ("B1fBddHdf", 1, 7, 0, 7, 8, 13107, 9, 1),
        ("fB3Ib1h", 0.5, 3, 0, 1, 2, 1, -9),
        ("fB4Ib0h", 0.5, 4, 2, 1, 0, 1, 0),
    ]
    if order:
        return b"".join(struct.pack(order + form, *numbers) for form, *numbers in rows)
    return "".join(" ".join(map(str, numbers)) + "\n" for _, *numbers in rows).encode()


@pytest.mark.parametrize(("name", "order"), [("ascii", ""), ("binary_little_endian", "<"), ("binary_big_endian", ">")])
def test_other_elements_and_lists_are_skipped(tmp_path, name, order):
    found = read(of(tmp_path, SKIPPED.format(name).encode() + skipped(order)))
    assert found.vertices.tolist() == [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    assert found.offsets.tolist() == [0, 3, 7]
    assert found.tail.tolist() == [0, 1, 2, 2, 1, 0, 1]
    assert np.array_equal(found.colors, [[1, 1, 0.5], [0.2, 0, 0.25], [0, 0.2, 1]])


@pytest.mark.parametrize(
    ("content", "place"),
    [
        ("", "line 1"),
        ("plyx\n", "line 1"),
        (HEADER.replace("end_header", ""), "end_header"),
        (HEADER, "element|rows of 'vertex'"),
        (PLAIN.replace("format ascii 1.0\n", ""), "no line 'format'"),
        (PLAIN.replace("ascii 1.0", "ascii 2.0"), "line 2"),
        (PLAIN.replace("property float y", "property float x"), "line 6.*'x' twice"),
        (PLAIN.replace("property float y", "property half y"), "line 6"),
        (PLAIN.replace("property float y", "property list uchar float y"), "line|list"),
        (PLAIN.replace("property float y", "property float u"), "lacks"),
        (PLAIN.replace("element face", "element vertex"), "line 8.*twice"),
        (PLAIN.replace("element vertex 4", "element vertex -4"), "line 4"),
        (PLAIN.replace("element vertex 4", "element vertex 4000000000"), "4000000000 rows.*cut short"),
        (PLAIN.replace("element face 4", "element face 4000000000"), "4000000000 rows.*cut short"),
        (PLAIN.replace("vertex_indices", "corners"), "vertex_indices"),
        (PLAIN.replace("element face", "element facet"), "no element 'face'"),
        (PLAIN[:-9], "cut short"),
        (PLAIN + "0\n", "line 19.*goes on"),
        (PLAIN.replace("1 0 0", "1 nan 0"), "line 12.*'nan'"),
        (PLAIN.replace("1 0 0", "1 1e999 0"), "line 12.*'1e999'"),
        (PLAIN.replace("1 0 0", "1 0"), "line 12"),
        (PLAIN.replace("1 0 0", "1 0 0 0"), "line 12"),
        (PLAIN.replace("3 1 2 3", "3 1 2 4"), "line 17.*face 2 names vertex 4"),
        (PLAIN.replace("3 1 2 3", "-3 1 2 3"), "line 17.*-3"),
        (PLAIN.replace("3 1 2 3", "3000000000 1 2 3"), "line 17"),
        (PLAIN.replace("3 1 2 3", "2 1 2"), "line 17.*2 corners"),
        (PLAIN.replace("3 1 2 3", "3 1 2 2.5"), "line 17.*2.5"),
        (binary()[:-1], "byte"),
        (binary() + b"x", "byte.*goes on"),
        (binary(faces=[[0, 1, 2]] * 3 + [[0, 1, 4]]), "byte.*face 3 names vertex 4"),
        (binary(faces=[[0, 1, 2]] * 3 + [[0, 1]]), "byte.*2 corners"),
        (binary(faces=[[0, 1, 2], [0, 1, 2, 3], [0, 1, 2, 3, 9], [0, 1, 2]]), "byte.*face 2 names vertex 9"),
        (binary(rows=[*CORNERS[:3], [0, np.inf, 0]]), "byte.*inf"),
        (binary().replace(b"property float y", b"property double y"), "byte"),
        (binary().replace(b"vertex 4", b"vertex 4000000000"), "byte.*4000000000 rows"),
        (binary().replace(b"face 4", b"face 999999999999"), "byte.*999999999999 rows"),
        (binary().replace(b"list uchar", b"list int"), "byte"),
        (binary(faces=[[0, 1, 2]] * 4).replace(b"list uchar", b"list char")[:-13] + b"\x80" * 13, "byte.*negative"),
    ],
)
def test_bad_files_are_refused_with_their_place(tmp_path, content, place):
    with pytest.raises(FormatError, match=f"mesh.ply.*({place})"):
        read(of(tmp_path, content))


@pytest.mark.parametrize("options", SPELLINGS)
@pytest.mark.parametrize("levels", [256, 1 << 30])
def test_all_that_a_polyhedron_has_survives(tmp_path, options, levels):
    rng = np.random.default_rng(3)
    faces = [[0, 1, 2], [0, 3, 2, 1], [2, 3, 4, 0, 1], [0, 1, 2]]
    tables = {
        "normals": rng.normal(size=(5, 3)),
        "colors": rng.integers(0, levels, (5, 4)) / (levels - 1),
        "face_colors": rng.integers(0, levels, (4, 3)) / (levels - 1),
    }
    made = Polyhedron.from_corners(
        rng.normal(size=(5, 3)), [0, 3, 7, 12, 15], [corner for face in faces for corner in face], **tables
    )
    write(tmp_path / "a.ply", made, **options)
    found = read(tmp_path / "a.ply")
    for table in ("vertices", "offsets", "tail", *tables):
        assert np.array_equal(getattr(found, table), getattr(made, table)), table


@pytest.mark.parametrize("options", SPELLINGS)
def test_a_face_of_a_thousand_corners(tmp_path, options):
    made = Polyhedron.from_faces(np.random.default_rng(0).normal(size=(1000, 3)), [list(range(1000)), [0, 1, 2]])
    write(tmp_path / "a.ply", made, **options)
    assert np.array_equal(read(tmp_path / "a.ply").tail, made.tail)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data(), order=st.sampled_from(["<", ">"]))
def test_a_damaged_file_is_read_or_refused_and_nothing_else(tmp_path, data, order):
    content = bytearray(binary(order, faces=[[0, 1, 2], [0, 1, 2, 3], [2, 1, 0], [3, 2, 1]]))
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    try:
        found = read(of(tmp_path, bytes(content)))
    except FormatError:
        return
    assert found.tail.max() < len(found.vertices)
