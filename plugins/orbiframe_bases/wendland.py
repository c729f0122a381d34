"""Wendland's functions on X/H: polynomials of compact support, as smooth as wanted."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import Orbifold, Points, Triangulation, UsageError
from orbiframe.functions import OrbitSumBasis
from orbiframe_bases.centres import require_positive, require_share, spread, supports

Floats = NDArray[np.float64]


class Wendland(OrbitSumBasis):
    """Wendland's functions about `size` vertices, farthest points of the mesh in space, summed over the group.

    The profile is a polynomial in r = sqrt(c / c_max), where c is the versine (1 - cos d, d^2/2 or cosh d - 1):
    (1 - r)^4 (4 r + 1), (1 - r)^6 (35 r^2 + 18 r + 3) / 3 or (1 - r)^8 (32 r^3 + 25 r^2 + 8 r + 1), with two, four and
    six continuous derivatives in all three geometries (Wendland, 1995). All functions add up to 1.

    size: how many functions; derivatives: 2, 4 or 6; reach: the support is the disc of area pi reach^2 times the area
    in X of the part of the surface that is nearest to the centre, smoothed over neighbouring parts. Where that would
    leave a part of some triangle uncovered, the function is made wider; grading: how much of their density follows the
    girth of the surface, the rest is even.

    Raises UsageError for an option out of range, FitError if the mesh has fewer vertices than `size`.
    """

    def __init__(
        self,
        orbifold: Orbifold,
        triangulation: Triangulation,
        *,
        size: int = 1000,
        derivatives: int = 2,
        reach: float = 3.0,
        grading: float = 0.3,
    ) -> None:
        require_positive("wendland", size=size, reach=reach)
        require_share("wendland", grading=grading)
        if derivatives not in _PROFILES:
            raise UsageError(f"option derivatives of the basis wendland is {derivatives}; it must be 2, 4 or 6")
        spacing = spread(triangulation, size, grading)
        centres = Points(triangulation.patch[spacing.chosen], triangulation.points[spacing.chosen])
        super().__init__(orbifold, centres, supports(triangulation, spacing, reach**2 / 2))
        self.smoothness = derivatives

    def profile(self, t: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """f with its first three derivatives by t = r^2.

        f'' and f''' grow like 1/r and 1/r^3 at most at the centre, where the gradient of t, of size r, multiplies them
        twice and thrice; at the centre itself they are returned as 0.
        """
        r = np.sqrt(np.minimum(t, 1.0))
        inverse = np.divide(1.0, r, out=np.zeros_like(r), where=r > 0)
        return _PROFILES[int(self.smoothness)](r, 1 - r, inverse)


def _second(r: Floats, rest: Floats, inverse: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    third = -7.5 * rest * (1 + r) * inverse**3
    return rest**4 * (4 * r + 1), -10 * rest**3, 15 * rest**2 * inverse, third


def _fourth(r: Floats, rest: Floats, inverse: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    f = rest**6 * (35 * r**2 + 18 * r + 3) / 3
    return f, -28 / 3 * rest**5 * (5 * r + 1), 140 * rest**4, -280 * rest**3 * inverse


def _sixth(r: Floats, rest: Floats, inverse: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    del inverse
    f = rest**8 * (32 * r**3 + 25 * r**2 + 8 * r + 1)
    return f, -11 * rest**7 * (16 * r**2 + 7 * r + 1), 132 * rest**6 * (6 * r + 1), -2772 * rest**5


_PROFILES = {2: _second, 4: _fourth, 6: _sixth}
