"""Nearest points: how far points in space are from a triangle mesh, exactly."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from orbiframe.compiled.decorator import compiled
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_FIRST = 8  # triangles that are tried first, those with the nearest centroids


class NearestPoints:
    """Distances of points to a triangle mesh: all triangles are tried whose centroid is near enough to matter."""

    def __init__(self, mesh: Polyhedron) -> None:
        self._corners = np.ascontiguousarray(mesh.vertices[mesh.triangles])
        centroid = self._corners.mean(axis=1)
        self._tree = cKDTree(centroid)
        self._radius = float(np.linalg.norm(self._corners - centroid[:, None], axis=2).max())

    def distance(self, points: Floats) -> Floats:
        """The distance of each point to the mesh, (n,)."""
        found = np.empty(len(points))
        open_, count = np.arange(len(points)), min(_FIRST, len(self._corners))
        while len(open_):
            away, face = self._tree.query(points[open_], k=count)
            away, face = (np.reshape(part, (len(open_), -1)) for part in (away, face))
            found[open_] = _least(points[open_], self._corners, face)
            certain = (found[open_] <= away[:, -1] - self._radius) | (count == len(self._corners))
            open_, count = open_[~certain], min(4 * count, len(self._corners))
        return found


@compiled
def _least(points, corners, face):  # type: ignore[no-untyped-def]
    """The least distance of each point to its triangles (n, k)."""
    found = np.empty(len(points))
    for n in range(len(points)):
        least = np.inf
        for k in range(face.shape[1]):
            least = min(least, _square(points[n], corners[face[n, k]]))
        found[n] = np.sqrt(least)
    return found


@compiled(inline=True)
def _square(p, corners):  # type: ignore[no-untyped-def]
    """The squared distance of a point to a triangle: to its plane over the inside, else to the nearest side."""
    a, b, c = corners[0], corners[1], corners[2]
    u, v, w = b - a, c - a, p - a
    uu, uv, vv = u @ u, u @ v, v @ v
    wu, wv = w @ u, w @ v
    whole = uu * vv - uv * uv
    s, t = wu * vv - wv * uv, wv * uu - wu * uv
    if whole > 0 and s >= 0 and t >= 0 and s + t <= whole:
        away = w - (s / whole) * u - (t / whole) * v
        return away @ away
    return min(_to_side(p, a, b), min(_to_side(p, b, c), _to_side(p, c, a)))


@compiled(inline=True)
def _to_side(p, a, b):  # type: ignore[no-untyped-def]
    side, w = b - a, p - a
    length = side @ side
    share = min(max((w @ side) / length, 0.0), 1.0) if length > 0 else 0.0
    away = w - share * side
    return away @ away
