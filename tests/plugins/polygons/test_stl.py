from __future__ import annotations

import struct
from functools import partial

import numpy as np
import pytest
from orbiframe_polygons import stl_reader
from orbiframe_polygons.stl_reader import read
from orbiframe_polygons.stl_writer import write
from written import written

from orbiframe import FormatError, Polyhedron
from orbiframe.testing import contract_tests

test_reader_laws = contract_tests("reader", read, suffix=".stl", counterpart=write)
test_writer_laws = contract_tests("writer", write, suffix=".stl", counterpart=read)
test_text_writer_laws = contract_tests("writer", write, params={"ascii": True}, suffix=".stl", counterpart=read)
test_text_reader_laws = contract_tests("reader", read, suffix=".stl", counterpart=partial(write, ascii=True))

CORNERS = [[(0, 0, 0), (0, 1, 0), (1, 0, 0)], [(0, 0, 0), (1, 0, 0), (0, 0, 1)], [(1, 0, 0), (0, 1, 0), (0, 0, 1)]]


def binary(corners, count=None, head=b"solid of lies") -> bytes:
    records = b"".join(struct.pack("<12fH", 0, 0, 0, *np.ravel(c), 0) for c in corners)
    return head.ljust(80, b" ") + struct.pack("<I", len(corners) if count is None else count) + records


def text(corners) -> str:
    facets = [
        "facet normal 0 0 0\n outer loop\n"
        + "".join(f"  vertex {x} {y} {z}\n" for x, y, z in c)
        + " endloop\nendfacet\n"
        for c in corners
    ]
    return "solid a b\n" + "".join(facets) + "endsolid a b\n"


PLAIN = text(CORNERS)


def of(tmp_path, content):
    return written(tmp_path / "mesh.stl", content)


@pytest.mark.parametrize(
    "content",
    [
        binary(CORNERS),
        PLAIN,
        PLAIN.upper(),
        PLAIN.replace("\n", "\r\n"),
        "\ufeff" + PLAIN,
        text(CORNERS[:1]) + "\n" + text(CORNERS[1:]),
        PLAIN.replace("vertex 0 0 0", "vertex -0.0 0e5 0", 1),
    ],
)
def test_equal_corners_become_one_vertex_in_the_order_of_the_file(tmp_path, content):
    found = read(of(tmp_path, content))
    assert found.vertices.tolist() == [[0, 0, 0], [0, 1, 0], [1, 0, 0], [0, 0, 1]]
    assert found.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [2, 1, 3]]


def test_corners_that_differ_in_the_last_bit_stay_apart(tmp_path):
    near = float(np.nextafter(np.float32(1), np.float32(2)))
    found = read(of(tmp_path, binary([CORNERS[0], [(0, 0, 0), (near, 0, 0), (0, 0, 1)]])))
    assert len(found.vertices) == 5


@pytest.mark.parametrize(
    ("content", "place"),
    [
        (b"", "starts with 'solid'"),
        (b"hello", "starts with 'solid'"),
        (binary(CORNERS)[:-1], "byte 80.*count 3.*cut short"),
        (binary(CORNERS) + b"x", "byte 80.*count 3"),
        (binary(CORNERS, count=4_000_000_000), "byte 80.*count 4000000000"),
        (binary([]), "no triangles"),
        (binary([*CORNERS, [(0, 0, 0), (np.nan, 0, 0), (0, 0, 1)]]), "byte 234.*nan"),
        ("solid a\nendsolid a\n", "no triangles"),
        (PLAIN[:-20], "endsolid"),
        (PLAIN[: PLAIN.index("endfacet")] + "endsolid\n", "line 7.*not complete"),
        (PLAIN.replace(" endloop\n", "", 1), "line 7.*'endloop'"),
        (PLAIN.replace("vertex 0 1 0", "vertex 0 1", 1), "line 5.*'vertex' with 3 words"),
        (PLAIN.replace("vertex 0 1 0", "vertex 0 1 inf", 1), "line 5.*'inf'"),
        (PLAIN.replace("vertex 0 1 0", "vertex 0 one 0", 1), "line 5.*'one'"),
        (PLAIN.replace("vertex 0 1 0", "vortex 0 1 0", 1), "line 5.*vortex"),
        (PLAIN + "facet\n", "outside"),
    ],
)
def test_bad_files_are_refused_with_their_place(tmp_path, content, place):
    with pytest.raises(FormatError, match=f"mesh.stl.*{place}"):
        read(of(tmp_path, content))


def test_normals_of_facets_are_those_of_the_right_hand_rule(tmp_path):
    write(
        tmp_path / "a.stl",
        Polyhedron.from_faces([[0, 0, 0], [2, 0, 0], [0, 3, 0], [0, 0, 0.5]], [[0, 1, 2], [0, 3, 1]]),
    )
    data = (tmp_path / "a.stl").read_bytes()
    assert struct.unpack("<3f", data[84:96]) == (0, 0, 1)
    assert struct.unpack("<3f", data[134:146]) == (0, 1, 0)


@pytest.mark.parametrize(
    ("vertices", "faces", "complaint"),
    [
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]], "face 0 has 4 corners.*triangulate"),
        ([[0, 0, 0], [1e150, 0, 0], [0, 1, 0]], [[0, 1, 2]], "float32"),
        ([[1, 0, 0], [1 + 1e-12, 0, 0], [0, 1, 0]], [[0, 1, 2]], "float32"),
    ],
)
def test_what_stl_cannot_hold_is_refused(tmp_path, vertices, faces, complaint):
    with pytest.raises(FormatError, match=f"a.stl.*{complaint}"):
        write(tmp_path / "a.stl", Polyhedron.from_faces(vertices, faces))
    assert not (tmp_path / "a.stl").exists()


def test_text_keeps_float64(tmp_path):
    made = Polyhedron.from_faces(np.random.default_rng(1).normal(size=(4, 3)), [[0, 1, 2], [0, 2, 3]])
    write(tmp_path / "a.stl", made, ascii=True)
    assert np.array_equal(read(tmp_path / "a.stl").vertices, made.vertices)


@pytest.mark.parametrize("size", [1, 50, 200, 300, 1000])
def test_text_read_in_blocks(tmp_path, monkeypatch, size):
    monkeypatch.setattr(stl_reader, "BLOCK", size)
    twice = text(CORNERS[:1]) + text(CORNERS[1:]).replace("solid a b", "solid endfacet")
    found = read(of(tmp_path, twice))
    assert found.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [2, 1, 3]]
    with pytest.raises(FormatError, match=r"line 19.*'one'"):
        read(of(tmp_path, PLAIN.replace("vertex 1 0 0\n  vertex 0 1 0\n", "vertex 1 0 0\n  vertex 0 one 0\n")))
    with pytest.raises(FormatError, match=r"line 24.*outside"):
        read(of(tmp_path, PLAIN + "facet\n"))


def test_line_ends_and_words_across_pieces(tmp_path, monkeypatch):
    expected = read(of(tmp_path, PLAIN))
    loose = "solid " + "\r\n".join(PLAIN.split()[3:-3]) + "\r\nendsolid"
    for size in (7, 20, 64):
        monkeypatch.setattr(stl_reader, "BLOCK", size)
        for content in (PLAIN.replace("\n", "\r\n"), PLAIN.replace("\n", "\r"), loose):
            found = read(of(tmp_path, content))
            assert np.array_equal(found.tail, expected.tail)
        with pytest.raises(FormatError, match=r"line 5.*'one'"):
            read(of(tmp_path, PLAIN.replace("vertex 0 1 0", "vertex 0 one 0").replace("\n", "\r\n")))
