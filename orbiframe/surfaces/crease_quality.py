"""Crease quality: how sharp and how near the creases of a surface are, and how smooth it is beside them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from orbiframe.orbifolds.atlas import Points
from orbiframe.splines.element_basis import ElementBasis
from orbiframe.splines.hairs import hair_points
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.triangulations.crease_chains import CreaseGraph

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# How far inside of a triangle beside a crease its tangent plane is taken, as a share of the triangle.
_BESIDE = 1e-6
_NEAREST = 8
# From so many degrees on a kink can be seen.
_KINK = 1.0


class CreaseQuality(NamedTuple):
    """What the creases of a surface for a mesh of unit size are.

    curves: how many run between corners, ends and themselves; corners, ends: of creases; edges: of the domain;
    distance: the largest of the vertices on the creases of the mesh from the creases of the surface and back, in
    diagonals; angle: the root mean square of what the angle of the surface lacks to that of the facets, in degrees;
    kinks: the root mean square and the largest of the angles at hairs, where the surface should be smooth, in degrees;
    place: where the largest is, in space.
    """

    curves: int
    corners: int
    ends: int
    edges: int
    distance: float
    angle: float
    kinks: tuple[float, float]
    place: tuple[float, float, float]

    def notes(self) -> Iterator[str]:
        """Sentences for what a user should look at."""
        if self.kinks[1] > _KINK:
            where = ", ".join(f"{x:.6g}" for x in self.place)
            yield (
                f"the surface has kinks of up to {self.kinks[1]:.1f}° beside its creases, where it should be smooth, "
                f"near ({where}); more functions help (option size), or a larger angle"
            )


def crease_quality(surface: OrbifoldSurface) -> CreaseQuality | None:
    """The quality of the creases of a surface; None where it has none, or functions that keep none."""
    flat, basis = surface.triangulation, surface.basis
    if flat.crease is None or not isinstance(basis, ElementBasis):
        return None
    graph = CreaseGraph.of(surface.refinement.polyhedron, flat.sharp)
    curves = sum(1 for _ in graph.chains(flat))
    degree, sharp = basis.domain.sharp_degree, basis.domain.sharp
    kinks, place = _kinks(surface, basis)
    return CreaseQuality(
        curves,
        int((degree > 2).sum()),
        int((degree == 1).sum()),
        int((sharp & basis.domain.reference).sum()),
        _distance(surface),
        float(np.degrees(np.sqrt(np.mean(_angles(surface) ** 2)))),
        (float(np.sqrt(np.mean(kinks**2))), float(kinks.max())) if len(kinks) else (0.0, 0.0),
        place,
    )


def _kinks(surface: OrbifoldSurface, basis: ElementBasis) -> tuple[Floats, tuple[float, float, float]]:
    """The angles between the tangent planes on both sides of hairs in degrees, (n,), and where the largest is."""
    inside, outside, _ = hair_points(basis.domain)
    found = np.degrees(_between(_unplaced_normals(surface, inside), _unplaced_normals(surface, outside)))
    if not len(found):
        return found, (0.0, 0.0, 0.0)
    worst = np.array([found.argmax()])
    x, y, z = (float(number) for number in surface.evaluate(Points(inside.patch[worst], inside.x[worst]))[0])
    return found, (x, y, z)


def _unplaced_normals(surface: OrbifoldSurface, points: Points) -> Floats:
    return surface.normals(points) if len(points.patch) else np.zeros((0, 3))


def _angles(surface: OrbifoldSurface) -> Floats:
    """The angle of the surface less that of the facets at the middles of the edges of the mesh on creases, (n,)."""
    flat, mesh = surface.triangulation, surface.refinement.polyhedron
    halfedge = np.flatnonzero(flat.sharp & mesh.representative)
    sides = halfedge, mesh.twin[halfedge]
    here, there = (surface.normals(_middles(surface, side)) * flat.face_signs[side // 3, None] for side in sides)
    corners = mesh.vertices[mesh.triangles]
    vector = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    vector /= np.maximum(np.linalg.norm(vector, axis=1), np.finfo(float).tiny)[:, None]
    turn = np.where(mesh.same[halfedge], -1.0, 1.0)[:, None]
    return np.abs(_between(here, turn * there) - _between(vector[sides[0] // 3], turn * vector[sides[1] // 3]))


def _middles(surface: OrbifoldSurface, halfedge: Ints) -> Points:
    """Points beside the middles of halfedges of the refined mesh, within their triangles."""
    face, c = np.divmod(halfedge, 3)
    barycentric = np.full((len(face), 3), (1 - _BESIDE) / 2)
    barycentric[np.arange(len(face)), (c + 2) % 3] = _BESIDE
    return surface.triangulation.locate(face, barycentric)


def _between(a: Floats, b: Floats) -> Floats:
    """The angles between unit vectors, (n,)."""
    return np.asarray(2 * np.arctan2(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1)))


def _distance(surface: OrbifoldSurface) -> float:
    """The largest distance between the creases of the mesh and those of the surface, both as chains of segments."""
    flat, mesh = surface.triangulation, surface.refinement.polyhedron
    halfedge = np.flatnonzero(flat.sharp & mesh.representative)
    ends = np.stack([mesh.tail[halfedge], mesh.head[halfedge]], axis=1)
    vertex = np.unique(ends)
    place = np.full(len(mesh.vertices), -1)
    place[vertex] = np.arange(len(vertex))
    curve = surface.evaluate(Points(flat.patch[vertex], flat.points[vertex]))
    curve = (curve - surface.origin) / surface.scale
    given = mesh.vertices[vertex]
    return max(_to_segments(curve, given[place[ends]]), _to_segments(given, curve[place[ends]]))


def _to_segments(x: Floats, segments: Floats) -> float:
    """The largest distance of points (n, 3) from the segments (m, 2, 3) whose middles are near."""
    near = cKDTree(segments.mean(axis=1)).query(x, k=min(_NEAREST, len(segments)))[1].reshape(len(x), -1)
    start, way = segments[near, 0], segments[near, 1] - segments[near, 0]
    square = np.maximum((way**2).sum(axis=2), np.finfo(float).tiny)
    share = np.clip(((x[:, None] - start) * way).sum(axis=2) / square, 0, 1)
    away = np.linalg.norm(start + share[..., None] * way - x[:, None], axis=2)
    return float(away.min(axis=1).max())
