"""Harmonic: the map of a surface with chi <= 0 to X/H, with the group found from the mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from orbiframe import Geometry, MapError, Polyhedron, Triangulation, surface_type
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.developing import developed
from orbiframe_parametrizers.edge_weights import WEIGHTS
from orbiframe_parametrizers.flat import with_best_lattice
from orbiframe_parametrizers.harmonic_energy import minimised

Floats = NDArray[np.float64]

_PATCH_RADIUS = 1.0


def harmonic(
    polyhedron: Polyhedron,
    geometry: Geometry,
    group: object | None = None,
    *,
    weights: Literal["auto", "cotangent", "mean-value", "uniform"] = "auto",
) -> Triangulation:
    """Circle packing gives the group, an atlas carries it, and the harmonic map in it is the map of the mesh.

    polyhedron: a closed connected triangle mesh with chi <= 0, coherently oriented if orientable; geometry: H^2 for
    chi < 0, E^2 for chi = 0, where the lattice is the one of least energy besides. weights: "auto" tries cotangents
    and falls back to mean values, then ones, where a triangle is not positive. Raises MapError if none gives an
    embedding, or if a group is named (the group is found from the mesh).
    """
    if group is not None:
        raise MapError("the harmonic map finds its group from the mesh; leave the group out (group.method = 'mesh')")
    layout = _layout(polyhedron, geometry)
    names = ["cotangent", "mean-value", "uniform"] if weights == "auto" else [weights]
    for name in names:
        for triangulation in _attempt(layout, name):
            if triangulation.not_positive == 0:
                return triangulation
    raise MapError(
        f"no map without a fold was found with {' or '.join(names)} weights; "
        + ("refine the mesh (map.vertices) or remove needle-like triangles" if weights == "auto" else "use map.weights = 'auto'")
    )


def _layout(mesh: Polyhedron, geometry: Geometry) -> Triangulation:
    surface = surface_type(mesh)
    if surface.euler_characteristic > 0 or (surface.euler_characteristic < 0) != (geometry.curvature < 0):
        raise MapError(f"a surface with chi = {surface.euler_characteristic} does not live on {geometry.name}")
    packing = packed(mesh, geometry.curvature)
    lengths = packing.lengths
    if geometry.curvature == 0:
        lengths = lengths * np.sqrt(4 * np.pi / _flat_area(lengths))
    return developed(
        mesh,
        geometry,
        lengths,
        packing.angles,
        patch_radius=_PATCH_RADIUS,
        euler_characteristic=surface.euler_characteristic,
        orientable=surface.orientable,
    )


def _flat_area(lengths: Floats) -> float:
    sides = lengths.reshape(-1, 3)
    s = sides.sum(axis=1) / 2
    return float(np.sqrt(s * np.prod(s[:, None] - sides, axis=1)).sum())


def _attempt(layout: Triangulation, name: str) -> Iterator[Triangulation]:
    weights = WEIGHTS[name](layout.polyhedron)
    if not np.isfinite(weights).all():
        return
    try:
        points = minimised(layout, weights)
    except (MapError, RuntimeError):
        return
    result = replace(layout, points=points, group="mesh, by circle packing", weights=name)
    yield with_best_lattice(result, weights) if layout.orbifold.geometry.curvature == 0 else result
