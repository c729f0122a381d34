"""Vertex jets: jets of splines at the vertices of their domain.

The k-jet of a spline of degree d at a vertex v is the homogeneous polynomial P(u) = B(v^(d-k), u^k), B the blossom. The
coefficients within distance k of that corner of a triangle are those of P on the triangle. So jets need no tangent
frames, and are carried from triangle to triangle by substitution.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.splines.bernstein import coefficient_count, symmetric_power
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class VertexJets:
    """Jets of one order at all vertices: Bernstein coefficients of P on a triangle about each vertex.

    order: k; triangles: (V, 3, 3), the corners in columns, in the frame of the reference corner of the vertex, on the
    plane beta(v, q) = 1 (in E^2 q0 = 1), which touches X in S^2 and H^2; sector: (F, 3), the number of the triangle of
    every corner, where creases divide the stars of vertices (see `Sectors`), by default its vertex.
    """

    domain: GeodesicTriangulation
    order: int
    triangles: Floats
    sector: Ints | None = None

    @property
    def count(self) -> int:
        """Unknowns of a vertex: (k + 1)(k + 2) / 2."""
        return coefficient_count(self.order)

    @cached_property
    def _to_reference(self) -> Floats:
        """From frames of triangles to coordinates in the triangle about the vertex of each corner, (F, 3, 3, 3)."""
        inverse = np.linalg.inv(self.triangles)[self.domain.vertex if self.sector is None else self.sector]
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


@compiled
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
