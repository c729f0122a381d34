"""Sectors: the parts of the stars of vertices between creases, each with a first jet of its own.

A spline is smooth inside of a sector, and only continuous from sector to sector. At a vertex with k >= 2 edges across
which it is only continuous, the unknowns are its value and its slopes along these k edges: the first jet of a sector
follows from the value and the slopes along the two edges that bound it, if these are not opposite. So every sector gets
a hair, its middle inner edge, across which functions are only continuous too: then the two edges of a part of a sector
are never opposite, however the curves of a crease bend in X. A vertex with one such edge, where a crease ends (a dart),
has one sector, all round, and a full jet like any other vertex.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.splines.shared_edges import along_reference
from orbiframe.splines.vertex_jets import tangent_points
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Where along an edge the slope at its end is given as a coefficient, as a share of the edge on the tangent plane.
_REACH = 0.5
# A part of a sector wider than this gets a further hair, if it has an inner edge: opposite edges cost digits.
_WIDEST = np.radians(150)


@dataclass(frozen=True, eq=False)
class Sectors:
    """The sectors of a triangulation with creases; of one without, every vertex is a sector."""

    domain: GeodesicTriangulation

    @cached_property
    def split(self) -> Bools:
        """The vertices with two creases or more, (V,)."""
        return np.asarray(self.domain.crease_degree >= 2)

    @cached_property
    def hair(self) -> Bools:
        """The halfedges of hairs, (3 F,): in every sector between creases the inner edge nearest to its middle."""
        d, hair = self.domain, np.zeros(3 * self.domain.face_count, dtype=np.bool_)
        turn = np.arctan2(np.abs(_cross(self._seen)), (self._seen[..., 0, :] * self._seen[..., 1, :]).sum(axis=-1))
        for corners, crossed in self._fans():
            _divide(turn.ravel()[corners], crossed, hair)
        return np.asarray(hair | hair[d.twin])

    @cached_property
    def open(self) -> Bools:
        """The halfedges across which functions are only continuous: creases and hairs, (3 F,)."""
        return np.asarray(self.domain.creased | self.hair)

    @cached_property
    def corner(self) -> Ints:
        """The sector of every corner, (F, 3); sectors are numbered by their first corners."""
        d, here = self.domain, np.arange(3 * self.domain.face_count)
        if not self.split.any():
            return d.vertex
        vertex, ahead = d.vertex.ravel(), here - here % 3 + (here + 1) % 3
        begins, ends = here[~self.open | ~self.split[vertex]], here[~self.open | ~self.split[vertex[ahead]]]
        links = np.concatenate([begins, ahead[ends]]), np.concatenate([d.start[begins], d.end[ends]])
        graph = coo_array((np.ones(len(links[0])), links), shape=(len(here), len(here)))
        label = connected_components(graph, directed=False)[1]
        first, number = np.unique(label, return_index=True, return_inverse=True)[1:]
        rank = np.empty(len(first), dtype=np.intp)
        rank[np.argsort(first)] = np.arange(len(first))
        return np.asarray(rank[number].reshape(-1, 3))

    @cached_property
    def count(self) -> int:
        """How many sectors there are."""
        return int(self.corner.max()) + 1

    @cached_property
    def vertex(self) -> Ints:
        """The vertex of every sector, (S,)."""
        vertex = np.empty(self.count, dtype=np.intp)
        vertex[self.corner] = self.domain.vertex
        return vertex

    def triangles(self, whole: Floats) -> Floats:
        """The triangles on which the jets of the sectors are given, (S, 3, 3), corners in columns.

        whole: (V, 3, 3), those of vertices that are not split. In a sector of a split vertex v they are v and points on
        its two edges, on the plane beta(v, q) = 1; all in the frame of the reference corner of the vertex.
        """
        found, parts = whole[self.vertex], self.split[self.vertex]
        flat = np.zeros((int(parts.sum()), 3, 3))
        flat[:, 0], flat[:, 1:, 1:] = 1.0, np.swapaxes(_REACH * self._direction[self._bounds[parts]], 1, 2)
        reference = self.domain.corners.reshape(-1, 3)[self.domain.vertex_corner][self.vertex[parts]]
        found[parts] = self.domain.geometry.carry(reference) @ flat
        return np.asarray(found)

    @cached_property
    def numbers(self) -> Ints:
        """The three unknowns of every sector, (S, 3): at a split vertex its value and the slopes of its edges."""
        first, split = self._first, self.split[self.vertex]
        numbers = first[self.vertex][:, None] + np.arange(3)
        numbers[split, 1:] = self._slope[self._bounds[split]]
        return np.asarray(numbers)

    @cached_property
    def size(self) -> int:
        """How many unknowns the vertices have: three each, one and one for each edge where they are split."""
        return int(self._counts.sum())

    @cached_property
    def side(self) -> Ints:
        """A number for every halfedge, (3 F,), the same as that of its twin unless the edge is open."""
        d = self.domain
        extra = np.flatnonzero(self.open & ~d.reference)
        side = d.edge.copy()
        side[extra] = d.edge_count + np.arange(len(extra))
        return side

    @property
    def side_count(self) -> int:
        """How many numbers of sides there are."""
        return int(self.side.max()) + 1

    # ---- ends of edges: 2 e at the start of the reference halfedge of edge e, 2 e + 1 at its end ----------------

    @cached_property
    def _ends(self) -> Ints:
        """The ends of the edges that meet at each corner, (F, 3, 2): of the one that starts there, and of the other."""
        d, along = self.domain, along_reference(self.domain)
        starting = 2 * d.edge + np.where(along, 0, 1)
        ending = 2 * d.edge + np.where(along, 1, 0)
        return np.stack([starting.reshape(-1, 3), np.roll(ending.reshape(-1, 3), 1, axis=1)], axis=2)

    @cached_property
    def _seen(self) -> Floats:
        """The edges at each corner in the tangent plane of its vertex, (F, 3, 2, 2), as `_ends`."""
        x = self.domain.corners
        return tangent_points(self.domain, np.stack([np.roll(x, -1, axis=1), np.roll(x, -2, axis=1)], axis=2))

    @cached_property
    def _direction(self) -> Floats:
        """The direction of the edge at each of its ends, (2 E, 2)."""
        direction = np.empty((2 * self.domain.edge_count, 2))
        direction[self._ends] = self._seen
        return direction

    @cached_property
    def _open_ends(self) -> Bools:
        """The ends at which open edges divide split vertices, (2 E,)."""
        vertex, reference = np.empty(2 * self.domain.edge_count, dtype=np.intp), self.domain.reference
        vertex[self._ends] = self.domain.vertex[..., None]
        return np.asarray(np.repeat(self.open[reference], 2) & self.split[vertex])

    @cached_property
    def _bounds(self) -> Ints:
        """The two ends that bound every sector, (S, 2); 0 where the vertex is not split."""
        bounds = np.zeros((self.count, 2), dtype=np.intp)
        place = np.flatnonzero(self._open_ends[self._ends].ravel())
        pairs = np.unique(np.stack([self.corner.ravel()[place // 2], self._ends.ravel()[place]], axis=1), axis=0)
        bounds[pairs[::2, 0]] = pairs[:, 1].reshape(-1, 2)
        return bounds

    @cached_property
    def _counts(self) -> Ints:
        """How many unknowns every vertex has, (V,)."""
        vertex = self.domain.vertex.ravel()
        degree = np.zeros(self.domain.vertex_count, dtype=np.intp)
        end = np.flatnonzero(self._open_ends)
        owner = np.empty(2 * self.domain.edge_count, dtype=np.intp)
        owner[self._ends.reshape(-1, 2)] = vertex[:, None]
        np.add.at(degree, owner[end], 1)
        return np.where(self.split, 1 + degree, 3)

    @cached_property
    def _first(self) -> Ints:
        """The first unknown of every vertex, (V,)."""
        return np.cumsum(self._counts) - self._counts

    @cached_property
    def _slope(self) -> Ints:
        """The unknown of the slope at every open end, (2 E,)."""
        owner = np.empty(2 * self.domain.edge_count, dtype=np.intp)
        owner[self._ends] = self.domain.vertex[..., None]
        end = np.flatnonzero(self._open_ends)
        order = end[np.argsort(owner[end], kind="stable")]
        start = np.searchsorted(owner[order], owner[order])
        slope = np.zeros(len(owner), dtype=np.intp)
        slope[order] = self._first[owner[order]] + 1 + np.arange(len(order)) - start
        return slope

    # ---- walks round vertices --------------------------------------------------------------------------------------

    def _fans(self) -> Iterator[tuple[list[int], list[int]]]:
        """The corners of every sector between creases at a split vertex in order, and the halfedges between them."""
        d, seen = self.domain, set()
        vertex = d.vertex.ravel()
        for halfedge in np.flatnonzero(d.creased):
            ahead = halfedge - halfedge % 3 + (halfedge + 1) % 3
            for begin in ((int(halfedge), True), (int(ahead), False)):
                if self.split[vertex[begin[0]]] and begin not in seen:
                    corners, crossed, last = self._fan(*begin)
                    seen |= {begin, last}
                    yield corners, crossed

    def _fan(self, corner: int, out: bool) -> tuple[list[int], list[int], tuple[int, bool]]:
        """From a corner, away from its starting edge (out) or its ending one, to the next crease.

        Also the last corner, and whether the walk has come to its starting edge.
        """
        d, corners, crossed = self.domain, [corner], list[int]()
        while True:
            leave = not out
            across = corner if leave else corner - corner % 3 + (corner + 2) % 3
            if d.creased[across]:
                return corners, crossed, (corner, leave)
            crossed.append(across)
            corner = int(d.start[across] if leave else d.end[across])
            # Twins that run the same way are left as they are entered.
            out = leave if d.same[across] else not leave
            corners.append(corner)


def _divide(turn: Floats, crossed: list[int], hair: Bools) -> None:
    """Mark the inner edge nearest to the middle of a fan of corners, and in parts that are still too wide again."""
    if not crossed:
        return
    reached = np.cumsum(turn)
    middle = int(np.argmin(np.abs(reached[:-1] - reached[-1] / 2)))
    hair[crossed[middle]] = True
    for part, inner in ((turn[: middle + 1], crossed[:middle]), (turn[middle + 1 :], crossed[middle + 1 :])):
        if part.sum() > _WIDEST:
            _divide(part, inner, hair)


def _cross(pair: Floats) -> Floats:
    """The areas of the parallelograms of pairs of plane vectors, (..., 2, 2)."""
    return np.asarray(pair[..., 0, 0] * pair[..., 1, 1] - pair[..., 0, 1] * pair[..., 1, 0])
