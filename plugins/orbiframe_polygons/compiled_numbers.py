"""Decimal numbers in large texts, by compiled loops; `numbers.py` does the same for small ones."""

from __future__ import annotations

from numpy import int64, uint64

from orbiframe.compiled import compiled
from orbiframe_polygons.powers import LEAST

NEWLINE, BLANK, CONTINUED = 10, 32, 11
# 10^19 is the largest power of ten that 64 bits hold.
DIGITS = 19
UNKNOWN = 0xFFFFFFFFFFFFFFFF


@compiled(inline=True)
def high_and_low(a, b):  # type: ignore[no-untyped-def]
    """The upper and the lower 64 bits of a product of two uint64."""
    half, mask = uint64(32), uint64(0xFFFFFFFF)
    a0, a1, b0, b1 = a & mask, a >> half, b & mask, b >> half
    p00, p01, p10 = a0 * b0, a0 * b1, a1 * b0
    middle = (p00 >> half) + (p01 & mask) + (p10 & mask)
    return a1 * b1 + (p01 >> half) + (p10 >> half) + (middle >> half), (middle << half) | (p00 & mask)


@compiled(inline=True)
def _leading_zeros(x):  # type: ignore[no-untyped-def]
    n = 0
    for step in (32, 16, 8, 4, 2, 1):
        if x >> uint64(64 - step) == uint64(0):
            n += step
            x <<= uint64(step)
    return n


@compiled
def nearest_bits(mantissa, exponent, powers):  # type: ignore[no-untyped-def]
    """The bits of the float64 nearest to mantissa · 10^exponent; UNKNOWN where this way cannot tell.

    That is so for results that are not normal numbers, and for a few that lie all but halfway between two.

    Source: D. Lemire, Number parsing at a gigabyte per second, 2021, algorithm 1.
    """
    if mantissa == uint64(0):
        return uint64(0)
    if exponent < LEAST or exponent > 308:
        return uint64(UNKNOWN)
    zeros = _leading_zeros(mantissa)
    shifted = mantissa << uint64(zeros)
    high, low = high_and_low(shifted, powers[exponent - LEAST, 0])
    if high & uint64(0x1FF) == uint64(0x1FF):
        more, _ = high_and_low(shifted, powers[exponent - LEAST, 1])
        low += more
        if low < more:
            high += uint64(1)
    if low == uint64(UNKNOWN) and (exponent < -27 or exponent > 55):
        return uint64(UNKNOWN)
    upper = high >> uint64(63)
    drop = upper + uint64(9)
    bits = high >> drop
    binary = ((217706 * exponent) >> 16) + 63 + int64(upper) - zeros + 1023
    if binary <= 0 or binary >= 2046:
        return uint64(UNKNOWN)
    # Halfway between two numbers, to the last bit: the even one.
    if low <= uint64(1) and -4 <= exponent <= 23 and bits & uint64(3) == uint64(1) and bits << drop == high:
        bits &= ~uint64(1)
    bits = (bits + (bits & uint64(1))) >> uint64(1)
    if bits >> uint64(53):
        bits >>= uint64(1)
        binary += 1
    return (bits & ~(uint64(1) << uint64(52))) | (uint64(binary) << uint64(52))


@compiled
def parse_words(data, powers, values, bits, hard):  # type: ignore[no-untyped-def]
    """Read every word of a text as a decimal number; `bits` are those of `values`.

    Words that this way cannot read, all that are no numbers among them, are put into `hard`: index, first byte, byte
    after. Returns how many words there are and how many of them are hard; a count above len(hard) says that there was
    no room for more.
    """
    at, size, count, left = 0, len(data), 0, 0
    while left <= len(hard):
        while at < size and data[at] <= BLANK:
            at += 1
        if at == size:
            break
        first = at
        negative = data[at] == 45
        if negative or data[at] == 43:
            at += 1
        mantissa, digits, exponent, start = uint64(0), 0, 0, at
        while at < size and 48 <= data[at] <= 57:
            mantissa = mantissa * uint64(10) + uint64(data[at] - 48)
            digits += digits > 0 or data[at] > 48
            at += 1
        filled = at > start
        if at < size and data[at] == 46:
            at += 1
            start = at
            while at < size and 48 <= data[at] <= 57:
                mantissa = mantissa * uint64(10) + uint64(data[at] - 48)
                digits += digits > 0 or data[at] > 48
                at += 1
            exponent = start - at
            filled |= at > start
        good = filled and digits <= DIGITS
        if good and at < size and data[at] | 32 == 101:
            at += 1
            below = at < size and data[at] == 45
            if at < size and (below or data[at] == 43):
                at += 1
            start, power = at, 0
            while at < size and 48 <= data[at] <= 57:
                power = min(power * 10 + data[at] - 48, 99999)
                at += 1
            good = at > start
            exponent += -power if below else power
        known = good and (at == size or data[at] <= BLANK)
        if known and exponent == 0 and mantissa >> uint64(53) == uint64(0):
            values[count] = -float(mantissa) if negative else float(mantissa)
        else:
            found = nearest_bits(mantissa, exponent, powers) if known else uint64(UNKNOWN)
            if found == uint64(UNKNOWN):
                while at < size and data[at] > BLANK:
                    at += 1
                if left < len(hard):
                    hard[left, 0], hard[left, 1], hard[left, 2] = count, first, at
                left += 1
            bits[count] = found | (uint64(negative) << uint64(63))
        count += 1
    return count, left


@compiled
def find_lines(data, begin, end, number, words):  # type: ignore[no-untyped-def]
    """The lines that are not blank: first word, end, number of line ends before, and words of each. Returns how many.

    A line that is joined to the next has its own mark (CONTINUED), which counts as a blank and as an end of line.
    """
    row, line, first, count, inside = 0, 0, 0, 0, False
    for at in range(len(data)):
        code = data[at]
        if code > BLANK:
            if not inside:
                if count == 0:
                    begin[row], number[row] = at, first
                count += 1
                inside = True
            continue
        inside = False
        if code == NEWLINE:
            if count:
                end[row], words[row] = at, count
                row += 1
                count = 0
            line += 1
            first = line
        elif code == CONTINUED:
            line += 1
    if count:
        end[row], words[row] = len(data), count
        row += 1
    return row
