"""Regular faces: a map to X/H changed so that its triangles get wished shapes, as far as the surface allows."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from annotated_types import Ge
from numpy.typing import NDArray

from orbiframe import MapError, Polyhedron, SurfaceType, Triangulation, surface_type
from orbiframe_parametrizers.developing import with_patch_radii
from orbiframe_parametrizers.flat import with_best_lattice
from orbiframe_parametrizers.harmonic import scaled_layout
from orbiframe_parametrizers.harmonic_energy import minimised
from orbiframe_parametrizers.shape_energy import ShapeEnergy, cotangents_and_areas, reshaped

Floats = NDArray[np.float64]


def regular_faces(
    triangulation: Triangulation,
    target: Floats,
    *,
    group: Literal["auto", "kept"] = "auto",
    area: Annotated[float, Ge(0)] = 0.0,
) -> Triangulation:
    """The map of least shape energy: step 3 of section 3.4, "faces as square-like as possible".

    triangulation: a map without a fold; target: (F, 3, 2), the wished triangles in the plane, counterclockwise. group:
    "auto" looks for a better group where that of the map comes from the mesh and chi <= 0, namely the one in which the
    surface glued from the wished triangles is mapped conformally, and "kept" never does. area: how much equal areas
    count against right angles and sides; 0 is shape alone. The result has no fold, and no more energy than the given
    map. Raises MapError if the given map has a fold.
    """
    if triangulation.not_positive:
        raise MapError(f"{triangulation.not_positive} triangles of the map are folded; shapes start from a map without")
    start = triangulation
    if group == "auto" and triangulation.group.startswith("mesh") and triangulation.orbifold.euler_characteristic <= 0:
        start = _best(target, area, triangulation, _conformal(triangulation, target))
    result = with_patch_radii(reshaped(start, target, area))
    return replace(_best(target, area, start, result), weights="shape")


def _best(target: Floats, area: float, first: Triangulation, second: Triangulation | None) -> Triangulation:
    """The second map if it has no fold, whole relations and less energy, else the first."""
    if second is None or second.not_positive or not second.relation_defect < 1e-12:
        return first
    values = [ShapeEnergy(made, target, area).value(made.points) for made in (first, second)]
    return second if values[1] < values[0] else first


def _conformal(given: Triangulation, target: Floats) -> Triangulation | None:
    """The harmonic map of the surface glued from the wished triangles, to the group that suits it; None for none."""
    mesh, geometry = given.polyhedron, given.orbifold.geometry
    weights = _cotangent_weights(mesh, target)
    try:
        if geometry.curvature == 0:
            flat = replace(given, points=minimised(given, weights))
            return with_patch_radii(with_best_lattice(flat, weights))
        sides = np.linalg.norm(np.roll(target, -1, axis=1) - target, axis=2).ravel()
        surface: SurfaceType = surface_type(mesh)
        layout = scaled_layout(mesh, geometry, surface, sides)
        layout = replace(layout, group="mesh, by vertex scaling of regular faces")
        return with_patch_radii(replace(layout, points=minimised(layout, weights)))
    except MapError:
        return None


def _cotangent_weights(mesh: Polyhedron, target: Floats) -> Floats:
    """Half the sum of the cotangents of the two wished angles opposite to an edge, (H,)."""
    opposite = cotangents_and_areas(target)[0].ravel()[mesh.next[mesh.next]]
    return np.asarray((opposite + opposite[mesh.twin]) / 2)
