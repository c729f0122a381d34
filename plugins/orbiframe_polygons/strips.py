"""Strips: triangles that share two corners each with the one before."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.intp]

RESTART = -1


def triangles_of_strips(order: Ints) -> Ints:
    """The triangles of strips that stand one after the other, (n, 3), every second one of a strip turned.

    order: the corners, with RESTART before each strip but the first. Triangles that name a corner twice are left out:
    they only turn a strip.
    """
    if len(order) < 3:
        return np.empty((0, 3), dtype=np.intp)
    index = np.arange(len(order))
    start = np.maximum.accumulate(np.where(order == RESTART, index + 1, 0))
    k = index[:-2]
    odd = (k - start[:-2]) % 2
    made: Ints = order[np.stack([k, k + 1 + odd, k + 2 - odd], axis=1)]
    whole = (made != RESTART).all(axis=1) & (made != np.roll(made, 1, axis=1)).all(axis=1)
    return np.asarray(made[whole])
