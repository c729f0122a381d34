"""Weld: points with equal coordinates become one vertex."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def welded(points: NDArray[np.floating[Any]]) -> tuple[Floats, Ints]:
    """The different points, (V, 3), in the order in which they first occur, and which of them each point is, (n,).

    Points are equal if all coordinates are, to the last bit; only 0 and -0 are the same.
    """
    cleared = points + points.dtype.type(0)
    order = np.lexsort(cleared.T)
    ordered = cleared[order]
    fresh = np.ones(len(points), dtype=np.bool_)
    fresh[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    group = np.empty(len(points), dtype=np.intp)
    group[order] = np.cumsum(fresh) - 1
    # lexsort is stable, so the first of each group is the first that occurs.
    first = order[fresh]
    rank = np.empty(len(first), dtype=np.intp)
    rank[np.argsort(first)] = np.arange(len(first))
    return cleared[np.sort(first)].astype(np.float64), rank[group]
