"""Centres and supports of orbit sums: spread evenly over the surface in space, as wide as they must be."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import FitError, Geometry, Triangulation, UsageError
from orbiframe.meshes import Spacing, dijkstra_forest, edge_graph, farthest_points, outermost_vertex
from orbiframe.triangulations import site_lengths

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def require_positive(basis: str, **options: float) -> None:
    """Raises UsageError for an option that is not positive."""
    for name, value in options.items():
        if not value > 0:
            raise UsageError(f"option {name} of the basis {basis} is {value}; it must be positive")


def require_share(basis: str, **options: float) -> None:
    """Raises UsageError for an option that is no share of a whole."""
    for name, value in options.items():
        if not 0 <= value < 1:
            raise UsageError(f"option {name} of the basis {basis} is {value}; it must be at least 0 and less than 1")


def spread(triangulation: Triangulation, size: int, grading: float) -> Spacing:
    """Centres by 3D edge lengths and the density of `site_density`, from the vertex farthest from the centroid on."""
    mesh = triangulation.polyhedron
    graph = edge_graph(mesh, site_lengths(triangulation, grading))
    spacing = farthest_points(graph, size, first=outermost_vertex(mesh))
    if len(spacing.chosen) < size:
        raise FitError(
            f"{size} functions need as many distinct vertices as centres, and the mesh has {len(spacing.chosen)}; "
            "lower the option size or refine the mesh first"
        )
    return spacing


def supports(triangulation: Triangulation, spacing: Spacing, per_area: float) -> Floats:
    """The versine at which each function ends: from smoothed areas of regions, at least what covers the surface."""
    mesh = triangulation.polyhedron
    areas = np.bincount(mesh.tail, weights=np.repeat(np.abs(triangulation.areas) / 3, 3), minlength=len(spacing.owner))
    regions = np.bincount(spacing.owner, weights=areas, minlength=len(spacing.chosen))
    least = _covering(triangulation, spacing)
    support = np.maximum(per_area * regions, least)
    for _ in range(2):
        support = _smoothed(support, spacing.owner[mesh.tail], spacing.owner[mesh.head])
    return np.asarray(np.maximum(support, least))


def _covering(triangulation: Triangulation, spacing: Spacing) -> Floats:
    """Versines that cover every triangle, by centre, with a quarter to spare.

    A point of a triangle lies within 0.7 longest edges of some corner of it (the worst is the middle of an equilateral
    one: 0.58 in E^2, less in H^2, on S^2 0.7 at edges of 2), and the corner within the length of its path, measured in
    X, of the centre that owns it.
    """
    mesh, lengths = triangulation.polyhedron, _lengths(triangulation)
    path = dijkstra_forest(edge_graph(mesh, lengths), spacing.chosen)
    longest = np.zeros(len(mesh.vertices))
    np.maximum.at(longest, mesh.tail, np.maximum.reduceat(lengths, mesh.offsets[:-1])[mesh.face])
    farthest = np.zeros(len(spacing.chosen))
    np.maximum.at(farthest, path.owner, path.distance + 0.7 * longest)
    return np.asarray(np.maximum(1.25 * _versine(triangulation.orbifold.geometry, farthest), np.finfo(float).tiny))


def _lengths(triangulation: Triangulation) -> Floats:
    """Length in X of every halfedge."""
    mesh, orbifold, x = triangulation.polyhedron, triangulation.orbifold, triangulation.points
    heads = orbifold.geometry.act(orbifold.atlas.isometry[triangulation.transition], x[mesh.head])
    return np.asarray(orbifold.geometry.distance(x[mesh.tail], heads))


def _versine(geometry: Geometry, distance: Floats) -> Floats:
    """1 - cos d, d^2 / 2 or cosh d - 1 without cancellation; from pi on in S^2, where no point is farther, 2."""
    if geometry.curvature > 0:
        return np.asarray(2 * np.sin(np.minimum(distance, np.pi) / 2) ** 2)
    return np.asarray(2 * (np.sinh(distance / 2) if geometry.curvature < 0 else distance / 2) ** 2)


def _smoothed(values: Floats, a: Ints, b: Ints) -> Floats:
    """Geometric means, half of a value itself and half of its neighbours; a and b: the ends of their links, (n,)."""
    a, b = np.unique(np.stack([a, b])[:, a != b], axis=1)
    logs = np.log(values)
    degree = np.bincount(a, minlength=len(values))
    around = np.bincount(a, weights=logs[b], minlength=len(values))
    return np.exp(np.where(degree > 0, (logs + around / np.maximum(degree, 1)) / 2, logs))
