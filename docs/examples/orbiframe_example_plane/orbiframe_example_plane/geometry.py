"""The Euclidean plane as complex numbers: (1, x, y) is z = x + i y, isometries are z -> a z + b and a conj z + b."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe import Geometry

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]


class ComplexPlane(Geometry):
    """The plane x0 = 1 of curvature 0."""

    name = "complex-plane"
    curvature = 0

    def project(self, x: ArrayLike) -> Floats:
        """x / x0."""
        vectors = np.asarray(x, dtype=float)
        return _point(_number(vectors) / vectors[..., 0])

    def settle(self, x: ArrayLike) -> Floats:
        """x with x0 = 1."""
        return _point(_number(x))

    def inner(self, x: ArrayLike, v: ArrayLike, w: ArrayLike) -> Floats:  # noqa: ARG002
        """The real part of v conj w."""
        return np.asarray((_number(v) * _number(w).conj()).real)

    def chord(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """y - x."""
        return _vector(_number(y) - _number(x))

    def versine(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """d^2 / 2."""
        return np.asarray(self.distance(x, y) ** 2 / 2)

    def distance(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """|y - x|."""
        return np.abs(_number(y) - _number(x))

    def exp(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """x + v."""
        return _point(_number(x) + _number(v))

    def log(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """y - x."""
        return self.chord(x, y)

    def turn(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """i v."""
        return _vector(1j * _number(v) + 0 * _number(x))

    def from_polar(self, radius: ArrayLike, angle: ArrayLike) -> Floats:
        """r e^(i a)."""
        return _point(np.asarray(radius, dtype=float) * np.exp(1j * np.asarray(angle, dtype=float)))

    def point_defect(self, x: ArrayLike) -> Floats:
        """|x0 - 1|."""
        return np.abs(np.asarray(x, dtype=float)[..., 0] - 1)

    def isometry_defect(self, g: ArrayLike) -> Floats:
        """What differs most from the isometry next to it."""
        return np.asarray(np.abs(np.asarray(g, dtype=float) - self.nearest_isometry(g)).max(axis=(-1, -2)))

    def nearest_isometry(self, g: ArrayLike) -> Floats:
        """With a of length 1, the same b, and the orientation of g."""
        matrix = np.asarray(g, dtype=float)
        first, second, b = (_number(matrix[..., k]) for k in (1, 2, 0))
        # A linear map is p z + q conj z; it keeps orientation where |p| > |q|.
        p, q = (first - 1j * second) / 2, (first + 1j * second) / 2
        keeps = np.abs(p) >= np.abs(q)
        a = np.where(keeps, p, q)
        return _isometry(a / np.abs(a), keeps, b)

    def inverse(self, g: ArrayLike) -> Floats:
        """z -> (z - b) / a, or conj((z - b) / a)."""
        matrix = np.asarray(g, dtype=float)
        a, b = _number(matrix[..., 1]), _number(matrix[..., 0])
        keeps = np.abs(_number(matrix[..., 2]) - 1j * a) < 1
        back = np.where(keeps, 1 / a, 1 / a.conj())
        return _isometry(back, keeps, -back * np.where(keeps, b, b.conj()))


def _number(x: ArrayLike) -> Complexes:
    rows = np.asarray(x, dtype=float)
    return np.asarray(rows[..., 1] + 1j * rows[..., 2])


def _vector(z: Complexes) -> Floats:
    return np.stack([np.zeros(z.shape), z.real, z.imag], axis=-1)


def _point(z: Complexes) -> Floats:
    return _vector(z) + np.array([1.0, 0.0, 0.0])


def _isometry(a: Complexes, keeps: NDArray[np.bool_], b: Complexes) -> Floats:
    """The matrix of z -> a z + b, or of z -> a conj z + b: its columns are the images of the origin, of 1 and of i."""
    return np.stack([_point(b), _vector(a), _vector(np.where(keeps, 1j * a, -1j * a))], axis=-1)
