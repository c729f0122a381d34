"""Powers of ten to 128 bits: what exact conversion between decimal text and float64 needs."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

LEAST, MOST = -342, 326


@cache
def powers_of_ten(*, rounded_up: bool) -> NDArray[np.uint64]:
    """The leading 128 bits of 10^k for k from LEAST to MOST, as pairs (high, low) of 64 bits, (n, 2).

    Positive powers are cut off below, or rounded up; negative powers are always rounded up. That is what reading
    (D. Lemire, Number parsing at a gigabyte per second, 2021) and writing (R. Giulietti, The Schubfach way to render
    doubles, 2020) ask for.
    """
    whole = [_leading(k, rounded_up) for k in range(LEAST, MOST + 1)]
    return np.array([(bits >> 64, bits & (2**64 - 1)) for bits in whole], dtype=np.uint64)


def _leading(k: int, rounded_up: bool) -> int:
    """The first 128 bits of 5^k, which are those of 10^k."""
    if k < 0:
        return _reciprocal(5 ** abs(k))
    power: int = 5**k
    excess = power.bit_length() - 128
    if excess <= 0:
        return power << -excess
    return (power >> excess) + rounded_up


def _reciprocal(power: int) -> int:
    """The first 128 bits of 1 / power, rounded up."""
    return (1 << (power.bit_length() + 127)) // power + 1
