"""Edges of triangles that are told by their ends, with the two triangles at each."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe import FitError

Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


class Edges(NamedTuple):
    """All edges of a mesh: triangles (a, b, c) and, across the edge from a to b, (b, a, d) or turned round.

    At the boundary of an open one the second triangle is the first again, and d is c.

    first, second: (E,), the triangles; a, b, c, d: (E,), the vertices; key: (E,), one number for each pair of ends,
    rising; vertex_count.
    """

    first: Ints
    second: Ints
    a: Ints
    b: Ints
    c: Ints
    d: Ints
    key: Ints
    vertex_count: int

    @property
    def other_key(self) -> Ints:
        """The key that the other diagonal has, from c to d."""
        return _key(self.c, self.d, self.vertex_count)

    def joined(self) -> Bools:
        """Whether c and d are ends of an edge already, (E,)."""
        place = np.minimum(np.searchsorted(self.key, self.other_key), len(self.key) - 1)
        return np.asarray((self.key[place] == self.other_key) | (self.c == self.d))

    def places(self, ends: Ints) -> Ints:
        """The numbers of the edges with given ends, (n,)."""
        return np.searchsorted(self.key, _key(ends[:, 0], ends[:, 1], self.vertex_count))

    def among(self, ends: Ints | None) -> Bools:
        """Whether each edge is one of those with given ends, (n, 2), (E,)."""
        if ends is None:
            return np.zeros(len(self.key), dtype=np.bool_)
        return np.isin(self.key, _key(ends[:, 0], ends[:, 1], self.vertex_count))


def edges_of(triangles: Ints, vertex_count: int) -> Edges:
    """The edges of a mesh. Raises FitError where two edges have the same ends: then vertices are too few."""
    tail, head = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    key = _key(tail, head, vertex_count)
    order = np.argsort(key, kind="stable")
    found, start, number = np.unique(key[order], return_index=True, return_counts=True)
    one, other = order[start], order[start + number - 1]
    if not ((number <= 2).all() and (tail != head).all()):
        raise FitError(
            f"{vertex_count} vertices are too few for this surface: some edges have the same two ends, which no file "
            "can tell apart; take more vertices, or shorter edges"
        )
    apex = np.roll(triangles, 1, axis=1).ravel()
    return Edges(one // 3, other // 3, tail[one], head[one], apex[one], apex[other], found, vertex_count)


def _key(one: Ints, other: Ints, count: int) -> Ints:
    return np.asarray(np.minimum(one, other) * np.intp(count) + np.maximum(one, other))
