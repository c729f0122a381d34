"""Blocks of LZ4 unpacked in a compiled loop; `lz4.py` does the same for small ones."""

from __future__ import annotations

import numpy as np

from orbiframe.compiled import compiled

_ENDLESS = 2**60


@compiled(arrays=False)
def _longer(source, at, count):  # type: ignore[no-untyped-def]
    """Where a length that goes on after its first half byte ends, and the length; past the source: no length."""
    more = np.int64(255)
    while more == 255:
        if at >= len(source):
            return at, _ENDLESS
        more = np.int64(source[at])
        at += 1
        count += more
    return at, count


@compiled(arrays=False)
def fill(source, out):  # type: ignore[no-untyped-def]
    """Fill `out` by sequences of literals and matches; whether it is full exactly where the source ends."""
    at, to = np.int64(0), np.int64(0)
    while at < len(source):
        token = np.int64(source[at])
        at += 1
        count = token >> 4
        if count == 15:
            at, count = _longer(source, at, count)
        if at + count > len(source) or to + count > len(out):
            return False
        for k in range(count):
            out[to + k] = source[at + k]
        at += count
        to += count
        if at == len(source):
            return to == len(out)
        if at + 2 > len(source):
            return False
        back = np.int64(source[at]) + 256 * np.int64(source[at + 1])
        at += 2
        count = 4 + (token & 15)
        if count == 19:
            at, count = _longer(source, at, count)
        if back == 0 or back > to or to + count > len(out):
            return False
        for k in range(count):
            out[to + k] = out[to + k - back]
        to += count
    return False
