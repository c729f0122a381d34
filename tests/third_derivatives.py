"""Third covariant derivatives against differences of the Hessian along geodesics."""

from __future__ import annotations

import numpy as np

from orbiframe import DifferentiableBasis, Points


def error_of_third_derivatives(basis: DifferentiableBasis, points: Points, step: float) -> np.ndarray:
    """The largest error of the jets of order 3 at every point, relative to the largest entry of all, (n,).

    Along a geodesic its velocity T and N = T turned by 90 degrees are parallel, so the derivatives of Hess(T, T),
    Hess(T, N) and Hess(N, N) are those of the tensor: for T = e1 and for T = e2, where N = -e1.
    """
    jets = np.stack([matrix.toarray() for matrix in basis.jet_matrices(points, 3)])
    d1, d2 = jets[6:9], jets[9:12]
    frame = basis.orbifold.geometry.frame(points.x)
    along1 = _hessian_slopes(basis, points, frame[:, :, 0], step)
    along2 = _hessian_slopes(basis, points, frame[:, :, 1], step)
    difference = np.concatenate([along1 - d1, along2 - np.stack([d2[2], -d2[1], d2[0]])])
    return np.asarray(np.abs(difference).max(axis=(0, 2)) / np.abs(jets[6:]).max())


def _hessian_slopes(basis: DifferentiableBasis, points: Points, velocity: np.ndarray, h: float) -> np.ndarray:
    """The derivatives of Hess(T, T), Hess(T, N), Hess(N, N) by differences of fourth order, (3, n, size)."""
    near, far = (_hessian(basis, points, velocity, k * h) - _hessian(basis, points, velocity, -k * h) for k in (1, 2))
    return np.asarray((8 * near - far) / (12 * h))


def _hessian(basis: DifferentiableBasis, points: Points, velocity: np.ndarray, t: float) -> np.ndarray:
    geometry = basis.orbifold.geometry
    y = geometry.exp(points.x, t * velocity)
    forwards = -geometry.log(y, points.x) / t
    frame = geometry.frame(y)
    c, s = (geometry.inner(y, forwards, frame[:, :, k])[:, None] for k in (0, 1))
    h11, h12, h22 = (m.toarray() for m in basis.jet_matrices(Points(points.patch, y), 2)[3:])
    return np.stack(
        [
            c * c * h11 + 2 * c * s * h12 + s * s * h22,
            c * s * (h22 - h11) + (c * c - s * s) * h12,
            s * s * h11 - 2 * c * s * h12 + c * c * h22,
        ]
    )
