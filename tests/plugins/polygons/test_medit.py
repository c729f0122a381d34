from __future__ import annotations

import struct

import meshio
import numpy as np
import pytest
from orbiframe_polygons.elements.medit_reader import read
from small_meshes import CUBE, QUADS, TRIANGLES, lists, words
from written import written

from orbiframe import FormatError


def table(name: str, rows: list[str]) -> str:
    return "\n".join([name, str(len(rows)), *rows, ""])


HEAD = "MeshVersionFormatted 2\nDimension 3\n"
VERTICES = table("Vertices", [f"{row} 0" for row in words(CUBE)])
FACES = table("Quadrilaterals", [f"{row} 7" for row in words(QUADS, first=1)])
PLAIN = HEAD + VERTICES + FACES + "End\n"
MMG = "".join(
    table(name, rows)
    for name, rows in {
        "Corners": ["1", "2"], "Ridges": ["1"], "RequiredVertices": ["1"], "RequiredEdges": ["1"],
        "RequiredTriangles": [], "Normals": ["0 0 1"], "NormalAtVertices": ["1 1"], "Tangents": ["1 0 0"],
        "TangentAtVertices": ["2 1"],
    }.items()
)  # fmt: skip


def of(tmp_path, content: str | bytes, suffix: str = ".mesh"):
    return written(tmp_path / f"a{suffix}", content)


@pytest.mark.parametrize(
    "content",
    [
        PLAIN,
        PLAIN.replace("\n", " "),
        PLAIN.replace("\n", "\r\n"),
        PLAIN.replace("Dimension 3", "Dimension\n3 # in space"),
        PLAIN.replace("Quadrilaterals", "quadrilaterals").replace("End", "END"),
        PLAIN.replace("End", MMG + "End"),
        PLAIN.replace("Quadrilaterals", MMG + "Quadrilaterals"),
        PLAIN.replace("1 0 0 0\n", "1e0 0 0.0 0\n"),
    ],
)
def test_one_cube_in_many_spellings(tmp_path, content):
    found = read(of(tmp_path, content))
    assert found.vertices.tolist() == CUBE
    assert lists(found) == QUADS


def test_edges_and_solids_are_left_out_and_said(tmp_path):
    more = table("Edges", ["1 2 0"]) + table("Tetrahedra", ["1 2 3 6 0"])
    with pytest.warns(UserWarning, match="1 edges, 1 tetrahedra; left out"):
        assert lists(read(of(tmp_path, PLAIN.replace("End", more + "End")))) == QUADS


def test_the_plane(tmp_path):
    content = "MeshVersionFormatted 1 Dimension 2 Vertices 3 0 0 0 1 0 0 0 1 0 Triangles 1 1 2 3 0 End"
    assert read(of(tmp_path, content)).vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def binary(order: str, version: int) -> bytes:
    """The cube with corners and required vertices, as libMeshb writes it."""
    wide, place = ("q" if version == 4 else "i"), ("q" if version > 2 else "i")
    real = "f" if version == 1 else "d"
    made = struct.pack(f"{order}2i", 1, version)
    made += struct.pack(f"{order}i{place}i", 3, len(made) + 8 + struct.calcsize(f"={place}"), 3)
    for code, rows, kinds in (
        (4, [(*p, 0) for p in CUBE], f"3{real}{wide}"),
        (13, [(1,), (2,)], wide),
        (15, [(3,)], wide),
        (7, [(*(n + 1 for n in q), 7) for q in QUADS], f"5{wide}"),
    ):
        body = b"".join(struct.pack(f"{order}{kinds}", *row) for row in rows)
        following = len(made) + 4 + struct.calcsize(f"={place}{wide}") + len(body)
        made += struct.pack(f"{order}i{place}{wide}", code, following, len(rows)) + body
    return made + struct.pack(f"{order}i{place}", 54, 0)


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("version", [1, 2, 3, 4])
def test_binary_in_every_version(tmp_path, order, version):
    content = binary(order, version)
    found = read(of(tmp_path, content, ".meshb"))
    assert found.vertices.tolist() == CUBE
    assert lists(found) == QUADS
    for size in range(4, len(content), 13):
        with pytest.raises(FormatError, match=r"a\.meshb, byte"):
            read(of(tmp_path, content[:size], ".meshb"))


def test_what_meshio_writes(tmp_path):
    for suffix in (".mesh", ".meshb"):
        meshio.write(tmp_path / f"a{suffix}", meshio.Mesh(np.array(CUBE, float), [("triangle", np.array(TRIANGLES))]))
        assert lists(read(tmp_path / f"a{suffix}")) == TRIANGLES


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "line 1.*MeshVersionFormatted"),
        ("3 " + PLAIN, "line 1.*MeshVersionFormatted"),
        (PLAIN.replace("End", ""), "without 'End'"),
        (PLAIN + "1\n", "goes on after End"),
        (PLAIN + VERTICES, "goes on after End"),
        (PLAIN.replace("End", VERTICES + "End"), "Vertices stands twice"),
        (PLAIN.replace("Dimension 3", "Dimension 4"), "Dimension"),
        (PLAIN.replace("Vertices\n8", "Vertices\n9"), "line 3.*9.*rows.*32 numbers follow"),
        (PLAIN.replace("Vertices\n8", "Vertices\n-8"), "line 3"),
        (PLAIN.replace("1 4 3 2 7", "1 4 3 9 7"), "node 9"),
        (PLAIN.replace("1 4 3 2 7", "1 4 3 2.5 7"), "line 13.*2.5"),
        (PLAIN.replace("1 0 0 0", "1 nan 0 0"), "nan"),
        (PLAIN.replace("Quadrilaterals", "QuadrilateralsQ2"), "QuadrilateralsQ2.*not read"),
        (PLAIN.replace("End", 'IncludeFile "other.mesh"\nEnd'), "IncludeFile"),
        (PLAIN.replace("End", "Transformation 1 1\nEnd"), "Transformation.*not read"),
        (HEAD + VERTICES + "End", "no triangles"),
    ],
)
def test_what_is_not_so_is_refused_with_its_place(tmp_path, content, said):
    with pytest.raises(FormatError, match=rf"a\.mesh.*{said}"):
        read(of(tmp_path, content))
