"""Sites on X/H from its group alone, without a triangulation: for orbifolds with cone points and mirrors too."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import GeometryError
from orbiframe.groups.group import Group
from orbiframe.orbifolds.atlas import Points

Floats = NDArray[np.float64]

_SAMPLES = 30  # random points per site, of which sites are chosen


@dataclass(frozen=True, eq=False)
class SpreadPoints:
    """Points spread evenly over X/H.

    points: (count, 3), in the fundamental polygon; covering: how far X/H goes from them, about.
    """

    points: Floats
    covering: float

    @property
    def places(self) -> Points:
        """The sites as points of the one patch."""
        return Points(np.zeros(len(self.points), dtype=np.intp), self.points)


def spread_over(group: Group, count: int, seed: int = 0) -> SpreadPoints:
    """`count` points of the polygon of a group, each the farthest on X/H from those before it among random points.

    Distances are the least over the images of a site, so that sites keep apart from their own images as well: those of
    a site near a mirror or a cone point are near to it. Raises GeometryError for a count that is not positive.
    """
    if count < 1:
        raise GeometryError(f"{count} sites are wanted; ask for at least one")
    samples = _random_points(group, max(_SAMPLES * count, 300), seed)
    tiles = group.tiles(_far(group))
    chosen, gap = [0], np.full(len(samples), np.inf)
    while True:
        images = group.geometry.settle(group.geometry.act(tiles, samples[chosen[-1]]))
        gap = np.minimum(gap, group.geometry.distance(samples[:, None], images).min(axis=1))
        if len(chosen) == count:
            return SpreadPoints(samples[chosen], float(gap.max()))
        chosen.append(int(gap.argmax()))


def _random_points(group: Group, count: int, seed: int) -> Floats:
    """Points of the polygon: uniform in area over the disc about it, and moved into it."""
    rng, k = np.random.default_rng(seed), group.geometry.curvature
    radius = float(group.atlas().radius[0])
    half = (np.sin, np.asarray, np.sinh)[1 - k](radius / 2) * np.sqrt(rng.random(count))
    far = 2 * np.asarray((np.arcsin, np.asarray, np.arcsinh)[1 - k](half))
    return group.reduce(group.geometry.from_polar(far, rng.uniform(-np.pi, np.pi, count)))[0]


def _far(group: Group) -> float:
    """A disc that meets every tile with the image of a site nearest to a point of the polygon."""
    reach = 2 * float(group.atlas().radius[0])
    return float(min(np.pi, reach)) if group.geometry.curvature > 0 else reach
