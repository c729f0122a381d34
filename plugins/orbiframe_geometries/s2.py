"""The unit sphere."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe import Geometry, GeometryError

Floats = NDArray[np.float64]


class S2(Geometry):
    """The unit sphere |x| = 1 of Euclidean space, curvature +1."""

    name = "s2"
    curvature = 1

    def project(self, x: ArrayLike) -> Floats:
        """x / |x| for vectors (..., 3). Raises GeometryError for a vector that is zero or not finite."""
        vectors = np.asarray(x, dtype=float)
        length = np.sqrt(np.sum(vectors**2, axis=-1, keepdims=True))
        bad = np.flatnonzero(~((length > 0) & np.isfinite(length)))
        if bad.size:
            raise GeometryError(
                f"vector {bad[0]} has length {np.ravel(length)[bad[0]]:.6g}; a point of the sphere needs a finite "
                "vector other than zero: check the input"
            )
        return np.asarray(vectors / length)

    def settle(self, x: ArrayLike) -> Floats:
        """x / |x|: a drifted point scaled back to the sphere."""
        points = np.asarray(x, dtype=float)
        return np.asarray(points / np.sqrt(np.sum(points**2, axis=-1, keepdims=True)))

    def inner(self, x: ArrayLike, v: ArrayLike, w: ArrayLike) -> Floats:  # noqa: ARG002
        """v . w."""
        return np.asarray(np.sum(np.asarray(v, dtype=float) * np.asarray(w, dtype=float), axis=-1))

    def chord(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """y - x."""
        return np.asarray(np.subtract(y, x, dtype=float))

    def versine(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """1 - cos d = |x - y|^2 / 2."""
        return np.asarray(np.sum(self.chord(x, y) ** 2, axis=-1) / 2)

    def distance(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """d with tan(d/2) = |x - y| / |x + y|, accurate from 0 to the antipode (Kahan)."""
        apart, along = self.chord(x, y), np.asarray(x, dtype=float) + np.asarray(y, dtype=float)
        return np.asarray(2 * np.arctan2(np.linalg.norm(apart, axis=-1), np.linalg.norm(along, axis=-1)))

    def exp(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """cos|v| x + sin|v| v/|v|."""
        speed = self.norm(x, v)[..., None]
        return self.settle(np.cos(speed) * np.asarray(x) + np.sinc(speed / np.pi) * np.asarray(v))

    def log(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """d times the unit tangent at x towards y; towards the antipode the first vector of `frame(x)`."""
        base, target = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        near = self.versine(base, target)[..., None]
        far = self.versine(-base, target)[..., None]
        across = np.where(near <= far, target - base + near * base, target + base - far * base)
        length = np.linalg.norm(across, axis=-1, keepdims=True)
        lost = (length == 0) & (near > far)
        direction = np.where(lost, self.frame(base)[..., 0], across / np.where(length == 0, 1.0, length))
        return np.asarray(self.distance(base, target)[..., None] * direction)

    def turn(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """x cross v."""
        return np.asarray(np.cross(np.asarray(x, dtype=float), np.asarray(v, dtype=float)))

    def from_polar(self, radius: ArrayLike, angle: ArrayLike) -> Floats:
        """(cos r, sin r cos a, sin r sin a)."""
        r, a = np.broadcast_arrays(np.asarray(radius, dtype=float), np.asarray(angle, dtype=float))
        return np.stack([np.cos(r), np.sin(r) * np.cos(a), np.sin(r) * np.sin(a)], axis=-1)

    def point_defect(self, x: ArrayLike) -> Floats:
        """| |x|^2 - 1 |."""
        return np.asarray(np.abs(np.sum(np.asarray(x, dtype=float) ** 2, axis=-1) - 1))

    def isometry_defect(self, g: ArrayLike) -> Floats:
        """Largest entry of g^T g - 1."""
        matrix = np.asarray(g, dtype=float)
        return np.asarray(np.abs(np.swapaxes(matrix, -1, -2) @ matrix - np.eye(3)).max(axis=(-1, -2)))

    def nearest_isometry(self, g: ArrayLike) -> Floats:
        """The orthogonal polar factor."""
        left, _, right = np.linalg.svd(np.asarray(g, dtype=float))
        return np.asarray(left @ right)

    def inverse(self, g: ArrayLike) -> Floats:
        """The transpose."""
        return np.swapaxes(np.asarray(g, dtype=float), -1, -2)
