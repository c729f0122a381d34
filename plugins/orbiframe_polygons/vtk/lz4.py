"""LZ4: blocks of the compressor of VTK, unpacked.

Source: Y. Collet, LZ4 Block Format Description.
"""

from __future__ import annotations

import numpy as np

# From so many bytes on, a compiled loop gains more time than the import of the compiler takes.
LARGE = 2**18


def unpacked(data: bytes, size: int) -> bytes | None:
    """The bytes of a block of a known size; None where the block is not sound."""
    return (_by_compiled_loop if size >= LARGE else _by_slices)(data, size)


def _by_compiled_loop(data: bytes, size: int) -> bytes | None:
    from orbiframe_polygons.vtk.compiled_lz4 import fill

    out = np.empty(size, dtype=np.uint8)
    return out.tobytes() if fill(np.frombuffer(data, dtype=np.uint8), out) else None


def _by_slices(data: bytes, size: int) -> bytes | None:
    """Each sequence is a token with two lengths, literals, and how far back the bytes stand that come again."""
    out, at = bytearray(), 0
    try:
        while len(out) <= size:
            token = data[at]
            count, at = _length(data, at + 1, token >> 4)
            if at + count > len(data):
                return None
            out += data[at : at + count]
            at += count
            if at == len(data):
                return bytes(out) if len(out) == size else None
            back = data[at] + 256 * data[at + 1]
            count, at = _length(data, at + 2, token & 15)
            if not 0 < back <= len(out) or len(out) + count + 4 > size:
                return None
            again = bytes(out[-back:])
            out += (again * (1 + (count + 4) // back))[: count + 4]
    except IndexError:
        return None
    return None


def _length(data: bytes, at: int, start: int) -> tuple[int, int]:
    """A length of four bits, which goes on in further bytes from 15 on, and the place after it."""
    if start == 15:
        while data[at] == 255:
            start, at = start + 255, at + 1
        start, at = start + data[at], at + 1
    return start, at
