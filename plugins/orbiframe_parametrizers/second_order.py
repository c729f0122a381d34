"""Second order: functions on many small sets of points with their gradients and Hessians, and rules to combine them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SecondOrder:
    """Values (F,) of a function with its gradients (F, n) and Hessians (F, n, n)."""

    value: Floats
    gradient: Floats
    hessian: Floats

    def __add__(self, other: SecondOrder) -> SecondOrder:
        """The sum."""
        return SecondOrder(self.value + other.value, self.gradient + other.gradient, self.hessian + other.hessian)

    def times(self, factor: Floats) -> SecondOrder:
        """The function times a constant for each set, (F,)."""
        return SecondOrder(factor * self.value, factor[:, None] * self.gradient, factor[:, None, None] * self.hessian)

    def through(self, value: Floats, first: Floats, second: Floats) -> SecondOrder:
        """f of this function, given f and its two derivatives at the values, (F,) each: the chain rule."""
        return SecondOrder(
            value,
            first[:, None] * self.gradient,
            first[:, None, None] * self.hessian + second[:, None, None] * _outer(self.gradient, self.gradient),
        )

    def __mul__(self, other: SecondOrder) -> SecondOrder:
        """The product."""
        mixed = _outer(self.gradient, other.gradient)
        return SecondOrder(
            self.value * other.value,
            self.value[:, None] * other.gradient + other.value[:, None] * self.gradient,
            self.value[:, None, None] * other.hessian
            + other.value[:, None, None] * self.hessian
            + mixed
            + np.swapaxes(mixed, 1, 2),
        )


def turning_angle(sine: SecondOrder, cosine: SecondOrder) -> SecondOrder:
    """atan2(sine, cosine) of two functions."""
    s, c = sine.value, cosine.value
    square = s**2 + c**2
    by_sine, by_cosine = c / square, -s / square
    twice, mixed = -2 * s * c / square**2, (s**2 - c**2) / square**2
    cross = _outer(sine.gradient, cosine.gradient)
    pure = _outer(sine.gradient, sine.gradient) - _outer(cosine.gradient, cosine.gradient)
    linear = sine.times(by_sine) + cosine.times(by_cosine)
    hessian = twice[:, None, None] * pure + mixed[:, None, None] * (cross + np.swapaxes(cross, 1, 2))
    return SecondOrder(np.arctan2(s, c), linear.gradient, linear.hessian + hessian)


def _outer(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[:, :, None] * b[:, None, :])
