"""Gaussians on any orbifold, from its group alone: with cone points, mirrors and corners too."""

from __future__ import annotations

import numpy as np

from orbiframe.functions import OrbitSumBasis
from orbiframe.groups import ConwayGroup, SphericalGroup, orbifold_of, spread_over
from orbiframe_bases.centres import require_positive
from orbiframe_bases.gaussian import Gaussian


class InvariantGaussian(Gaussian):
    """Gaussians about `size` points spread evenly over the polygon of a group, summed over the group.

    The functions of `Gaussian` for a group with fixed points, where no mesh is at hand: an element that fixes a centre
    gives the same Gaussian once more, which the division by the sum of all makes up for. All are invariant, so their
    derivative across a mirror is zero, and at a cone point the whole gradient.

    group: from `orbifold_group`; size: how many functions; width: s^2 is the square of this times the area of X/H by
    the number of functions; reach: the support is the disc of area pi (reach s)^2, and never less than covers X/H.

    Raises UsageError for an option out of range.
    """

    def __init__(
        self, group: ConwayGroup | SphericalGroup, *, size: int = 50, width: float = 1.3, reach: float = 2.6
    ) -> None:
        require_positive("invariant-gaussian", size=size, width=width, reach=reach)
        sites, geometry = spread_over(group, size), group.geometry
        cover = min(1.5 * sites.covering, np.pi) if geometry.curvature > 0 else 1.5 * sites.covering
        least = float(geometry.versine(geometry.origin, geometry.from_polar(cover, 0.0)))
        support = max((reach * width) ** 2 / 2 * group.area / size, least)
        OrbitSumBasis.__init__(self, orbifold_of(group), sites.places, np.full(size, support))
        self.decay = reach**2
