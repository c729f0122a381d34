"""Harmonic: the map of a surface with chi <= 0 to X/H, with the group found from the mesh."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from orbiframe import Geometry, MapError, Polyhedron, Triangulation, surface_type
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.developing import developed, with_patch_radii
from orbiframe_parametrizers.edge_weights import WEIGHTS, cotangent, mean_value
from orbiframe_parametrizers.flat import with_best_lattice
from orbiframe_parametrizers.harmonic_energy import minimised

Floats = NDArray[np.float64]

_PATCH_RADIUS = 1.0
_ROUNDS = 4


def harmonic(
    polyhedron: Polyhedron,
    geometry: Geometry,
    group: object | None = None,
    *,
    weights: Literal["auto", "cotangent", "mixed", "mean-value", "uniform"] = "auto",
) -> Triangulation:
    """Circle packing gives the group, an atlas carries it, and the harmonic map in it is the map of the mesh.

    polyhedron: a closed connected triangle mesh with chi <= 0, coherently oriented if orientable; geometry: H^2 for
    chi < 0, E^2 for chi = 0, where the lattice is the one of least energy besides. weights: "auto" tries cotangents,
    then cotangents with mean values about the folds ("mixed"), then mean values, then ones, until every triangle is
    positive. Raises MapError if none gives an embedding, if the surface does not live on the geometry, or if a group
    is named (the group is found from the mesh).
    """
    if group is not None:
        raise MapError("the harmonic map finds its group from the mesh; leave the group out (group.method = 'mesh')")
    layout = _layout(polyhedron, geometry)
    names = ["cotangent", "mixed", "mean-value", "uniform"] if weights == "auto" else [weights]
    for name in names:
        result = _mixed(layout) if name == "mixed" else _mapped(layout, name, WEIGHTS[name](polyhedron))
        if result is None:
            continue
        if result.not_positive == 0:
            return result
        layout = result if name == "cotangent" else layout  # a better first guess than the packing
    raise MapError(
        f"no map without a fold was found with {' or '.join(names)} weights; "
        + ("remove needle-like triangles or refine the mesh" if weights == "auto" else "use map.weights = 'auto'")
    )


def _layout(mesh: Polyhedron, geometry: Geometry) -> Triangulation:
    surface = surface_type(mesh)
    if surface.euler_characteristic > 0 or np.sign(surface.euler_characteristic) != geometry.curvature:
        raise MapError(f"a surface with chi = {surface.euler_characteristic} does not live on {geometry.name}")
    packing = packed(mesh, geometry.curvature)
    lengths = packing.lengths
    if geometry.curvature == 0:
        lengths = lengths * np.sqrt(4 * np.pi / _flat_area(lengths))
    return developed(mesh, geometry, lengths, packing.angles, surface=surface, patch_radius=_PATCH_RADIUS)


def _flat_area(lengths: Floats) -> float:
    sides = lengths.reshape(-1, 3)
    s = sides.sum(axis=1) / 2
    return float(np.sqrt(s * np.prod(s[:, None] - sides, axis=1)).sum())


def _mapped(layout: Triangulation, name: str, weights: Floats) -> Triangulation | None:
    """The harmonic map with given weights from a first guess; None where there is none. It may have folds."""
    if not np.isfinite(weights).all():
        return None
    try:
        points = minimised(layout, weights)
    except MapError:
        return None
    result = replace(layout, points=points, group="mesh, by circle packing", weights=name)
    if layout.orbifold.geometry.curvature == 0:
        result = with_best_lattice(result, weights)
    return with_patch_radii(result)


def _mixed(layout: Triangulation) -> Triangulation | None:
    """Cotangents, but mean values on the edges about every fold; the region grows until no fold is left."""
    mesh = layout.polyhedron
    soft, firm = cotangent(mesh), mean_value(mesh)
    if not (np.isfinite(soft).all() and np.isfinite(firm).all()):
        return None
    # Mean values have the dimension 1 / length; on equilateral triangles both are now the same.
    firm = firm * mesh.edge_lengths.mean() / 2
    result = _mapped(layout, "mixed", soft)
    near = np.zeros(len(mesh.vertices), dtype=np.bool_)
    for round_ in range(_ROUNDS):
        if result is None or result.not_positive == 0:
            return result
        near[mesh.triangles[~(result.areas > 0)]] = True
        for _ in range(1 + round_):
            near[mesh.triangles[near[mesh.triangles].any(axis=1)]] = True
        weights = np.where(near[mesh.tail] | near[mesh.head], firm, soft)
        result = _mapped(replace(layout, points=result.points), "mixed", weights)
    return result
