"""Gmsh files, 4.1 and 2.2, in ASCII. Source: Gmsh Reference Manual, sections "MSH file format" and "Node ordering"."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe.surfaces import CurvedMesh
from orbiframe_lagrange.numbers import rows

# The type of a triangle of every order.
_TYPES = {1: 2, 2: 9, 3: 21, 4: 23, 5: 25, 6: 42}
# All triangles are of one surface; readers warn of the number 0.
_SURFACE = 1


def write(path: Path, mesh: CurvedMesh) -> None:
    """The triangles as one surface in a file of version 4.1, with all digits."""
    low, high = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)
    box = rows(np.concatenate([low, high])[None])[0]
    nodes, triangles = len(mesh.nodes), len(mesh.elements)
    lines = [
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0",
        f"{_SURFACE} {box} 1 {_SURFACE} 0",
        f"$EndEntities\n$Nodes\n1 {nodes} 1 {nodes}\n2 {_SURFACE} 0 {nodes}",
        *map(str, range(1, nodes + 1)),
        *rows(mesh.nodes),
        f"$EndNodes\n$Elements\n1 {triangles} 1 {triangles}\n2 {_SURFACE} {_TYPES[mesh.order]} {triangles}",
        *rows(_numbered(mesh)),
        "$EndElements",
    ]
    Path(path).write_text("\n".join(lines) + "\n", encoding="ascii")


def write_2_2(path: Path, mesh: CurvedMesh) -> None:
    """The triangles in a file of version 2.2, which more programs read, with all digits."""
    count = np.arange(1, len(mesh.elements) + 1)
    tags = np.column_stack([count, np.full((len(count), 4), [_TYPES[mesh.order], 2, _SURFACE, _SURFACE])])
    lines = [
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(mesh.nodes)}",
        *(f"{number} {row}" for number, row in enumerate(rows(mesh.nodes), start=1)),
        f"$EndNodes\n$Elements\n{len(count)}",
        *rows(np.column_stack([tags, mesh.elements + 1])),
        "$EndElements",
    ]
    Path(path).write_text("\n".join(lines) + "\n", encoding="ascii")


def _numbered(mesh: CurvedMesh) -> NDArray[np.intp]:
    """The number of every triangle, and of its nodes, from 1."""
    return np.column_stack([np.arange(1, len(mesh.elements) + 1), mesh.elements + 1])
