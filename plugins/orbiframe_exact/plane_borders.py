"""Plane borders: the closed curves where plane regions end, as pieces of edges."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from orbiframe_exact.creased_domain import CreasedDomain

Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# The number of a piece, and the vertices from which and to which it runs.
Piece = tuple[int, int, int]


class PlaneBorders:
    """The borders of the planes of a domain, each with its plane at the left.

    A piece is an edge of B-spline faces, by its number, or a line between two planes, whose number is negative and
    which runs on through the vertices at which nothing else ends.
    """

    def __init__(self, domain: CreasedDomain) -> None:
        self._domain, self._d = domain, domain.triangles
        here = np.arange(3 * self._d.face_count)
        self._next = here - here % 3 + (here + 1) % 3
        self._border = domain.planes.border
        region = domain.planes.region
        self._line = self._border & (region[self._d.twin // 3] >= 0)

    @cached_property
    def _passed(self) -> Bools:
        """The vertices that a line goes through: two lines meet there, and nothing else."""
        d, vertex = self._d, self._d.vertex.ravel()

        def degree(marked: Bools) -> Ints:
            first = np.flatnonzero((marked | marked[d.twin]) & d.reference)
            return np.bincount(vertex[np.concatenate([first, self._next[first]])], minlength=d.vertex_count)

        return np.asarray((degree(self._border) == 2) & (degree(self._line) == 2))

    def loops(self, plane: int) -> list[list[Piece]]:
        """The borders of a plane: every one as its pieces in order."""
        own = self._border & (np.repeat(self._domain.planes.region, 3) == plane)
        waiting, found = set(np.flatnonzero(own).tolist()), []
        while waiting:
            loop = [min(waiting)]
            waiting.remove(loop[0])
            while (after := self._after(loop[-1])) != loop[0]:
                waiting.remove(after)
                loop.append(after)
            found.append(self._pieces(loop))
        return found

    def _after(self, halfedge: int) -> int:
        """The next halfedge of a border: the first one about the end of the last."""
        after = int(self._next[halfedge])
        while not self._border[after]:
            after = int(self._next[self._d.twin[after]])
        return after

    def _pieces(self, loop: list[int]) -> list[Piece]:
        vertex = self._d.vertex.ravel()
        stops = [k for k, e in enumerate(loop) if not self._passed[vertex[e]]]
        loop = loop[stops[0] :] + loop[: stops[0]] if stops else loop
        found: list[Piece] = []
        for e in loop:
            start, end, edge = int(vertex[e]), int(vertex[self._next[e]]), int(self._d.edge[e])
            if not self._line[e]:
                ahead, middle = int(self._d.reference[e]), self._d.vertex_count + edge
                found.append((int(self._domain.half[2 * edge + 1 - ahead]), start, middle))
                found.append((int(self._domain.half[2 * edge + ahead]), middle, end))
            elif found and self._passed[start]:
                number, first, _ = found[-1]
                found[-1] = max(number, -1 - edge), first, end
            else:
                found.append((-1 - edge, start, end))
        return found
