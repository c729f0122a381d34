from __future__ import annotations

import struct

import meshio
import numpy as np
import pytest
from orbiframe_polygons.elements.gmsh_reader import read
from small_meshes import CUBE, QUADS, TRIANGLES, lists, words
from written import written

from orbiframe import FormatError


def section(name: str, *lines: str, end: str = "End") -> str:
    return "\n".join([f"${name}", *lines, f"${end}{name}", ""])


def numbered(rows: list[list[int]], lead: str = "", first: int = 0) -> list[str]:
    return [f"{k + 1} {lead}{row}" for k, row in enumerate(words(rows, first=first))]


MORE = section("PhysicalNames", "1", '2 1 "skin of 3 $ and more"') + section("NodeData", "1", '"a"', "0", "0")
OLD = section("MeshFormat", "2.2 0 8") + MORE + section("Nodes", "8", *numbered(CUBE))
V2 = OLD + section("Elements", "6", *numbered(QUADS, "3 2 0 1 ", 1))
V1 = section("NOD", "8", *numbered(CUBE), end="END") + section("ELM", "6", *numbered(QUADS, "3 1 1 4 ", 1), end="END")
V40 = (
    section("MeshFormat", "4 0 8")
    + section("Nodes", "2 8", "1 0 0 1", "1 0 0 0", "1 2 1 7", *(f"{n} 0.5 8.5" for n in numbered(CUBE)[1:]))
    + section("Elements", "1 6", "1 2 3 6", *numbered(QUADS, "", 1))
)  # fmt: skip
V41 = (
    section("MeshFormat", "4.1 0 8")
    + section("Entities", "0 0 1 0", "1 0 0 0 1 1 1 0 0")
    + section("Nodes", "1 8 1 8", "2 1 1 8", *map(str, range(1, 9)), *(f"{n} 0.5 0.25" for n in words(CUBE)))
    + section("Elements", "1 6 1 6", "2 1 3 6", *numbered(QUADS, "", 1))
    + section("Periodic", "1", "0 1 2", "1", "1 2")
)


def of(tmp_path, content: str | bytes):
    return written(tmp_path / "a.msh", content)


@pytest.mark.parametrize("content", [V1, V2, V40, V41, V2.replace("\n", "\r\n"), V41.replace(" ", "  ")])
def test_one_cube_in_every_version(tmp_path, content):
    found = read(of(tmp_path, content))
    assert found.vertices.tolist() == CUBE
    assert lists(found) == QUADS


def test_parametric_nodes_of_version_2(tmp_path):
    marks = ["0 1", "1 1 .5", "2 1 .5 .5", "3 1", "2 1 0 0", "2 1 0 0", "1 1 0", "0 2"]
    rows = [f"{row} {mark}" for row, mark in zip(numbered(CUBE), marks, strict=True)]
    found = read(
        of(tmp_path, V2.replace(section("Nodes", "8", *numbered(CUBE)), section("ParametricNodes", "8", *rows)))
    )
    assert found.vertices.tolist() == CUBE


def test_surfaces_beside_volumes_lines_and_points(tmp_path):
    more = ["7 15 2 0 1 1", "8 1 2 0 1 1 2", "9 4 2 0 1 1 2 3 6", "10 5 2 0 1 1 2 3 4 5 6 7 8"]
    content = V2.replace("$Elements\n6", "$Elements\n10").replace("$EndElements", "\n".join([*more, "$EndElements"]))
    with pytest.warns(UserWarning, match="1 hexahedra, 1 lines, 1 points, 1 tetrahedra; left out"):
        assert lists(read(of(tmp_path, content))) == QUADS
    only = OLD + section("Elements", "1", more[2])
    with pytest.raises(FormatError, match="but only 1 tetrahedra; save the surface"):
        read(of(tmp_path, only))


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("dialect", ["gmsh22", "gmsh"])
def test_what_meshio_writes(tmp_path, binary, dialect):
    tags = {n: [np.zeros(12, dtype=np.int32)] for n in ("gmsh:physical", "gmsh:geometrical")}
    made = meshio.Mesh(np.array(CUBE, float), [("triangle", np.array(TRIANGLES))], cell_data=tags)
    meshio.write(tmp_path / "a.msh", made, file_format=dialect, binary=binary)
    assert lists(read(tmp_path / "a.msh")) == TRIANGLES


@pytest.mark.parametrize("order", "<>")
def test_binary_4_0_in_either_order_of_bytes(tmp_path, order):
    nodes = struct.pack(f"{order}2Q3iQ", 1, 8, 1, 2, 0, 8)
    nodes += b"".join(struct.pack(f"{order}i3d", k + 1, *p) for k, p in enumerate(CUBE))
    cells = struct.pack(f"{order}2Q3iQ", 1, 6, 1, 2, 3, 6)
    cells += b"".join(struct.pack(f"{order}5i", k + 1, *(n + 1 for n in q)) for k, q in enumerate(QUADS))
    content = b"$MeshFormat\n4 1 8\n" + struct.pack(f"{order}i", 1) + b"\n$EndMeshFormat\n$Nodes\n" + nodes
    content += b"\n$EndNodes\n$Elements\n" + cells + b"\n$EndElements\n"
    found = read(of(tmp_path, content))
    assert found.vertices.tolist() == CUBE
    assert lists(found) == QUADS
    for size in (40, 100, 300, 450, len(content) - 15):
        with pytest.raises(FormatError, match=r"a\.msh"):
            read(of(tmp_path, content[:size]))


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "no triangles"),
        ("hello\n", "line 1.*section"),
        (V2.replace("2.2 0", "3.0 0"), "version '3.0'"),
        (V2.replace("2.2 0", "1 0"), "does not belong"),
        (V2.replace("$EndElements", ""), r"\$Elements has no end"),
        (V2.replace("$Nodes\n8", "$Nodes\n9"), "line 1[0-9].*cut short"),
        (V2.replace("$Nodes\n8", "$Nodes\n7"), "goes on"),
        (V2.replace("$Elements\n6", "$Elements\n5"), "goes on"),
        (V2.replace("$Elements\n6", "$Elements\n-6"), "goes on|declared"),
        (V2.replace("1 3 2 0 1 1 4 3 2", "1 3 2 0 1 1 4 3 9"), "node 9"),
        (V2.replace("1 3 2 0 1 1 4 3 2", "1 3 2 0 1 1 4 3 2.5"), "2.5"),
        (V2.replace("1 3 2 0 1 1 4 3 2", "1 99 2 0 1 1 4 3 2"), "type 99"),
        (V2.replace("1 3 2 0 1 1 4 3 2", "1 9 2 0 1 1 4 3 2 5 6"), "higher order"),
        (V2.replace("1 3 2 0", "1 3 -1 0"), "number of tags"),
        (V2.replace("2 3 2 0 1 5", "1 3 2 0 1 5"), "element 1 stands twice"),
        (V2.replace("2 1 0 0\n", "1 1 0 0\n"), "node 1 stands twice"),
        (V2.replace("2 1 0 0\n", "2 1 nan 0\n"), "nan"),
        (V2 + section("Nodes", "0"), r"second section \$Nodes"),
        (V2 + section("Transform", "1"), r"Transform.*not known"),
        (V2.replace("$PhysicalNames", "$Merge"), r"Merge"),
        (V40.replace("1 2 1 7", "1 2 0 7"), "goes on|whole number|dimension"),
        (V40.replace("$Nodes\n2 8", "$Nodes\n2 9"), "differs by 1"),
        (V40.replace("$Elements\n1 6", "$Elements\n1 7"), "number of elements differs by 1"),
        (V41.replace("$Elements\n1 6", "$Elements\n1 5"), "number of elements differs by 1"),
        (V41.replace("$Nodes\n1 8", "$Nodes\n1 9"), "number of nodes differs by 1"),
        (V41.replace("2 1 1 8", "2 1 2 8"), "mark 2"),
        (V41.replace("2 1 3 6", "1 1 3 6"), "dimension 1, but 2"),
        (V41.replace("2 1 3 6", "2 1 3 7"), "cut short"),
        ("$MeshFormat\n4.1 1 8\nxxxx\n$EndMeshFormat\n", "order of the bytes"),
    ],
)
def test_what_is_not_so_is_refused_with_its_place(tmp_path, content, said):
    with pytest.raises(FormatError, match=rf"a\.msh.*{said}"):
        read(of(tmp_path, content))
