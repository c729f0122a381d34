"""Lifted edges: where in X one end of a short edge lies as the other sees it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import Orbifold, Points

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_GROWTH = 1.5
_ROUNDING = 1e-9


def lifted(orbifold: Orbifold, points: Points, tail: Ints, head: Ints) -> Floats:
    """The lift of point head[i] that is nearest to point tail[i], in the frame of the patch of the latter, (n, 3).

    For edges shorter than half of the shortest closed geodesic that is where they end. Copies of patches are looked for
    within a radius that grows until it holds all that could be nearer.
    """
    geometry = orbifold.geometry
    start, end = (Points(points.patch[ends], points.x[ends]) for ends in (tail, head))
    far = geometry.distance(geometry.origin, start.x) + geometry.distance(geometry.origin, end.x)
    place, reach = np.empty((len(tail), 3)), float(orbifold.atlas.radius.max())
    left = np.arange(len(tail))
    while len(left):
        here, there = (Points(p.patch[left], p.x[left]) for p in (start, end))
        found, distance = _nearest(orbifold, here, there, reach)
        place[left] = found
        left = left[distance + far[left] > reach * (1 + _ROUNDING)]
        reach *= _GROWTH
    return place


def _nearest(orbifold: Orbifold, start: Points, end: Points, reach: float) -> tuple[Floats, Floats]:
    """The nearest lifts of ends by copies of patches within reach, (n, 3), and their distances; inf for none."""
    count = orbifold.atlas.patch_count
    patches, base = np.unique(start.patch, return_inverse=True)
    near = orbifold.copies(patches, np.full(len(patches), reach))
    # Every edge with every copy of the patch of its end that the patch of its start sees.
    wanted, there = base * count + end.patch, near.base * count + near.patch
    order = np.argsort(there, kind="stable")
    first, last = (np.searchsorted(there[order], wanted, side) for side in ("left", "right"))
    number = last - first
    edge = np.repeat(np.arange(len(base)), number)
    copy = order[np.repeat(first - np.cumsum(number) + number, number) + np.arange(len(edge))]
    place = orbifold.geometry.act(near.isometry[copy], end.x[edge])
    away = orbifold.geometry.distance(start.x[edge], place)
    nearest = np.lexsort((away, edge))
    nearest = nearest[np.unique(edge[nearest], return_index=True)[1]]
    found, distance = np.array(start.x), np.full(len(base), np.inf)
    found[edge[nearest]], distance[edge[nearest]] = place[nearest], away[nearest]
    return found, distance
