"""Rows of numbers as text, by compiled loops; `lines.py` does the same for small tables."""

from __future__ import annotations

from numpy import int64, uint64

from orbiframe.compiled import compiled
from orbiframe_polygons.compiled_numbers import high_and_low
from orbiframe_polygons.powers import LEAST

# No float64 takes more characters: -2.2250738585072014e-308.
WIDEST = 24


@compiled(inline=True)
def _rounded_to_odd(powers, row, x):  # type: ignore[no-untyped-def]
    """The upper 64 bits of power · x, with the last bit set where something was cut off."""
    carried, _ = high_and_low(powers[row, 1], x)
    high, low = high_and_low(powers[row, 0], x)
    low += carried
    if low < carried:
        high += uint64(1)
    return high | uint64(low > uint64(1))


@compiled
def shortest(bits, powers):  # type: ignore[no-untyped-def]
    """Digits and power of ten, digits · 10^power, of a positive finite float64 given by its bits.

    Of all decimal numbers that read as this float64 the one of fewest digits, and of those the nearest; zeros may stand
    at its end.

    Source: R. Giulietti, The Schubfach way to render doubles, 2020.
    """
    fraction, biased = bits & ((uint64(1) << uint64(52)) - uint64(1)), int64(bits >> uint64(52))
    c = fraction | (uint64(1) << uint64(52)) if biased else fraction
    q = (biased if biased else 1) - 1075
    if -52 <= q <= 0 and c & ((uint64(1) << uint64(-q)) - uint64(1)) == uint64(0):
        return c >> uint64(-q), 0
    odd = c & uint64(1)
    closer = fraction == uint64(0) and biased > 1
    k = (q * 1262611 - (524031 if closer else 0)) >> 22
    shift = uint64(q + ((-k * 1741647) >> 19) + 1)
    row = -k - LEAST
    below = _rounded_to_odd(powers, row, (uint64(4) * c - uint64(1 if closer else 2)) << shift)
    value = _rounded_to_odd(powers, row, (uint64(4) * c) << shift)
    above = _rounded_to_odd(powers, row, (uint64(4) * c + uint64(2)) << shift)
    lower, upper = below + odd, above - odd
    s = value >> uint64(2)
    if s >= uint64(10):
        tens = s // uint64(10)
        down, up = lower <= uint64(40) * tens, uint64(40) * tens + uint64(40) <= upper
        if down != up:
            return tens + uint64(up), k + 1
    down, up = lower <= uint64(4) * s, uint64(4) * s + uint64(4) <= upper
    if down != up:
        return s + uint64(up), k
    middle = uint64(4) * s + uint64(2)
    up = value > middle or (value == middle and s & uint64(1) == uint64(1))
    return s + uint64(up), k


@compiled(inline=True)
def _put_digits(out, at, number, count):  # type: ignore[no-untyped-def]
    """The last digits of a number."""
    for place in range(at + count - 1, at - 1, -1):
        rest = number // uint64(10)
        out[place] = uint64(48) + number - rest * uint64(10)
        number = rest
    return at + count


@compiled(inline=True)
def _digit_count(number):  # type: ignore[no-untyped-def]
    count = 1
    while number >= uint64(10):
        number //= uint64(10)
        count += 1
    return count


@compiled
def put_whole(out, at, number):  # type: ignore[no-untyped-def]
    """A whole number that is not negative, as text. Returns where it ends."""
    return _put_digits(out, at, uint64(number), _digit_count(uint64(number)))


@compiled
def put_number(out, at, bits, powers):  # type: ignore[no-untyped-def]
    """A finite float64, given by its bits, as Python writes it. Returns where it ends."""
    if bits >> uint64(63):
        out[at] = 45
        at += 1
        bits &= ~(uint64(1) << uint64(63))
    digits, power = uint64(0), 0
    if bits:
        digits, power = shortest(bits, powers)
        while digits % uint64(10) == uint64(0):
            digits //= uint64(10)
            power += 1
    count = _digit_count(digits)
    point = count + power
    if point <= -4 or point > 16:
        at = _put_scientific(out, at, digits, count, point - 1)
    elif point <= 0:
        out[at], out[at + 1] = 48, 46
        at = _put_digits(out, at + 2, uint64(0), -point)
        at = _put_digits(out, at, digits, count)
    elif power >= 0:
        at = _put_digits(out, at, digits, count)
        at = _put_digits(out, at, uint64(0), power)
        out[at], out[at + 1] = 46, 48
        at += 2
    else:
        at = _put_split(out, at, digits, count, point)
    return at


@compiled(inline=True)
def _put_split(out, at, digits, count, point):  # type: ignore[no-untyped-def]
    """Digits with a point among them."""
    end = _put_digits(out, at + 1, digits, count)
    for place in range(at, at + point):
        out[place] = out[place + 1]
    out[at + point] = 46
    return end


@compiled(inline=True)
def _put_scientific(out, at, digits, count, exponent):  # type: ignore[no-untyped-def]
    at = _put_digits(out, at, digits, 1) if count == 1 else _put_split(out, at, digits, count, 1)
    out[at], out[at + 1] = 101, 45 if exponent < 0 else 43
    size = uint64(abs(exponent))
    return _put_digits(out, at + 2, size, max(2, _digit_count(size)))


@compiled(inline=True)
def _put_bytes(out, at, source, first, last):  # type: ignore[no-untyped-def]
    for place in range(first, last):
        out[at] = source[place]
        at += 1
    return at


@compiled
def put_rows(out, powers, lead, counted, twice, offsets, numbers, glue, glued, bits, whole):  # type: ignore[no-untyped-def]
    """Rows of text: a lead or a count, whole numbers, then the columns of a table with the glue before, between, after.

    offsets, numbers: the whole numbers of each row, each after a blank, and twice (k//k) if wanted; glue, glued: bytes
    and where each piece starts; bits: those of the table (n, k); whole: which columns are written as whole numbers.
    Returns how many bytes were put.
    """
    at, columns = 0, bits.shape[1]
    for row in range(len(offsets) - 1):
        if counted:
            at = put_whole(out, at, offsets[row + 1] - offsets[row])
        at = _put_bytes(out, at, lead, 0, len(lead))
        for place in range(offsets[row], offsets[row + 1]):
            out[at] = 32
            at = put_whole(out, at + 1, numbers[place])
            if twice:
                out[at], out[at + 1] = 47, 47
                at = put_whole(out, at + 2, numbers[place])
        for column in range(columns):
            at = _put_bytes(out, at, glue, glued[column], glued[column + 1])
            if whole[column]:
                at = put_whole(out, at, bits[row, column])
            else:
                at = put_number(out, at, bits[row, column], powers)
        at = _put_bytes(out, at, glue, glued[columns], glued[columns + 1])
    return at
