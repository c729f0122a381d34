"""Equal points found by hashing, in a compiled loop; `weld.py` does the same for few points by sorting."""

from __future__ import annotations

from numpy import full, int32, uint64

from orbiframe.compiled import compiled

START = 2**12
# Most corners come again soon: a small table of late points stays in the fastest memory.
LATE = 2**13


@compiled(inline=True)
def _code(x, y, z):  # type: ignore[no-untyped-def]
    odd, half = uint64(0x9E3779B97F4A7C15), uint64(32)
    code = uint64(x) * odd
    code = (code ^ (code >> half) ^ uint64(y)) * odd
    code = (code ^ (code >> half) ^ uint64(z)) * odd
    return code ^ (code >> half)


@compiled(inline=True)
def _find(table, code, unique, x, y, z):  # type: ignore[no-untyped-def]
    """The slot of a point, or the free one where it belongs."""
    mask = uint64(len(table) - 1)
    slot = code & mask
    while table[slot] >= 0 and not _is_at(unique, table[slot], x, y, z):
        slot = (slot + uint64(1)) & mask
    return slot


@compiled(inline=True)
def _is_at(unique, number, x, y, z):  # type: ignore[no-untyped-def]
    return unique[number, 0] == x and unique[number, 1] == y and unique[number, 2] == z


@compiled
def number_points(bits, minus_zero, unique, place):  # type: ignore[no-untyped-def]
    """Number the different points by their bits, (n, m, 3), in the order in which they first occur.

    unique: the bits of the different points, without minus zeros; place: the number of each point, (n · m,). Returns
    how many different points there are.
    """
    zero = minus_zero ^ minus_zero
    table, late, count, index = full(START, -1, int32), full(LATE, -1, int32), 0, 0
    for row in range(bits.shape[0]):
        for corner in range(bits.shape[1]):
            x, y, z = bits[row, corner, 0], bits[row, corner, 1], bits[row, corner, 2]
            x = zero if x == minus_zero else x
            y = zero if y == minus_zero else y
            z = zero if z == minus_zero else z
            code = _code(x, y, z)
            number = late[code & uint64(LATE - 1)]
            if number < 0 or not _is_at(unique, number, x, y, z):
                if 2 * count >= len(table):
                    table = _grown(unique, count, 4 * len(table))
                slot = _find(table, code, unique, x, y, z)
                if table[slot] < 0:
                    table[slot] = count
                    unique[count, 0], unique[count, 1], unique[count, 2] = x, y, z
                    count += 1
                number = table[slot]
                late[code & uint64(LATE - 1)] = number
            place[index] = number
            index += 1
    return count


@compiled
def _grown(unique, count, size):  # type: ignore[no-untyped-def]
    """A larger table of the points known so far."""
    table = full(size, -1, int32)
    for number in range(count):
        x, y, z = unique[number, 0], unique[number, 1], unique[number, 2]
        table[_find(table, _code(x, y, z), unique, x, y, z)] = number
    return table
