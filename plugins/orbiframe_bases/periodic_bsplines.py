"""Periodic B-splines in one variable: knots, values and derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class PeriodicBSplines:
    """The B-splines of one degree over knots that repeat with a period: as many functions as knots.

    Function j has the knots j, ..., j + degree + 1. knots: (n,), rising, in [0, period); none more than `degree` times.
    """

    knots: Floats
    degree: int
    period: float

    @property
    def size(self) -> int:
        """Number of functions, on the circle."""
        return len(self.knots)

    @property
    def smoothness(self) -> int:
        """Number of continuous derivatives: the degree less the largest multiplicity of a knot."""
        return self.degree - int(np.unique(self.knots, return_counts=True)[1].max())

    @property
    def reflection(self) -> Ints:
        """The function that each becomes under x -> -x, (n,), for knots that this maps to themselves.

        Knot j goes to knot m - j with m + 1 the multiplicity of 0, so function j to m - degree - 1 - j.
        """
        middle = int((self.knots == 0).sum()) - 1
        return np.asarray((middle - self.degree - 1 - np.arange(self.size)) % self.size)

    @cached_property
    def _line(self) -> Floats:
        """The knots -degree, ..., n + degree on the line."""
        place = np.arange(-self.degree, self.size + self.degree + 1)
        return np.asarray(self.knots[place % self.size] + self.period * (place // self.size))

    def values(self, x: Floats, order: int) -> tuple[Ints, Floats]:
        """The functions that matter at each x, (n, degree + 1), and their derivatives, (order + 1, n, degree + 1)."""
        p, t = self.degree, self._line
        x = np.mod(x - self.knots[0], self.period) + self.knots[0]
        # Half-open pieces: t[span] <= x < t[span + 1].
        span = np.clip(np.searchsorted(t, x, side="right") - 1, p, p + self.size - 1)
        lower = [np.ones((1, len(x)))]
        for k in range(1, p + 1):
            lower.append(_raised(t, span, k, lower[-1], x))
        none = np.zeros((p + 1, len(x)))
        out = [_differentiated(t, span, p, p - k, lower[p - k]) if k <= p else none for k in range(order + 1)]
        column = (span[:, None] - 2 * p + np.arange(p + 1)) % self.size
        return column, np.stack(out).swapaxes(1, 2)


def _raised(t: Floats, span: Ints, k: int, lower: Floats, x: Floats) -> Floats:
    """The k + 1 B-splines of degree k at x from those of degree k - 1 (Cox, de Boor)."""
    out = np.zeros((k + 1, len(x)))
    for i in range(k):
        left, right = t[span - k + 1 + i], t[span + 1 + i]
        share = lower[i] / (right - left)
        out[i] += (right - x) * share
        out[i + 1] += (x - left) * share
    return out


def _differentiated(t: Floats, span: Ints, degree: int, low: int, values: Floats) -> Floats:
    """Derivatives of order degree - low of the B-splines from the values of those of degree `low`."""
    for k in range(low + 1, degree + 1):
        out = np.zeros((k + 1, values.shape[1]))
        for i in range(k):
            share = k * values[i] / (t[span + 1 + i] - t[span - k + 1 + i])
            out[i] -= share
            out[i + 1] += share
        values = out
    return values
