"""Harmonic: the map of a surface with chi <= 0 to X/H, with the group found from the mesh."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from annotated_types import Ge
from numpy.typing import NDArray

from orbiframe import Geometry, MapError, Polyhedron, SurfaceType, Triangulation, surface_type
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.developing import developed, edge_isometries, in_patches
from orbiframe_parametrizers.embedding import embedded
from orbiframe_parametrizers.even_areas import evened
from orbiframe_parametrizers.flat import with_best_lattice
from orbiframe_parametrizers.vertex_scaling import scaled

Floats = NDArray[np.float64]

_PATCH_RADIUS = 1.0
_GOOD = 1.2


def harmonic(
    polyhedron: Polyhedron,
    geometry: Geometry,
    group: object | None = None,
    *,
    metric: Literal["auto", "vertex-scaling", "circle-packing"] = "auto",
    weights: Literal["auto", "cotangent", "mixed", "mean-value", "uniform"] = "auto",
    even_areas: Annotated[int, Ge(0)] = 0,
) -> Triangulation:
    """A metric of constant curvature gives the group, an atlas carries it, the harmonic map in it is the map.

    polyhedron: a closed connected triangle mesh with chi <= 0, coherently oriented if orientable; geometry: H^2 for
    chi < 0, E^2 for chi = 0, where the lattice is the one of least energy besides, whatever the metric. metric:
    "vertex-scaling" is conformal to the mesh, "circle-packing" knows its connectivity alone and exists for every mesh;
    "auto" scales, and packs where that fails or leaves a median angle distortion above 1.2, and takes the better
    map. weights: "auto" tries cotangents,
    then cotangents with mean values about the folds ("mixed"), then mean values, then ones, until every triangle is
    positive. even_areas: rounds that pull areas in X towards those in space, at the cost of angles; 8 are many.
    Raises MapError if none gives an embedding, if the surface does not live on the geometry, or if a group
    is named (the group is found from the mesh).
    """
    if group is not None:
        raise MapError("this map finds its group from the mesh; set group.method = 'mesh' or map.method = 'auto'")
    surface = surface_type(polyhedron)
    if surface.euler_characteristic > 0 or np.sign(surface.euler_characteristic) != geometry.curvature:
        raise MapError(f"a surface with chi = {surface.euler_characteristic} does not live on {geometry.name}")
    return evened(_harmonic(polyhedron, geometry, surface, metric, weights), even_areas)


def _harmonic(mesh: Polyhedron, geometry: Geometry, surface: SurfaceType, metric: str, weights: str) -> Triangulation:
    if geometry.curvature == 0:
        return embedded(_packed_layout(mesh, geometry, surface), weights, with_best_lattice)
    if metric == "auto":
        return _best(mesh, geometry, surface, weights)
    layout = scaled_layout if metric == "vertex-scaling" else _packed_layout
    return embedded(layout(mesh, geometry, surface), weights)


def _best(mesh: Polyhedron, geometry: Geometry, surface: SurfaceType, weights: str) -> Triangulation:
    """The map of the scaled metric if it is good, else the better one of both metrics."""
    try:
        scaled_map = embedded(scaled_layout(mesh, geometry, surface), weights)
    except MapError:
        return embedded(_packed_layout(mesh, geometry, surface), weights)
    if np.median(scaled_map.angle_distortion) <= _GOOD:
        return scaled_map
    try:
        packed_map = embedded(_packed_layout(mesh, geometry, surface), weights)
    except MapError:
        return scaled_map
    return min(scaled_map, packed_map, key=lambda made: float(np.median(made.angle_distortion)))


def scaled_layout(
    mesh: Polyhedron, geometry: Geometry, surface: SurfaceType, sides: Floats | None = None
) -> Triangulation:
    """The metric of the vertex scaling, carried from its Delaunay triangulation back to the edges of the mesh.

    sides: (H,), edge lengths that take the place of those in space.
    """
    scaling = scaled(mesh, sides)
    steps = edge_isometries(scaling.triangulation.mesh(), geometry, scaling.lengths, scaling.angles)
    steps = scaling.triangulation.undone(steps, geometry.inverse(steps))
    other = np.flatnonzero(~mesh.representative)
    twin = mesh.twin[other]
    steps[other] = np.where(mesh.same[other, None, None], steps[twin], geometry.inverse(steps[twin]))
    lengths = geometry.distance(geometry.origin, steps[..., 0])
    layout = in_patches(mesh, geometry, lengths, steps, surface=surface, patch_radius=_PATCH_RADIUS)
    return replace(layout, group="mesh, by vertex scaling")


def _packed_layout(mesh: Polyhedron, geometry: Geometry, surface: SurfaceType) -> Triangulation:
    """The metric of the circle packing."""
    packing = packed(mesh, geometry.curvature)
    lengths = packing.lengths
    if geometry.curvature == 0:
        lengths = lengths * np.sqrt(4 * np.pi / _flat_area(lengths))
    layout = developed(mesh, geometry, lengths, packing.angles, surface=surface, patch_radius=_PATCH_RADIUS)
    return replace(layout, group="mesh, by circle packing")


def _flat_area(lengths: Floats) -> float:
    sides = lengths.reshape(-1, 3)
    s = sides.sum(axis=1) / 2
    return float(np.sqrt(s * np.prod(s[:, None] - sides, axis=1)).sum())
