"""Edge frames: gluings of triangles from the ends of their edges, and frames at the centres of triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.planes.geometry import Geometry

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


def about_centres(geometry: Geometry, corners: Floats, placement: Floats) -> tuple[Floats, Floats]:
    """Corners (F, 3, 3) seen from the centres of their triangles, and the placements (F, 3, 3) of these frames.

    Numbers are the smaller, and lose the fewer digits, the smaller the triangles are.
    """
    there = geometry.carry(geometry.project(corners.sum(axis=1)))
    near = geometry.settle(geometry.act(geometry.inverse(there)[:, None], corners))
    return near, geometry.nearest_isometry(placement @ there)


def edge_gluings(geometry: Geometry, corners: Floats, twin: Ints, same: Bools) -> Floats:
    """The isometries from triangle to triangle across every edge, from its ends in both frames, (3 F, 3, 3).

    h = F diag(1, 1, +-1) F'^-1 with the orthonormal frames F, F' of the edge at its start: nothing of what led to the
    corners is in it, and twins are inverse to one another to the last bit.
    """
    start, end = corners.reshape(-1, 3), np.roll(corners, -1, axis=1).reshape(-1, 3)
    first = np.flatnonzero(np.arange(len(twin)) <= twin)
    other, alike = twin[first], same[first, None]
    here = _flags(geometry, start[first], end[first])
    ends = np.where(alike, start[other], end[other]), np.where(alike, end[other], start[other])
    here[..., 2] *= np.where(alike, -1.0, 1.0)
    found = here @ geometry.inverse(_flags(geometry, *ends))
    gluing = np.empty((len(twin), 3, 3))
    gluing[other] = geometry.inverse(found)
    gluing[first] = found
    return gluing


def _flags(geometry: Geometry, p: Floats, q: Floats) -> Floats:
    """The isometries from the origin and the first direction to the points p and the directions from there to q."""
    bend = geometry.curvature * geometry.versine(p, q)
    return geometry.flag(p, geometry.chord(p, q) + bend[:, None] * p)
