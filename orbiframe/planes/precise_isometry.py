"""Precise isometries: pairs of complex numbers, exact to eps e^d where 3 x 3 matrices lose eps e^(2d)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Complexes = NDArray[np.clongdouble]

_HALF_TURN = np.diag([-1.0, 1.0, -1.0])


@dataclass(frozen=True, eq=False)
class PreciseIsometry:
    """Isometries of the plane of curvature K in its conformal model: z -> (a w + b) / (conj a - K conj b w).

    w is z, or conj z where the isometry reverses orientation; |a|^2 + K |b|^2 = 1, and (-a, -b) is the same isometry.
    In H^2 these are the matrices of SU(1, 1), in S^2 those of SU(2), in E^2 z is half of x1 + i x2. a, b, reverses:
    (...), in long double, which has three more digits where the machine has it.
    """

    curvature: int
    a: Complexes
    b: Complexes
    reverses: Bools

    @classmethod
    def translation(cls, curvature: int, x: ArrayLike) -> PreciseIsometry:
        """The translations along geodesics that take the origin to points x (..., 3) of X, with x0 > -1 in S^2."""
        points = np.asarray(x, dtype=np.longdouble)
        plane = points[..., 1] + 1j * points[..., 2]
        if curvature < 0:
            # x0 from (x1, x2), so that the result is an isometry to the last digit.
            a = np.sqrt((1 + np.sqrt(1 + points[..., 1] ** 2 + points[..., 2] ** 2)) / 2)
        else:
            a = np.sqrt((1 + points[..., 0]) / 2)
        return cls(curvature, a.astype(np.clongdouble), plane / (2 * a), np.zeros(a.shape, dtype=np.bool_))

    @classmethod
    def rotation(cls, curvature: int, angle: ArrayLike, reverses: ArrayLike = False) -> PreciseIsometry:
        """Rotations about the origin, after the reflection in the x1-axis where `reverses` says so; both (...)."""
        turn, mirror = np.broadcast_arrays(np.asarray(angle, dtype=np.longdouble), np.asarray(reverses, dtype=np.bool_))
        return cls(curvature, np.exp(0.5j * turn), np.zeros(turn.shape, dtype=np.clongdouble), mirror)

    @classmethod
    def of_matrix(cls, curvature: int, g: ArrayLike) -> PreciseIsometry:
        """Isometries given as matrices (..., 3, 3)."""
        matrix = np.asarray(g, dtype=np.longdouble)
        if curvature > 0 and (far := matrix[..., 0, 0] < 0).any():
            # Half a turn about (0, 1, 0), 1 / z in the conformal model, brings the origin to the near half of S^2.
            near = cls.of_matrix(1, np.where(far[..., None, None], _HALF_TURN @ matrix, matrix))
            turned = cls(1, np.where(far, 0, 1).astype(np.clongdouble), np.where(far, 1j, 0), np.zeros_like(far))
            return turned @ near
        move = cls.translation(curvature, matrix[..., :, 0])
        # What is left, a rotation or reflection about the origin, shows where the x1-axis and the x2-axis go.
        rest = move.inverse.matrix.astype(np.longdouble) @ matrix
        reverses = rest[..., 1, 1] * rest[..., 2, 2] < rest[..., 1, 2] * rest[..., 2, 1]
        return move @ cls.rotation(curvature, np.arctan2(rest[..., 2, 1], rest[..., 1, 1]), reverses)

    @classmethod
    def joined(cls, parts: Sequence[PreciseIsometry]) -> PreciseIsometry:
        """Isometries of one plane in one array, (n,), one part (m,) after the other."""
        a, b, reverses = (np.concatenate([getattr(part, name) for part in parts]) for name in ("a", "b", "reverses"))
        return cls(parts[0].curvature, a, b, reverses)

    def __matmul__(self, other: PreciseIsometry) -> PreciseIsometry:
        """The other isometry first, then this one; leading axes broadcast."""
        a = np.where(self.reverses, other.a.conj(), other.a)
        b = np.where(self.reverses, other.b.conj(), other.b)
        product = self.a * a - self.curvature * self.b * b.conj(), self.a * b + self.b * a.conj()
        return PreciseIsometry(self.curvature, *product, self.reverses ^ other.reverses)

    def __getitem__(self, index: int | slice | NDArray[np.intp] | NDArray[np.bool_]) -> PreciseIsometry:
        """Some of the isometries."""
        return PreciseIsometry(self.curvature, self.a[index], self.b[index], self.reverses[index])

    @property
    def inverse(self) -> PreciseIsometry:
        """The inverse isometries."""
        a = np.where(self.reverses, self.a, self.a.conj())
        return PreciseIsometry(self.curvature, a, -np.where(self.reverses, self.b.conj(), self.b), self.reverses)

    @property
    def direction(self) -> NDArray[np.longdouble]:
        """The angle (...) at the origin of the geodesic from there to its image; 0 where it stays."""
        return np.asarray(np.angle(self.a * self.b))

    @property
    def place(self) -> Floats:
        """The image of the origin, (..., 3)."""
        turned = 2 * self.a * self.b
        height = np.abs(self.a) ** 2 - self.curvature * np.abs(self.b) ** 2
        return np.stack([height, turned.real, turned.imag], axis=-1).astype(np.float64)

    @property
    def matrix(self) -> Floats:
        """The same isometries as matrices (..., 3, 3)."""
        a, b, k = self.a, self.b, self.curvature
        flip = np.where(self.reverses, -1, 1)
        mixed, turned, bent = a * b.conj(), a**2, k * b**2
        x, y = turned - bent, 1j * (turned + bent) * flip
        rows = [
            [np.abs(a) ** 2 - k * np.abs(b) ** 2, -2 * k * mixed.real, 2 * k * mixed.imag * flip],
            [2 * (a * b).real, x.real, y.real],
            [2 * (a * b).imag, x.imag, y.imag],
        ]
        return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2).astype(np.float64)
