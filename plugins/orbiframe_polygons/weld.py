"""Weld: points with equal coordinates become one vertex."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Points = NDArray[np.floating[Any]]

# From so many points on, compiled loops gain more time than the import of the compiler takes.
LARGE = 2**19


def welded(points: Points) -> tuple[Floats, Ints]:
    """The different points, (V, 3), in the order in which they first occur, and which of them each point is, (n,).

    points: finite, (n, 3). Points are equal if all coordinates are, to the last bit; only 0 and -0 are the same.
    """
    cleared = np.ascontiguousarray(points) + points.dtype.type(0)
    first, place = (_hashed if len(points) >= LARGE else _sorted)(cleared)
    return cleared[first].astype(np.float64), place


def _sorted(points: Points) -> tuple[Ints, Ints]:
    """Of each different point the first that is equal to it, and which of them each point is."""
    order = np.lexsort(points.T)
    ordered = points[order]
    fresh = np.ones(len(points), dtype=np.bool_)
    fresh[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    group = np.empty(len(points), dtype=np.intp)
    group[order] = np.cumsum(fresh) - 1
    # lexsort is stable, so the first of each group is the first that occurs.
    first = order[fresh]
    rank = np.empty(len(first), dtype=np.intp)
    rank[np.argsort(first)] = np.arange(len(first))
    return np.sort(first), rank[group]


def _hashed(points: Points) -> tuple[Ints, Ints]:
    from orbiframe_polygons.compiled_weld import number_points

    first, place = np.empty(len(points), dtype=np.intp), np.empty(len(points), dtype=np.intp)
    count = number_points(points.view(f"u{points.dtype.itemsize}"), first, place)
    return first[:count], place
