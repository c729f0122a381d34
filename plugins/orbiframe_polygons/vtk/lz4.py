"""LZ4: blocks of the compressor of VTK, unpacked.

Source: Y. Collet, LZ4 Block Format Description.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]

# From so many bytes on, a compiled loop gains more time than the import of the compiler takes.
LARGE = 2**18


def unpacked(data: bytes, size: int) -> bytes | None:
    """The bytes of a block of a known size; None where the block is not sound."""
    out = np.empty(size, dtype=np.uint8)
    source = np.frombuffer(data, dtype=np.uint8)
    fill = _fill_compiled() if size >= LARGE else _fill
    return out.tobytes() if fill(source, out) else None


@cache
def _fill_compiled() -> Any:
    from orbiframe.compiled import compiled

    return compiled(_fill)


def _fill(source: Bytes, out: Bytes) -> bool:
    """Fill `out` by sequences of literals and matches; whether it is full exactly where the source ends."""
    at, to = 0, 0
    while at < len(source):
        token = int(source[at])
        at += 1
        count = token >> 4
        if count == 15:
            more = 255
            while more == 255:
                if at >= len(source):
                    return False
                more = int(source[at])
                at += 1
                count += more
        if at + count > len(source) or to + count > len(out):
            return False
        out[to : to + count] = source[at : at + count]
        at += count
        to += count
        if at == len(source):
            return to == len(out)
        if at + 2 > len(source):
            return False
        back = int(source[at]) + 256 * int(source[at + 1])
        at += 2
        count = 4 + (token & 15)
        if count == 19:
            more = 255
            while more == 255:
                if at >= len(source):
                    return False
                more = int(source[at])
                at += 1
                count += more
        if back == 0 or back > to or to + count > len(out):
            return False
        for k in range(count):
            out[to + k] = out[to + k - back]
        to += count
    return False
