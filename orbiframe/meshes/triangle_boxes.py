"""Triangle boxes: triangles sorted so that near ones are neighbours, in boxes that lie in boxes up to one.

Each box is turned along its triangles (Gottschalk, Lin and Manocha, OBBTree, 1996), so that triangles of any size, and
fans of thousands of needles, do no harm.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from orbiframe.compiled.decorator import compiled
from orbiframe.compiled.matrices import set_identity

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

LEAF = 4  # triangles in each of the smallest boxes
# Axes are turned at most so often, and not for an entry aside that is so small a share of those on the diagonal.
_ROTATIONS, _NOTHING = 24, 1e-9


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
    axes, low, high = np.empty((len(points), 3, 3)), np.empty((len(points), 3)), np.empty((len(points), 3))
    _turn(points, axes, low, high)
    return axes, low, high


@compiled(arrays=False)
def _turn(points, axes, low, high):  # type: ignore[no-untyped-def]
    """Fill in the axes of each box, as rows, and the range of its points along them."""
    count = points.shape[1]
    for box in range(len(points)):
        x, y, z = 0.0, 0.0, 0.0
        for k in range(count):
            x, y, z = x + points[box, k, 0], y + points[box, k, 1], z + points[box, k, 2]
        x, y, z = x / count, y / count, z / count
        xx, yy, zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(count):
            a, b, c = points[box, k, 0] - x, points[box, k, 1] - y, points[box, k, 2] - z
            xx, yy, zz, xy, xz, yz = xx + a * a, yy + b * b, zz + c * c, xy + a * b, xz + a * c, yz + b * c
        frame = axes[box]
        _principal_axes(xx, yy, zz, xy, xz, yz, frame)
        for row in range(3):
            a, b, c = frame[row, 0], frame[row, 1], frame[row, 2]
            least, greatest = np.inf, -np.inf
            for k in range(count):
                along = a * points[box, k, 0] + b * points[box, k, 1] + c * points[box, k, 2]
                least, greatest = min(least, along), max(greatest, along)
            low[box, row], high[box, row] = least, greatest


@compiled(arrays=False)
def _principal_axes(xx, yy, zz, xy, xz, yz, frame):  # type: ignore[no-untyped-def]
    """The eigenvectors of a symmetric matrix as rows, by rotations that make its largest entry aside vanish (Jacobi).

    Any orthonormal rows do for a box; so many rotations that nothing worth a rotation is left.
    """
    set_identity(frame)
    for _ in range(_ROTATIONS):
        if abs(xy) >= abs(xz) and abs(xy) >= abs(yz):
            if abs(xy) <= _NOTHING * abs(xx + yy):
                return
            c, s, t = _rotation(xx, yy, xy)
            xx, yy, xy, xz, yz = xx - t * xy, yy + t * xy, 0.0, c * xz - s * yz, s * xz + c * yz
            _rotate(frame, 0, 1, c, s)
        elif abs(xz) >= abs(yz):
            if abs(xz) <= _NOTHING * abs(xx + zz):
                return
            c, s, t = _rotation(xx, zz, xz)
            xx, zz, xz, xy, yz = xx - t * xz, zz + t * xz, 0.0, c * xy - s * yz, s * xy + c * yz
            _rotate(frame, 0, 2, c, s)
        else:
            if abs(yz) <= _NOTHING * abs(yy + zz):
                return
            c, s, t = _rotation(yy, zz, yz)
            yy, zz, yz, xy, xz = yy - t * yz, zz + t * yz, 0.0, c * xy - s * xz, s * xy + c * xz
            _rotate(frame, 1, 2, c, s)


@compiled(inline=True)
def _rotation(first, second, aside):  # type: ignore[no-untyped-def]
    """Cosine, sine and tangent of the smaller turn that makes the entry aside vanish."""
    half = (second - first) / (2 * aside)
    t = (1.0 if half >= 0 else -1.0) / (abs(half) + math.sqrt(half * half + 1))
    c = 1 / math.sqrt(t * t + 1)
    return c, t * c, t


@compiled(arrays=False)
def _rotate(frame, i, j, c, s):  # type: ignore[no-untyped-def]
    for k in range(3):
        a, b = frame[i, k], frame[j, k]
        frame[i, k], frame[j, k] = c * a - s * b, s * a + c * b
