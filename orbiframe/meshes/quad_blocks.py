"""Quad blocks: the coarser quads of which a quad mesh is a subdivision, 2 x 2 of its own each, and again."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import shortest_path

Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Blocks come in steps of a factor of four; so far from what is wanted they may be, as a factor.
_NEAR = 1.6


def blocks_near(quads: Ints, wanted: int) -> Ints | None:
    """The corners (B, 4), in cyclic order, of blocks of the quads (F, 4) of a closed mesh, about as many as wanted.

    The quads themselves are the finest blocks. Four quads about a vertex are one block of the next level, if all are:
    that is a step of the subdivision of Catmull and Clark taken back (Taubin, Detecting and reconstructing subdivision
    connectivity, 2002). None where there are only far more blocks than wanted, or far fewer.
    """
    found: Ints | None = quads
    levels: list[Ints] = []
    while found is not None:
        levels.append(found)
        found = coarser(found)
    away = [abs(np.log(len(level) / wanted)) for level in levels]
    best = int(np.argmin(away))
    return levels[best] if away[best] <= np.log(_NEAR) else None


def coarser(quads: Ints) -> Ints | None:
    """The quads (B, 4) each of which is four of the given ones (4 B, 4); None if they are no such subdivision.

    From corner to corner of the coarse quads it is two diagonals, across a vertex in the middle; all vertices but the
    corners have four quads. Where there is a choice, as on a grid, the corners are those with the first vertex.
    """
    valence = np.bincount(quads.ravel())
    for corner in _choices(quads):
        if (corner[quads].sum(axis=1) == 1).all() and np.isin(valence[~corner], (0, 4)).all():
            found = _joined(quads, corner)
            if found is not None:
                return found
    return None


def _choices(quads: Ints) -> Iterator[Bools]:
    """Every other vertex along diagonals, from each of the first four corners."""
    count = int(quads.max()) + 1
    ends = np.concatenate([quads[:, [0, 2]], quads[:, [1, 3]]]).T
    graph = coo_array((np.ones(ends.shape[1]), ends), shape=(count, count)).tocsr()
    for first in np.sort(quads[0]):
        steps = shortest_path(graph, directed=False, unweighted=True, indices=first)
        yield np.where(np.isfinite(steps), steps, 1) % 2 == 0


def _joined(quads: Ints, corner: Bools) -> Ints | None:
    """The corners of four quads each about the vertices across from the corners, in cyclic order."""
    first = corner[quads].argmax(axis=1)
    v, e, f, d = (quads[np.arange(len(quads)), (first + k) % 4] for k in range(4))
    middle, size = np.unique(f, return_counts=True)
    if (size != 4).any():
        return None
    order = np.argsort(f, kind="stable").reshape(len(middle), 4)
    rows, left = np.arange(len(middle)), np.ones(order.shape, dtype=np.bool_)
    one, other = e[order], d[order]
    found, place, side = [], np.zeros(len(middle), dtype=np.intp), other[:, 0]
    for step in range(4):
        if step:
            there = left & ((one == side[:, None]) | (other == side[:, None]))
            if not there.any(axis=1).all():
                return None
            place = there.argmax(axis=1)
            side = one[rows, place] + other[rows, place] - side
        left[rows, place] = False
        found.append(v[order[rows, place]])
    return np.stack(found, axis=1)
