"""A cube and a tetrahedron as plain lists, for files that tests write by hand."""

from __future__ import annotations

import math

import numpy as np

from orbiframe import Polyhedron

CUBE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
QUADS = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
TRIANGLES = [[a, b, c] for q in QUADS for a, b, c in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]


def volume(found: Polyhedron) -> float:
    """The volume inside a closed polyhedron, by a fan in every face; its sign tells which side is out."""
    return math.fsum(
        float(np.linalg.det(found.vertices[[corners[0], corners[k], corners[k + 1]]])) / 6
        for corners in (found.face_corners(f) for f in range(found.face_count))
        for k in range(1, len(corners) - 1)
    )


def lists(found: Polyhedron) -> list[list[int]]:
    """The corners of all faces."""
    return [found.face_corners(f).tolist() for f in range(found.face_count)]


def words(rows: list[list[int]], glue: str = " ", first: int = 0) -> list[str]:
    """Rows of numbers as text, counted from `first` on."""
    return [glue.join(str(n + first) for n in row) for row in rows]
