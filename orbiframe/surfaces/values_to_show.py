"""Shown values: what one wants to see on a surface as colours, at the vertices of a mesh on it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.surfaces.surface import OrbifoldSurface, Tessellation

Floats = NDArray[np.float64]


class ShownValues(NamedTuple):
    """Numbers (V,) at the vertices of a tessellation.

    error: the distance to the input, in diagonals of its box; distortion: the ratio of the singular values of the map
    from the input to X/H, 1 where it is conformal; gaussian, mean: the curvatures, None without derivatives.
    """

    error: Floats
    distortion: Floats
    gaussian: Floats | None
    mean: Floats | None


def shown_values(surface: OrbifoldSurface, tessellation: Tessellation) -> ShownValues:
    """Error, distortion and curvature at the vertices of a mesh on a surface."""
    unit = (tessellation.mesh.vertices - surface.origin) / surface.scale
    error = NearestPoints(surface.refinement.polyhedron).distance(unit)
    distortion = _at_vertices(surface)[_nearest(surface, unit)]
    if not isinstance(surface.basis, DifferentiableBasis):
        return ShownValues(error, distortion, None, None)
    with np.errstate(all="ignore"):
        bent = surface.curvature(tessellation.points)
    return ShownValues(error, distortion, bent.gaussian, bent.mean)


def _at_vertices(surface: OrbifoldSurface) -> Floats:
    """The distortion at the vertices of the refined mesh: the mean of the triangles round each."""
    mesh = surface.triangulation.polyhedron
    total = np.bincount(mesh.tail, np.repeat(surface.triangulation.angle_distortion, 3), len(mesh.vertices))
    return np.asarray(total / np.maximum(np.bincount(mesh.tail, minlength=len(mesh.vertices)), 1))


def _nearest(surface: OrbifoldSurface, places: Floats) -> NDArray[np.intp]:
    from scipy.spatial import cKDTree

    own = surface.basis.values(surface.vertex_points, surface.coefficients)
    return np.asarray(cKDTree(own).query(places)[1], dtype=np.intp)
