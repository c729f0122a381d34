"""Triangle boxes: triangles sorted so that near ones are neighbours, in boxes that lie in boxes up to one.

Each box is turned along its triangles (Gottschalk, Lin and Manocha, OBBTree, 1996), so that triangles of any size, and
fans of thousands of needles, do no harm.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

LEAF = 4  # triangles in each of the smallest boxes


class TriangleBoxes(NamedTuple):
    """The triangles in an order of their own, (F,), and the boxes (2m - 1) about them.

    Box k holds the boxes 2k + 1 and 2k + 2; the last m boxes, a power of two, hold `LEAF` triangles each, in that
    order. axes: (2m - 1, 3, 3), rows; low, high: (2m - 1, 3), the least and greatest coordinates along them.
    """

    order: Ints
    axes: Floats
    low: Floats
    high: Floats

    @classmethod
    def of(cls, corners: Floats) -> TriangleBoxes:
        """The boxes of triangles given by their corners, (F, 3, 3)."""
        order = cKDTree(corners.mean(axis=1), leafsize=LEAF).indices
        leaves = 1 << max(-(-len(corners) // LEAF) - 1, 0).bit_length()
        points = corners[filled(order, leaves)]
        levels = [_turned(points.reshape(2**k, -1, 3)) for k in range(leaves.bit_length())]
        return cls(order, *(np.concatenate(parts) for parts in zip(*levels, strict=True)))

    def common_vertices(self, triangles: Ints) -> Ints:
        """For every box the vertices, (2m - 1, 3), that are corners of all its triangles (F, 3); -1 where fewer are."""
        leaves = (len(self.low) + 1) // 2
        inner = triangles[filled(self.order, leaves)]
        levels: list[Ints] = []
        while len(inner) > 1:
            one, other = inner[0::2], inner[1::2]
            inner = np.where((one[:, :, None] == other[:, None, :]).any(axis=2), one, -1)
            levels.insert(0, inner)
        return np.concatenate(levels)[: len(self.low)]


def filled(order: Ints, leaves: int) -> Ints:
    """The order with its last one repeated until all leaves are full."""
    return np.concatenate([order, np.full(leaves * LEAF - len(order), order[-1])])


def _turned(points: Floats) -> tuple[Floats, Floats, Floats]:
    """Axes along which the points of each box, (m, k, 3), spread most and least, and their range along these."""
    away = points - points.mean(axis=1, keepdims=True)
    axes = np.linalg.eigh(np.swapaxes(away, 1, 2) @ away)[1]
    along = points @ axes
    return np.ascontiguousarray(np.swapaxes(axes, 1, 2)), along.min(axis=1), along.max(axis=1)
