"""Scattered points: random points of X/H, spread over a surface by its area in space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]


def scattered_points(surface: OrbifoldSurface, area: Floats, count: int, seed: int = 0) -> Points:
    """Random points of X/H, one in every share of what the triangles of the map count, (F,), taken along them."""
    rng = np.random.default_rng(seed)
    upto = np.cumsum(area)
    wanted = (np.arange(count) + rng.random(count)) / count * upto[-1]
    face = np.minimum(np.searchsorted(upto, wanted), len(area) - 1)
    return surface.triangulation.locate(face, rng.dirichlet(np.ones(3), count))


def map_areas(surface: OrbifoldSurface) -> Floats:
    """The area in space of every triangle of the map, (F,), its corners on the surface, before that is scaled."""
    flat = surface.triangulation
    places = surface.basis.values(Points(flat.patch, flat.points), surface.coefficients)
    a, b, c = np.moveaxis(places[flat.polyhedron.triangles], 1, 0)
    return np.asarray(np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2)
