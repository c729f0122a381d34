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


def double_pyramid(n: int) -> Polyhedron:
    """A double pyramid over a regular polygon of n corners: all triangles are needles about its two tips."""
    turn = 2 * np.pi * np.arange(n) / n
    ring = np.stack([np.cos(turn), np.sin(turn), np.zeros(n)], axis=1)
    i, j = np.arange(n), np.roll(np.arange(n), -1)
    faces = np.concatenate([np.stack([i, j, np.full(n, n)], 1), np.stack([j, i, np.full(n, n + 1)], 1)])
    return Polyhedron.from_faces(np.concatenate([ring, [[0, 0, 1], [0, 0, -1]]]), faces)


def prism(n: int) -> Polyhedron:
    """A prism of height 1 over a regular polygon of n corners, whose ends are two faces of n corners."""
    turn = 2 * np.pi * np.arange(n) / n
    ring = np.stack([np.cos(turn), np.sin(turn), np.zeros(n)], axis=1)
    i, j = np.arange(n), np.roll(np.arange(n), -1)
    sides = np.stack([i, j, n + j, n + i], axis=1).tolist()
    return Polyhedron.from_faces(
        np.concatenate([ring, ring + np.array([0, 0, 1])]), [i[::-1].tolist(), (n + i).tolist(), *sides]
    )
