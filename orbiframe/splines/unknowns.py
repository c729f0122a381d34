"""Unknowns: numbers at the vertices, on the edges and in the triangles, from which splines are assembled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe.compiled.decorator import compiled
from orbiframe.splines.sectors import Sectors
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

_AT_ONCE = 1 << 18  # entries of dense forms that are in memory together: few enough for the cache


@dataclass(frozen=True, eq=False)
class Unknowns:
    """Numbers of unknowns: so many at every vertex, then so many on every edge, then so many in every triangle.

    In a triangle they stand in this order: those of corners 0, 1, 2, of edges 0, 1, 2 (edge c from corner c to c + 1)
    and of the inside.

    sectors: of a domain with creases, for three unknowns at every vertex: those of its sectors instead, and on the two
    sides of an open edge unknowns of their own.
    """

    domain: GeodesicTriangulation
    at_vertex: int
    on_edge: int
    in_face: int
    sectors: Sectors | None = None

    @property
    def size(self) -> int:
        """How many there are on X/H."""
        return self._at_vertices + self._on_edges + self.in_face * self.domain.face_count

    @property
    def _at_vertices(self) -> int:
        return self.at_vertex * self.domain.vertex_count if self.sectors is None else self.sectors.size

    @property
    def _on_edges(self) -> int:
        return self.on_edge * (self.domain.edge_count if self.sectors is None else self.sectors.side_count)

    @property
    def local_size(self) -> int:
        """How many matter on one triangle; one of them may occur several times."""
        return 3 * self.at_vertex + 3 * self.on_edge + self.in_face

    def vertex_slots(self, corner: int) -> slice:
        """Where the unknowns of a corner stand among those of a triangle."""
        return slice(self.at_vertex * corner, self.at_vertex * (corner + 1))

    def edge_slots(self, edge: int) -> slice:
        """Where the unknowns of an edge stand among those of a triangle."""
        first = 3 * self.at_vertex + self.on_edge * edge
        return slice(first, first + self.on_edge)

    @property
    def face_slots(self) -> slice:
        """Where the unknowns of the inside stand among those of a triangle."""
        return slice(3 * self.at_vertex + 3 * self.on_edge, self.local_size)

    @cached_property
    def numbers(self) -> Ints:
        """The number on X/H of every unknown of every triangle, (F, local_size)."""
        d, sectors = self.domain, self.sectors
        edges, faces = self._at_vertices, self._at_vertices + self._on_edges
        side = d.edge if sectors is None else sectors.side
        parts = (
            (0, self.at_vertex, d.vertex),
            (edges, self.on_edge, side.reshape(-1, 3)),
            (faces, self.in_face, np.arange(d.face_count)[:, None]),
        )
        columns = [first + count * owner[..., None] + np.arange(count) for first, count, owner in parts]
        if sectors is not None:
            columns[0] = sectors.numbers[sectors.corner]
        return np.concatenate([column.reshape(d.face_count, -1) for column in columns], axis=1)

    def matrix(self, nets: Floats) -> csr_array:
        """C from Bernstein coefficients as forms of the unknowns of their triangle: nets (F, m, n, local_size)."""
        return self.assembled(lambda faces: nets[faces], (nets != 0).any(axis=0))

    def assembled(self, nets: Callable[[slice], Floats], pattern: Bools) -> csr_array:
        """C from nets that are made for some triangles at a time, so that few of the dense forms exist at once.

        nets: the Bernstein coefficients on a range of triangles as forms of their unknowns, (N, m, n, local_size);
        pattern: (m, n, local_size), which of them may differ from zero. Terms of one unknown that occurs several times
        in a triangle are added.
        """
        faces, rows = self.domain.face_count, pattern.reshape(-1, self.local_size)
        kinds, kind = np.unique(rows, axis=0, return_inverse=True)
        order = np.argsort(self.numbers, axis=1, kind="stable")
        index = np.int32 if faces * max(int(rows.sum()), self.size) < 2**31 else np.int64
        data, at_once = np.empty((faces, int(rows.sum()))), max(_AT_ONCE // rows.size, 1)
        column = np.empty(data.shape, dtype=index)
        for begin in range(0, faces, at_once):
            part = slice(begin, min(begin + at_once, faces))
            forms = nets(part).reshape(-1, *rows.shape)
            _fill_rows(forms, kinds, kind, order[part], self.numbers[part], data[part], column[part])
        start = np.concatenate([[0], np.cumsum(np.tile(rows.sum(axis=1), faces))]).astype(index)
        matrix = csr_array((data.ravel(), column.ravel(), start), shape=(len(start) - 1, self.size))
        matrix.sum_duplicates()
        return matrix


@compiled
def _fill_rows(forms, kinds, kind, order, numbers, data, column):  # type: ignore[no-untyped-def]
    """The entries row by row, each row in the order of the numbers of its unknowns.

    kinds: the patterns that rows can have; kind: the one of each row.
    """
    places, count = np.empty(kinds.shape, dtype=np.intp), np.zeros(len(kinds), dtype=np.intp)
    for f in range(len(forms)):
        for n in range(len(kinds)):
            count[n] = 0
            for local in order[f]:
                places[n, count[n]] = local
                count[n] += kinds[n, local]
        k = 0
        for row in range(len(kind)):
            n = kind[row]
            for i in range(count[n]):
                local = places[n, i]
                data[f, k], column[f, k] = forms[f, row, local], numbers[f, local]
                k += 1
