"""Rim sides: sides of quadrilaterals that run along the boundary of a surface instead of geodesics of X."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator

from orbiframe import Geometry
from orbiframe.surfaces import OpenTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


class RimSide(NamedTuple):
    """What a side has beyond the straight one between its corners: a curve that is 0 at both ends, by s or t."""

    quad: int
    side: int
    excess: Akima1DInterpolator

    def added(self, s: Floats, t: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """What it adds to p, p_s, p_t and p_st of its quadrilateral: less and less to the opposite side."""
        across_t = self.side % 2 == 0
        w, other = (s, t) if across_t else (t, s)
        near, slope = (1 - other, -1.0) if self.side in (0, 3) else (other, 1.0)
        e, along = self.excess(w), self.excess(w, 1)
        first, second = near[:, None] * along, slope * e
        return near[:, None] * e, *((first, second) if across_t else (second, first)), slope * along


def rim_side(
    geometry: Geometry,
    found: OpenTriangulation,
    piece: int,
    place: tuple[int, int],
    ends: tuple[Floats, Floats],
    back: bool,
) -> RimSide:
    """The side of a quadrilateral along a piece of the boundary, at a place (quadrilateral, side).

    ends: its corners in the frame of the quadrilateral, on the rays of points of X, as long as they are weighted; the
    surface is on the left from the first to the second; back: the piece runs from the second to the first.
    """
    share, x, left = found.pieces.unrolled(piece)
    if back:
        share, x, left = 1 - share[::-1], x[::-1], not left
    (a, b), (one, other) = (geometry.project(np.stack(ends)), (float(np.linalg.norm(v)) for v in ends))
    one, other = one / float(np.linalg.norm(a)), other / float(np.linalg.norm(b))
    here, there = geometry.flag(x[0], geometry.log(x[0], x[-1])), geometry.flag(a, geometry.log(a, b))
    turned = np.diag([1.0, 1.0, 1.0 if left else -1.0])
    moved = geometry.act(there @ turned @ geometry.inverse(here), x)
    straight = (1 - share)[:, None] * ends[0] + share[:, None] * ends[1]
    excess = ((1 - share) * one + share * other)[:, None] * moved - straight
    excess[[0, -1]] = 0.0
    if place[1] >= 2:
        share, excess = 1 - share[::-1], excess[::-1]
    return RimSide(*place, Akima1DInterpolator(share, excess, method="makima"))
