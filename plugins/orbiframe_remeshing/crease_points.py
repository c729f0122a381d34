"""Crease points: points of X/H on the creases of a surface, near some places in space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from orbiframe import OrbifoldSurface, Points
from orbiframe.splines import ElementBasis

Floats = NDArray[np.float64]

# Points on every edge of the domain that is a crease.
_EACH = 64


def crease_points(surface: OrbifoldSurface, places: Floats) -> Points:
    """Points on the creases, each about the nearest to one of some places (n, 3), before the surface is placed."""
    assert isinstance(surface.basis, ElementBasis)
    domain = surface.basis.domain
    geometry, share = domain.geometry, ((np.arange(_EACH) + 0.5) / _EACH)[:, None]
    face, c = np.divmod(np.flatnonzero(domain.sharp & domain.reference), 3)
    start, end = domain.corners[face, c][:, None], domain.corners[face, (c + 1) % 3][:, None]
    along = geometry.project((1 - share) * start + share * end)
    x = geometry.settle(geometry.act(domain.placement[face][:, None], along)).reshape(-1, 3)
    patch = np.repeat(domain.patch[face], _EACH)
    nearest = cKDTree(surface.basis.values(Points(patch, x), surface.coefficients)).query(places)[1]
    return surface.orbifold.settled(Points(patch[nearest], x[nearest]))
