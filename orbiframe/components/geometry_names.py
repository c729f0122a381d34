"""The names of the three geometries, by the sign of the curvature."""

from __future__ import annotations

_NAMES = {1: "s2", 0: "e2", -1: "h2"}


def geometry_name(characteristic: float) -> str:
    """The geometry of the closed surfaces with an Euler characteristic of this sign, by Gauss and Bonnet."""
    return _NAMES[(characteristic > 0) - (characteristic < 0)]
