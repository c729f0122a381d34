"""MFEM meshes v1.0 with curved nodes. Source: MFEM, "Mesh Formats", and the order of unknowns of H1_FECollection."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FitError
from orbiframe.surfaces import CurvedMesh, node_exponents
from orbiframe_lagrange.numbers import rows

Ints = NDArray[np.intp]

_TRIANGLE, _ATTRIBUTE = 2, 1


def write(path: Path, mesh: CurvedMesh) -> None:
    """The triangles with their nodes as a function of the space H1@U_2D_Pq, whose points are equally spaced.

    MFEM tells edges by their ends, so raises FitError where two sides of triangles have the same ends and are not one.
    """
    corners, vertex = np.unique(mesh.corners, return_inverse=True)
    triangles = vertex.reshape(-1, 3)
    lines = [
        f"MFEM mesh v1.0\n\ndimension\n2\n\nelements\n{len(triangles)}",
        *(f"{_ATTRIBUTE} {_TRIANGLE} {row}" for row in rows(triangles)),
        f"\nboundary\n0\n\nvertices\n{len(corners)}\n\nnodes\nFiniteElementSpace",
        f"FiniteElementCollection: H1@U_2D_P{mesh.order}\nVDim: 3\nOrdering: 1\n",
        *rows(mesh.nodes[_unknowns(mesh, corners, triangles)]),
    ]
    Path(path).write_text("\n".join(lines) + "\n", encoding="ascii")


def _unknowns(mesh: CurvedMesh, corners: Ints, triangles: Ints) -> Ints:
    """The nodes in the order of MFEM: vertices; edges as they first appear, from the lesser end; triangles."""
    q, count = mesh.order, len(triangles)
    sides = mesh.elements[:, 3 : 3 * q].reshape(count * 3, q - 1)
    tail, head = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    sides = np.where((tail > head)[:, None], sides[:, ::-1], sides)
    key = np.minimum(tail, head) * len(corners) + np.maximum(tail, head)
    first, edge, number = np.unique(key, return_index=True, return_inverse=True, return_counts=True)[1:]
    if (number != 2).any() or not np.array_equal(sides[first][edge], sides):
        raise FitError(
            "some edges of the elements have the same two ends, which an MFEM mesh cannot tell apart; take smaller "
            "elements (--refine 2), or write a .msh or .vtu file"
        )
    inside = mesh.elements[:, 3 * q :][:, _inside(q)]
    return np.concatenate([corners, sides[np.sort(first)].ravel(), inside.ravel()])


def _inside(order: int) -> Ints:
    """The nodes within a triangle, row by row from the first side on, by numbers in our order."""
    inside = node_exponents(order)[3 * order :]
    return np.lexsort((inside[:, 1], inside[:, 2]))
