"""Macro elements: jets at vertices, normals at edges and splits of triangles, from which spline families are built.

The k-jet of a spline of degree d at a vertex v is the homogeneous polynomial P(u) = B(v^(d-k), u^k), B the blossom. The
coefficients within distance k of that corner of a triangle are those of P on the triangle. So jets need no tangent
frames, and are carried from triangle to triangle by substitution.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from orbiframe.splines.bernstein import coefficient_count, symmetric_power
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
    """

    domain: GeodesicTriangulation
    at_vertex: int
    on_edge: int
    in_face: int

    @property
    def size(self) -> int:
        """How many there are on X/H."""
        d = self.domain
        return self.at_vertex * d.vertex_count + self.on_edge * d.edge_count + self.in_face * d.face_count

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
        d = self.domain
        edges = self.at_vertex * d.vertex_count
        faces = edges + self.on_edge * d.edge_count
        parts = (
            (0, self.at_vertex, d.vertex),
            (edges, self.on_edge, d.edge.reshape(-1, 3)),
            (faces, self.in_face, np.arange(d.face_count)[:, None]),
        )
        columns = [first + count * owner[..., None] + np.arange(count) for first, count, owner in parts]
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


@njit(cache=True)
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


@dataclass(frozen=True, eq=False)
class VertexJets:
    """Jets of one order at all vertices: Bernstein coefficients of P on a triangle about each vertex.

    order: k; triangles: (V, 3, 3), the corners in columns, in the frame of the reference corner of the vertex, on the
    plane beta(v, q) = 1 (in E^2 q0 = 1), which touches X in S^2 and H^2.
    """

    domain: GeodesicTriangulation
    order: int
    triangles: Floats

    @property
    def count(self) -> int:
        """Unknowns of a vertex: (k + 1)(k + 2) / 2."""
        return coefficient_count(self.order)

    @cached_property
    def _to_reference(self) -> Floats:
        """From frames of triangles to coordinates in the triangle about the vertex of each corner, (F, 3, 3, 3)."""
        inverse = np.linalg.inv(self.triangles)[self.domain.vertex]
        return np.asarray(inverse @ self.domain.geometry.inverse(self.domain.corner_frame))

    def forms(self, corner: int, vectors: Floats, order: int | None = None) -> Floats:
        """The coefficients of P of the vertex at a corner on a triangle of vectors, (F, n, n): [coefficient, unknown].

        vectors: (F, 3, 3), corners of that triangle in columns, in the frame of each triangle of the domain; by default
        of degree `order` = k. The blossom of P at vectors w_i is read off where its exponent stands.
        """
        return symmetric_power(self._to_reference[:, corner] @ vectors, self.order if order is None else order)

    def own_forms(self, faces: slice) -> Floats:
        """The coefficients of P of every corner on the triangle itself, (N, 3, n, n).

        [triangle, corner, coefficient, unknown]; for corner c the triangle is taken from there on: c, c + 1, c + 2.
        """
        rotated = self.domain.corners[faces][:, (np.arange(3)[:, None] + np.arange(3)) % 3]
        return symmetric_power(self._to_reference[faces] @ np.swapaxes(rotated, 2, 3), self.order)


def tangent_points(domain: GeodesicTriangulation, around: Floats) -> Floats:
    """Vectors seen from the vertices of corners: in their frames at the origin, on the plane x0 = 1, (F, 3, m, 2).

    around: (F, 3, m, 3), m vectors for every corner, in the frames of the triangles.
    """
    geometry, reference = domain.geometry, domain.corners.reshape(-1, 3)[domain.vertex_corner]
    to_vertex = geometry.inverse(geometry.carry(reference))[domain.vertex]
    seen = around @ np.swapaxes(to_vertex @ geometry.inverse(domain.corner_frame), 2, 3)
    return np.asarray(seen[..., 1:] / seen[..., :1])


def shaped_triangles(domain: GeodesicTriangulation, around: Floats, radius: float) -> Floats:
    """Triangles about the vertices in the shape of their stars, for well conditioned jets: (V, 3, 3), in columns.

    The regular triangle of circumradius `radius`, moved by the square root of the mean of p p^T over the points p of
    the star on the tangent plane. around: (F, 3, m, 3), vectors in the star of every corner, in the frames of the
    triangles.
    """
    moment, _ = _moments(domain, around)
    return _on_tangent_planes(domain, radius * _roots(moment) @ _regular(0.0))


def enclosing_triangles(domain: GeodesicTriangulation, around: Floats, turns: int = 24) -> Floats:
    """Triangles about the vertices that hold all points of their stars, for functions >= 0: (V, 3, 3), in columns.

    Regular triangles in the shape of the star (see `shaped_triangles`), in the best of `turns` positions, as small as
    they can be.
    """
    moment, seen = _moments(domain, around)
    root = _roots(moment)
    vertex = np.repeat(domain.vertex.ravel(), around.shape[2])
    flat = np.einsum("nij,nj->ni", np.linalg.inv(root)[vertex], seen.reshape(-1, 2))
    angles = np.arange(turns) * (2 * np.pi / 3 / turns)
    sides = -2 * np.moveaxis(_regular(angles), 0, -1)
    reach = np.zeros((domain.vertex_count, 3 * turns))
    _reach(vertex, flat, sides.reshape(-1, 2), reach)
    needed = reach.reshape(-1, 3, turns).max(axis=1)
    # The first of those that are equally small up to rounding.
    best = np.argmax(needed <= needed.min(axis=1, keepdims=True) + 1e-12, axis=1)
    size = needed[np.arange(len(best)), best, None, None]
    return _on_tangent_planes(domain, size * root @ np.moveaxis(_regular(angles[best]), -1, 0))


@njit(cache=True)
def _reach(vertex, points, directions, reach):  # type: ignore[no-untyped-def]
    """How far the points of every vertex reach along directions: reach (V, k), the largest products, at least 0."""
    for n in range(len(vertex)):
        x, y, own = points[n, 0], points[n, 1], reach[vertex[n]]
        for k in range(len(directions)):
            own[k] = max(own[k], directions[k, 0] * x + directions[k, 1] * y)


def _moments(domain: GeodesicTriangulation, around: Floats) -> tuple[Floats, Floats]:
    """The mean of p p^T over the star of every vertex, (V, 2, 2), and the points p, (F, 3, m, 2)."""
    seen = tangent_points(domain, around)
    vertex = np.repeat(domain.vertex.ravel(), around.shape[2])
    x, y = seen.reshape(-1, 2).T
    xx, xy, yy = (np.bincount(vertex, weights=product) for product in (x * x, x * y, y * y))
    return np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2) / np.bincount(vertex)[:, None, None], seen


def _roots(moment: Floats) -> Floats:
    """Square roots of symmetric 2 x 2 matrices."""
    values, axes = np.linalg.eigh(moment)
    return np.asarray((axes * np.sqrt(values)[:, None, :]) @ np.swapaxes(axes, 1, 2))


def _regular(turn: ArrayLike) -> Floats:
    """The corners of regular triangles of circumradius 1, in columns: (2, 3, ...)."""
    angles = np.add.outer(2 * np.pi / 3 * np.arange(3), np.asarray(turn))
    return np.stack([np.cos(angles), np.sin(angles)])


def _on_tangent_planes(domain: GeodesicTriangulation, plane: Floats) -> Floats:
    """Points (V, 2, 3) of the plane x0 = 1 at the origin carried to the vertices, in the frames of their corners."""
    reference = domain.corners.reshape(-1, 3)[domain.vertex_corner]
    lifted = np.concatenate([np.ones((len(plane), 1, 3)), plane], axis=1)
    return np.asarray(domain.geometry.carry(reference) @ lifted)


def edge_normals(domain: GeodesicTriangulation) -> Floats:
    """Normals of the edges that look into their triangles, as long as the edges, (F, 3, 3).

    n = |e| J w / sqrt(w J w) with w = v_c x v_(c + 1) and J = diag(K, 1, 1), in the frame of each triangle: a vector
    that is tangent to X and orthogonal to the edge all along it. The gluing takes the normal of the twin to -n.
    """
    x = domain.corners
    across = np.cross(x, np.roll(x, -1, axis=1))
    normal = across * np.array([domain.geometry.curvature, 1.0, 1.0])
    length = np.sqrt((across * normal).sum(axis=-1))
    return np.asarray(normal * (domain.edge_lengths.reshape(-1, 3) / length)[..., None])


@dataclass(frozen=True, eq=False)
class PowellSabinSplit:
    """Every triangle in six, through its incentre Z and the points R where the segments Z Z' cross the edges.

    incentre: (F, 3), Z; edge_point: (F, 3, 3), R on every edge [triangle, edge, coordinate]; share: (F, 3, 2), mu and
    nu with R = mu v_c + nu v_(c + 1) and mu + nu = 1. Micro triangles 2 c and 2 c + 1 are (v_c, R_c, Z) and
    (v_(c + 1), R_c, Z).
    """

    domain: GeodesicTriangulation

    @cached_property
    def incentre(self) -> Floats:
        """The intersections of the bisectors: Z = (w1 - w2) x (w2 - w3) with edge covectors w of length 1."""
        x, k = self.domain.corners, self.domain.geometry.curvature
        covector = np.cross(x, np.roll(x, -1, axis=1))
        length = np.sqrt((covector**2 * np.array([k, 1.0, 1.0])).sum(axis=-1, keepdims=True))
        w = covector / length
        z = np.cross(w[:, 0] - w[:, 1], w[:, 1] - w[:, 2])
        return np.asarray(z / self.coordinates(z).sum(axis=1, keepdims=True))

    @cached_property
    def share(self) -> Floats:
        """Where the segments between neighbouring incentres cross their edge."""
        d = self.domain
        z = np.repeat(self.incentre, 3, axis=0)
        beyond = d.geometry.act(d.gluing, z[d.twin])
        plane = np.cross(z, beyond)
        start, end = d.corners.reshape(-1, 3), np.roll(d.corners, -1, axis=1).reshape(-1, 3)
        mu, nu = (plane * end).sum(axis=1), -(plane * start).sum(axis=1)
        return np.asarray(np.stack([mu, nu], axis=1) / (mu + nu)[:, None]).reshape(-1, 3, 2)

    @cached_property
    def edge_point(self) -> Floats:
        """R = mu v_c + nu v_(c + 1)."""
        x = self.domain.corners
        return np.asarray(self.share[..., :1] * x + self.share[..., 1:] * np.roll(x, -1, axis=1))

    @cached_property
    def cells(self) -> Floats:
        """The corners of the micro triangles, (F, 6, 3, 3)."""
        x, z = self.domain.corners, self.incentre
        cells = np.empty((self.domain.face_count, 6, 3, 3))
        for c in range(3):
            cells[:, 2 * c, 0], cells[:, 2 * c + 1, 0] = x[:, c], x[:, (c + 1) % 3]
            cells[:, 2 * c : 2 * c + 2, 1] = self.edge_point[:, c, None]
        cells[:, :, 2] = z[:, None]
        return cells

    @cached_property
    def around(self) -> Floats:
        """The split points in the star of every corner: R before, R after and Z, (F, 3, 3, 3)."""
        r = self.edge_point
        z = np.broadcast_to(self.incentre[:, None], r.shape)
        return np.stack([np.roll(r, 1, axis=1), r, z], axis=2)

    def coordinates(self, vectors: Floats) -> Floats:
        """The barycentric coordinates (F, 3) of one vector in every triangle, (F, 3)."""
        return np.asarray(np.linalg.solve(np.swapaxes(self.domain.corners, 1, 2), vectors[..., None])[..., 0])
