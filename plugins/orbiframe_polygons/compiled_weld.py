"""Equal points found by hashing, in a compiled loop; `weld.py` does the same for few points by sorting."""

from __future__ import annotations

import numpy as np
from numba import njit, uint64

START = 2**12


@njit(inline="always")
def _slot(bits, point, mask):  # type: ignore[no-untyped-def]
    """Where the search for a point starts."""
    code = uint64(0)
    for k in range(3):
        code = (code ^ uint64(bits[point, k])) * uint64(0x9E3779B97F4A7C15)
        code ^= code >> uint64(32)
    return code & mask


@njit(cache=True)
def number_points(bits, first, place):  # type: ignore[no-untyped-def]
    """Number the different points by their bits (n, 3), in the order in which they first occur. Returns how many.

    first: of each different point the first that is equal to it; place: the number of each point.
    """
    table = np.full(START, -1, dtype=np.int32)
    mask, count = uint64(START - 1), 0
    for point in range(len(bits)):
        if 2 * count >= len(table):
            table, mask = _grown(bits, first, count, 4 * len(table))
        slot = _slot(bits, point, mask)
        while table[slot] >= 0 and not _equal(bits, first[table[slot]], point):
            slot = (slot + uint64(1)) & mask
        if table[slot] < 0:
            table[slot] = count
            first[count] = point
            count += 1
        place[point] = table[slot]
    return count


@njit(inline="always")
def _equal(bits, a, b):  # type: ignore[no-untyped-def]
    return bits[a, 0] == bits[b, 0] and bits[a, 1] == bits[b, 1] and bits[a, 2] == bits[b, 2]


@njit(cache=True)
def _grown(bits, first, count, size):  # type: ignore[no-untyped-def]
    """A larger table of the points known so far."""
    table, mask = np.full(size, -1, dtype=np.int32), uint64(size - 1)
    for number in range(count):
        slot = _slot(bits, first[number], mask)
        while table[slot] >= 0:
            slot = (slot + uint64(1)) & mask
        table[slot] = number
    return table, mask
