"""The Euclidean plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe import Geometry, GeometryError

Floats = NDArray[np.float64]


class E2(Geometry):
    """The plane x0 = 1 of points (1, p) with p in R^2, curvature 0."""

    name = "e2"
    curvature = 0

    def project(self, x: ArrayLike) -> Floats:
        """x / x0 for vectors (..., 3). Raises GeometryError where x0 is not positive."""
        vectors = np.asarray(x, dtype=float)
        bad = np.flatnonzero(~(vectors[..., 0] > 0))
        if bad.size:
            raise GeometryError(
                f"vector {bad[0]} has x0 = {np.ravel(vectors[..., 0])[bad[0]]:.6g}; a point of the plane x0 = 1 needs "
                "x0 > 0: check the input"
            )
        return self.settle(vectors / vectors[..., :1])

    def settle(self, x: ArrayLike) -> Floats:
        """x with x0 = 1."""
        points = np.array(x, dtype=float)
        points[..., 0] = 1.0
        return points

    def inner(self, x: ArrayLike, v: ArrayLike, w: ArrayLike) -> Floats:  # noqa: ARG002
        """v1 w1 + v2 w2."""
        return np.asarray(np.sum(np.asarray(v, dtype=float)[..., 1:] * np.asarray(w, dtype=float)[..., 1:], axis=-1))

    def chord(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """y - x."""
        return np.asarray(np.subtract(y, x, dtype=float))

    def versine(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """d^2 / 2."""
        apart = self.chord(x, y)
        return np.asarray(self.inner(x, apart, apart) / 2)

    def distance(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """|x - y|."""
        return np.asarray(np.hypot(*np.moveaxis(self.chord(x, y)[..., 1:], -1, 0)))

    def exp(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """x + v."""
        return self.settle(np.asarray(x, dtype=float) + np.asarray(v, dtype=float))

    def log(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """y - x."""
        return self.chord(x, y)

    def turn(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """(0, -v2, v1)."""
        _, w = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(v, dtype=float))
        return np.stack([np.zeros_like(w[..., 0]), -w[..., 2], w[..., 1]], axis=-1)

    def from_polar(self, radius: ArrayLike, angle: ArrayLike) -> Floats:
        """(1, r cos a, r sin a)."""
        r, a = np.broadcast_arrays(np.asarray(radius, dtype=float), np.asarray(angle, dtype=float))
        return np.stack([np.ones_like(r), r * np.cos(a), r * np.sin(a)], axis=-1)

    def point_defect(self, x: ArrayLike) -> Floats:
        """|x0 - 1|."""
        return np.asarray(np.abs(np.asarray(x, dtype=float)[..., 0] - 1))

    def isometry_defect(self, g: ArrayLike) -> Floats:
        """Largest entry of R^T R - 1 for the linear part R, and of the first row minus (1, 0, 0)."""
        matrix = np.asarray(g, dtype=float)
        linear = matrix[..., 1:, 1:]
        bend = np.abs(np.swapaxes(linear, -1, -2) @ linear - np.eye(2)).max(axis=(-1, -2))
        return np.asarray(np.maximum(bend, np.abs(matrix[..., 0, :] - [1.0, 0.0, 0.0]).max(axis=-1)))

    def nearest_isometry(self, g: ArrayLike) -> Floats:
        """The same translation with the orthogonal polar factor of the linear part.

        Of a matrix with positive determinant that is the rotation by the angle of (a + d, c - b), otherwise the
        reflection with first column along (a - d, b + c).
        """
        matrix = np.array(g, dtype=float)
        a, b, c, d = (matrix[..., i, j] for i, j in ((1, 1), (1, 2), (2, 1), (2, 2)))
        sign = np.where(a * d >= b * c, 1.0, -1.0)
        cosine, sine = a + sign * d, c - sign * b
        length = np.hypot(cosine, sine)
        cosine, sine = cosine / length, sine / length
        matrix[..., 1:, 1:] = np.stack([cosine, -sign * sine, sine, sign * cosine], axis=-1).reshape(*a.shape, 2, 2)
        matrix[..., 0, :] = [1.0, 0.0, 0.0]
        return matrix

    def inverse(self, g: ArrayLike) -> Floats:
        """The transposed linear part R^T, and the shift t turned into -R^T t."""
        matrix = np.array(g, dtype=float)
        linear = np.swapaxes(matrix[..., 1:, 1:], -1, -2).copy()
        matrix[..., 1:, 0] = -np.einsum("...ij,...j->...i", linear, matrix[..., 1:, 0])
        matrix[..., 1:, 1:] = linear
        return matrix
