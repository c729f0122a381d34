"""Quadrature: integrals over geodesic triangles."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import roots_jacobi, roots_legendre

from orbiframe.planes.geometry import Geometry

Floats = NDArray[np.float64]


@lru_cache(maxsize=64)
def triangle_rule(n: int) -> tuple[Floats, Floats]:
    """Barycentric points (n^2, 3) and weights (n^2,) of sum 1 for averages over a flat triangle.

    Gauss-Legendre times Gauss-Jacobi on the collapsed square (Stroud's conical product): exact for polynomials of
    degree 2n - 1, all points inside, all weights positive. The arrays are shared between calls and read-only.
    """
    along, along_weights = roots_legendre(n)
    across, across_weights = roots_jacobi(n, 1, 0)
    u, v = np.meshgrid((1 + across) / 2, (1 + along) / 2, indexing="ij")
    points = np.stack([u, (1 - u) * v, (1 - u) * (1 - v)], axis=-1).reshape(-1, 3)
    weights = np.outer(across_weights, along_weights).ravel() / 4
    for array in (points, weights):
        array.setflags(write=False)
    return points, weights


def triangle_points(geometry: Geometry, corners: Floats, n: int) -> tuple[Floats, Floats]:
    """Points of geodesic triangles and their area weights: x (F, n^2, 3) and weights (F, n^2).

    corners: (F, 3, 3), [triangle, corner], as `Triangulation.lifts` gives them. The points are those of
    `triangle_rule` seen from the origin of R^3: x = p / rho(p) for p = sum lambda_i v_i, and the area element is
    dA = |det(v1, v2, v3)| / rho(p)^3 dlambda1 dlambda2, where rho^2 = x0^2 + K (x1^2 + x2^2) (E^2: rho = x0). The sum
    of the weights converges to the area exponentially in n; a triangle with sides above 2.5 wants subdivision first.
    """
    barycentric, weights = triangle_rule(n)
    flat = barycentric @ corners
    edges = geometry.chord(corners[:, :1], corners[:, 1:])
    volume = np.abs(np.sum(corners[:, 0] * np.cross(edges[:, 0], edges[:, 1]), axis=-1))
    scale = _radius(geometry, corners, barycentric)
    return geometry.settle(flat / scale[..., None]), volume[:, None] / scale**3 * weights / 2


def _radius(geometry: Geometry, corners: Floats, barycentric: Floats) -> Floats:
    """rho of sum lambda_i v_i without cancellation: rho^2 = 1 - 2 K sum_(i<j) lambda_i lambda_j c_ij."""
    after = np.roll(corners, -1, axis=1)
    pairs = barycentric * np.roll(barycentric, -1, axis=1)
    return np.asarray(np.sqrt(1 - 2 * geometry.curvature * geometry.versine(corners, after) @ pairs.T))
