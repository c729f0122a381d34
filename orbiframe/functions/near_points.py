"""Near points: points of X/H in the frame of a patch that is near them, so that numbers live near the origin."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.orbifolds.atlas import Points
from orbiframe.orbifolds.orbifold import Orbifold

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# A step to another patch counts if it brings a point nearer by this.
_STEP = 1e-9


class NearPoints(NamedTuple):
    """Points of X/H seen from near patches, and how their frames turn: (n, 2, 2), or None where no point has moved.

    A derivative along `geometry.frame` of the given point is that along the frame of the near point, times turn.
    """

    points: Points
    turn: Floats | None


def near_points(orbifold: Orbifold, points: Points) -> NearPoints:
    """Points beyond the disc of their patch moved from patch to patch, as long as each step brings them nearer.

    What lies within its disc stays as it is, and so does what no step brings nearer.
    """
    geometry, atlas = orbifold.geometry, orbifold.atlas
    patch, x = np.array(points.patch, dtype=np.intp), np.array(points.x, dtype=np.float64)
    far = np.flatnonzero(geometry.distance(geometry.origin, x) > atlas.radius[patch] * (1 + _STEP))
    if not len(far):
        return NearPoints(points, None)
    turn = np.tile(np.eye(2), (len(x), 1, 1))
    while len(far):
        owner, way = _ways(atlas.head, patch[far])
        there = geometry.settle(geometry.act(atlas.isometry[way], x[far][owner]))
        distance = geometry.distance(geometry.origin, there)
        best = _least(owner, distance, len(far))
        nearer = distance[best] < geometry.distance(geometry.origin, x[far]) - _STEP
        far, best = far[nearer], best[nearer]
        turn[far] = _turned(orbifold, x[far], there[best], way[best]) @ turn[far]
        patch[far], x[far] = atlas.tail[way[best]], there[best]
        far = far[distance[best] > atlas.radius[patch[far]] * (1 + _STEP)]
    return NearPoints(Points(patch, x), turn)


def _ways(head: Ints, patch: Ints) -> tuple[Ints, Ints]:
    """The transitions out of some patches: whose it is, and its number; staying, transition 0, is one of each."""
    order = 1 + np.argsort(head[1:], kind="stable")
    begin, end = (np.searchsorted(head[order], patch, side=side) for side in ("left", "right"))
    count = end - begin + 1
    owner = np.repeat(np.arange(len(patch)), count)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    way = np.concatenate([order, [0]])[np.minimum(begin[owner] + place - 1, len(order))]
    return owner, np.where(place == 0, 0, way)


def _least(owner: Ints, value: Floats, count: int) -> Ints:
    """Where the least value of each owner stands."""
    order = np.lexsort((value, owner))
    return np.asarray(order[np.searchsorted(owner[order], np.arange(count))])


def _turned(orbifold: Orbifold, x: Floats, y: Floats, way: Ints) -> Floats:
    """The frames of points x, moved, in those of the points y where they come to lie, (n, 2, 2)."""
    geometry = orbifold.geometry
    moved = orbifold.atlas.isometry[way] @ geometry.frame(x)
    own = geometry.frame(y)
    rows = [[geometry.inner(y, own[:, :, i], moved[:, :, j]) for j in (0, 1)] for i in (0, 1)]
    return np.asarray(np.moveaxis(np.array(rows), 2, 0))
