"""Gaussians on X/H: smooth bumps about centres that are spread evenly over the surface in space."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from orbiframe import Orbifold, Points, Triangulation
from orbiframe.compiled import compiled
from orbiframe.functions import OrbitSumBasis
from orbiframe_bases.centres import require_positive, require_share, spread, supports

Floats = NDArray[np.float64]


class Gaussian(OrbitSumBasis):
    """Gaussians about `size` vertices, farthest points of the mesh in space, summed over the group (paper, 3.1).

    The profile is exp(-2 c / s^2) times the bump exp(1 - 1/(1 - c / c_max)), where c is the versine (1 - cos d, d^2/2
    or cosh d - 1), hence C-infinity in all three geometries, and all functions add up to 1.

    size: how many functions; width: s^2 is the square of this times the area in X of the part of the surface that is
    nearest to the centre, smoothed over neighbouring parts, so that functions are narrow where the map squeezes the
    surface; reach: the support is the disc of area pi (reach s)^2, so c_max = (reach s)^2 / 2. Where that would leave
    a part of some triangle uncovered, the function is made wider; grading: how much of their density follows the girth
    of the surface, the rest is even.

    Raises UsageError for an option out of range, FitError if the mesh has fewer vertices than `size`.
    """

    smoothness = math.inf

    def __init__(
        self,
        orbifold: Orbifold,
        triangulation: Triangulation,
        *,
        size: int = 1000,
        width: float = 1.7,
        reach: float = 2.6,
        grading: float = 0.3,
    ) -> None:
        require_positive("gaussian", size=size, width=width, reach=reach)
        require_share("gaussian", grading=grading)
        spacing = spread(triangulation, size, grading)
        support = supports(triangulation, spacing, (reach * width) ** 2 / 2)
        centres = Points(triangulation.patch[spacing.chosen], triangulation.points[spacing.chosen])
        super().__init__(orbifold, centres, support)
        self.decay = reach**2

    def profile(self, t: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """exp(1 - decay t - 1/(1 - t)) with its first three derivatives, from its logarithmic derivatives."""
        f, df, ddf, third = self.profile_jet(t, 3)
        return f, df, ddf, third

    def profile_jet(self, t: Floats, order: int) -> tuple[Floats, ...]:
        """The same up to an order."""
        inside = t < 1
        inverse = 1 / (1 - np.where(inside, t, 0.0))
        found = np.empty((order + 1, len(t)))
        found[0] = np.where(inside, np.exp(1 - self.decay * t * inside - inverse), 0.0)
        if order:
            _derive(self.decay, inverse, found)
        return tuple(found)


@compiled(arrays=False)
def _derive(decay, inverse, found):  # type: ignore[no-untyped-def]
    """Fill in the derivatives, (order, n), below f, by 1/(1 - t)."""
    for k in range(len(inverse)):
        f, square = found[0, k], inverse[k] * inverse[k]
        slope = -decay - square
        found[1, k] = f * slope
        if len(found) < 3:
            continue
        bend = -2 * square * inverse[k]
        found[2, k] = f * (slope * slope + bend)
        if len(found) < 4:
            continue
        found[3, k] = f * (slope * (slope * slope + 3 * bend) - 6 * square * square)
