"""Shared diagonals: cuts of faces changed until no diagonal has the ends of an edge or of another diagonal."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.cut import Cut
from orbiframe.meshes.face_plane import in_its_plane

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Triangle = tuple[int, int, int]

# Twice the area of a triangle beside the square of its longest side: a diagonal that makes a thinner one is worse than
# a point.
_THIN = 1e-3


def without_shared_diagonals(cut: Cut) -> Cut:
    """The same faces cut so that no diagonal joins two vertices that an edge or another diagonal joins.

    The first of several diagonals stays. Each other one is exchanged for the other diagonal of its two triangles where
    that one is free and the triangles are sound, and else halved by a new point, from where its triangles are halved.
    A diagonal that joins a vertex with itself stays, as only a face that meets the vertex twice has one.
    """
    start, end, shared = _shared(cut)
    if not len(shared):
        return cut
    faces = cut.face[shared // 3]
    taken = _Taken(cut)
    parts: dict[int, list[Triangle]] = {}
    between: list[tuple[int, int]] = []
    for first, stop in _runs(faces):
        piece = _Piece(cut, int(faces[first]), taken, between)
        for side in shared[first:stop]:
            piece.change(int(start[side]), int(end[side]))
        parts[int(faces[first])] = piece.triangles
    return _joined(cut, parts, between)


def _shared(cut: Cut) -> tuple[Ints, Ints, Ints]:
    """Starts and ends of all sides, and one side of every diagonal to be changed, in the order of the faces."""
    start, end = cut.sides
    key = _keys(cut, start, end)
    inner = ~cut.on_outline
    diagonal = np.flatnonzero(inner & (start < end) & (cut.vertex[start] != cut.vertex[end]))
    edges = np.unique(key[~inner])
    _, first = np.unique(key[diagonal], return_index=True)
    repeated = np.ones(len(diagonal), dtype=np.bool_)
    repeated[first] = False
    return start, end, diagonal[repeated | np.isin(key[diagonal], edges)]


def _keys(cut: Cut, start: Ints, end: Ints) -> Ints:
    a, b = cut.vertex[start], cut.vertex[end]
    return np.minimum(a, b) * np.intp(len(cut.polyhedron.vertices)) + np.maximum(a, b)


def _runs(labels: Ints) -> Iterator[tuple[int, int]]:
    """The runs of equal labels as (first, stop)."""
    bounds = [0, *(np.flatnonzero(np.diff(labels)) + 1).tolist(), len(labels)]
    return pairwise(bounds)


class _Taken:
    """The pairs of vertices that are joined already."""

    def __init__(self, cut: Cut) -> None:
        self._known = np.unique(_keys(cut, *cut.sides))
        self._fresh: set[int] = set()
        self._count = len(cut.polyhedron.vertices)
        self._vertex = cut.vertex

    def take(self, a: int, b: int) -> bool:
        """Join the vertices of two corners, unless they are joined or one and the same."""
        i, j = sorted((int(self._vertex[a]), int(self._vertex[b])))
        key = i * self._count + j
        place = int(np.searchsorted(self._known, key))
        if i == j or key in self._fresh or (place < len(self._known) and self._known[place] == key):
            return False
        self._fresh.add(key)
        return True


class _Piece:
    """The triangles of one face while its diagonals are changed."""

    def __init__(self, cut: Cut, face: int, taken: _Taken, between: list[tuple[int, int]]) -> None:
        mesh = cut.polyhedron
        first, stop = np.searchsorted(cut.face, [face, face + 1])
        self.triangles: list[Triangle] = [tuple(row) for row in cut.corners[first:stop].tolist()]
        self._at = {(t[k], t[(k + 1) % 3]): n for n, t in enumerate(self.triangles) for k in range(3)}
        flat = in_its_plane(mesh.vertices[mesh.face_corners(face)])
        self._place = dict(enumerate(flat.tolist(), start=int(mesh.offsets[face])))
        self._taken, self._between, self._corners = taken, between, len(mesh.tail)

    def change(self, s: int, e: int) -> None:
        """Exchange the diagonal between two corners, or put a point on it."""
        one, other = self._at.pop((s, e)), self._at.pop((e, s))
        x, y = self._third(one, s, e), self._third(other, s, e)
        if x < self._corners > y and self._sound(s, y, x) and self._sound(y, e, x) and self._taken.take(x, y):
            self._set(one, (s, y, x))
            self._set(other, (y, e, x))
            return
        m = self._corners + len(self._between)
        self._between.append((s, e))
        a, b = self._place[s], self._place[e]
        self._place[m] = [a[0] / 2 + b[0] / 2, a[1] / 2 + b[1] / 2]
        self._set(one, (s, m, x))
        self._set(other, (e, m, y))
        for triangle in ((m, e, x), (m, s, y)):
            self.triangles.append(triangle)
            self._set(len(self.triangles) - 1, triangle)

    def _third(self, triangle: int, s: int, e: int) -> int:
        return next(corner for corner in self.triangles[triangle] if corner not in (s, e))

    def _set(self, number: int, triangle: Triangle) -> None:
        self.triangles[number] = triangle
        for k in range(3):
            self._at[triangle[k], triangle[(k + 1) % 3]] = number

    def _sound(self, *triangle: int) -> bool:
        """Whether a triangle runs counterclockwise and is not too thin."""
        (ax, ay), (bx, by), (cx, cy) = (self._place[corner] for corner in triangle)
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        sides = (bx - ax) ** 2 + (by - ay) ** 2, (cx - bx) ** 2 + (cy - by) ** 2, (ax - cx) ** 2 + (ay - cy) ** 2
        return bool(area > _THIN * max(sides))


def _joined(cut: Cut, parts: dict[int, list[Triangle]], between: list[tuple[int, int]]) -> Cut:
    """The cut with other triangles in some faces."""
    changed = np.isin(cut.face, list(parts))
    fresh = np.array([triangle for part in parts.values() for triangle in part], dtype=np.intp)
    owner = np.repeat(list(parts), [len(part) for part in parts.values()])
    face = np.concatenate([cut.face[~changed], owner])
    order = np.argsort(face, kind="stable")
    corners = np.concatenate([cut.corners[~changed], fresh])[order]
    return Cut(cut.polyhedron, corners, face[order], np.array(between, dtype=np.intp).reshape(-1, 2))
