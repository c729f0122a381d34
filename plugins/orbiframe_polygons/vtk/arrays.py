"""Arrays of VTK's XML files: numbers as text, in base64 or appended as bytes, and compressed in blocks."""

from __future__ import annotations

import base64
import binascii
import lzma
import re
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError
from orbiframe_polygons.faces import whole
from orbiframe_polygons.room import Budget
from orbiframe_polygons.text import table
from orbiframe_polygons.vtk import lz4

Array = NDArray[Any]

TYPES = {**{f"Int{8 * n}": f"i{n}" for n in (1, 2, 4, 8)}, **{f"UInt{8 * n}": f"u{n}" for n in (1, 2, 4, 8)},
         "Float32": "f4", "Float64": "f8", "vtkIdType": "i8"}  # fmt: skip
APPENDED = re.compile(rb"<AppendedData\b([^>]*)>\s*_")
ENCODING = re.compile(rb"""encoding\s*=\s*["'](\w+)["']""")
# The counts before the sizes of compressed blocks.
COUNTS = 3


def _zlib(data: bytes, size: int) -> bytes | None:
    engine = zlib.decompressobj()
    found = engine.decompress(data, size + 1)
    return found if len(found) == size else None


def _lzma(data: bytes, size: int) -> bytes | None:
    # No dictionary larger than this: VTK's blocks are small.
    found = lzma.LZMADecompressor(memlimit=2**28).decompress(data, size + 1)
    return found if len(found) == size else None


COMPRESSORS: dict[str, Callable[[bytes, int], bytes | None]] = {
    "vtkZLibDataCompressor": _zlib,
    "vtkLZ4DataCompressor": lz4.unpacked,
    "vtkLZMADataCompressor": _lzma,
}


@dataclass(slots=True)
class Described:
    """A DataArray as the XML describes it, with its text."""

    attributes: dict[str, str]
    line: int
    text: list[str] = field(default_factory=list)


class Arrays:
    """Reads the arrays of one file.

    root: the attributes of VTKFile; appended: all bytes of the file.
    """

    def __init__(self, path: Path, root: dict[str, str], content: bytes) -> None:
        self._path = path
        self._order = {"LittleEndian": "<", "BigEndian": ">"}.get(root.get("byte_order", "LittleEndian"), "")
        self._header = {"UInt32": "u4", "UInt64": "u8"}.get(root.get("header_type", "UInt32"), "")
        self._compressor = root.get("compressor", "")
        self._content = content
        self._budget = Budget(path, "its arrays swell")
        if not self._order or not self._header or (self._compressor and self._compressor not in COMPRESSORS):
            raise FormatError(
                f"{path}: byte_order={root.get('byte_order')}, header_type={root.get('header_type')} or compressor="
                f"{self._compressor[:40]} is not known; zlib, LZ4 and LZMA are read"
            )

    def floats(self, array: Described, count: int) -> NDArray[np.float64]:
        """So many finite numbers."""
        values = self._numbers(array, count).astype(np.float64)
        if not np.isfinite(values).all():
            self._refuse(array, "a number is not finite")
        return values

    def whole(self, array: Described, count: int | None) -> NDArray[np.intp]:
        """So many whole numbers, or all of them."""
        return whole(self._numbers(array, count), lambda _: f"{self._path}, line {array.line}")

    def _numbers(self, array: Described, count: int | None) -> Array:
        kind = array.attributes.get("type", "")
        if kind not in TYPES:
            self._refuse(array, f"the type {kind[:20]!r} is not known")
        form = array.attributes.get("format", "ascii").lower()
        if form == "ascii":
            values = table(self._path, "".join(array.text).encode(), line=array.line).numbers()
        elif form in ("binary", "appended"):
            data = self._inline(array) if form == "binary" else self._appended(array)
            dtype = np.dtype(self._order + TYPES[kind])
            if len(data) % dtype.itemsize:
                self._refuse(array, f"{len(data)} bytes are no numbers of {dtype.itemsize} bytes")
            values = np.frombuffer(data, dtype)
        else:
            self._refuse(array, f"the format {form[:20]!r} is not known")
        if count is not None and len(values) != count:
            self._refuse(array, f"{count} numbers are declared, but {len(values)} follow; is the file cut short?")
        return values

    # ---- bytes --------------------------------------------------------------------------------------------------

    def _inline(self, array: Described) -> bytes:
        text = "".join("".join(array.text).split()).encode("ascii", errors="replace")
        return self._base64(array, text)

    def _appended(self, array: Described) -> bytes:
        found = APPENDED.search(self._content)
        offset = array.attributes.get("offset", "")
        if found is None or not (offset.isascii() and offset.isdigit() and len(offset) < 16):
            self._refuse(array, "the array is appended, but there is no appended data, or no offset into it")
        encoding = ENCODING.search(found[1])
        start = found.end() + int(offset)
        if encoding is not None and encoding[1] == b"base64":
            end = self._content.find(b"<", found.end())
            return self._base64(array, self._content[start : end if end >= 0 else None])
        if encoding is None or encoding[1] != b"raw":
            self._refuse(array, "the encoding of the appended data is not known; raw and base64 are read")
        size = len(self._head(array, self._content[start : start + self._head_room]))
        return self._body(array, self._content, start, start + size)

    @property
    def _head_room(self) -> int:
        return COUNTS * np.dtype(self._header).itemsize

    def _head(self, array: Described, start: bytes) -> bytes:
        """As many bytes as the header has; its first counts are given."""
        item = np.dtype(self._header).itemsize
        if not self._compressor:
            return bytes(item)
        if len(start) < item:
            self._refuse(array, "the array ends inside its header; is the file cut short?")
        blocks = int(np.frombuffer(start, self._order + self._header, 1)[0])
        if blocks > len(self._content):
            self._refuse(array, f"{blocks} compressed blocks are declared, more than the file has bytes")
        return bytes(item * (COUNTS + blocks))

    def _base64(self, array: Described, text: bytes) -> bytes:
        """The header and the numbers, each in base64 by itself where they are compressed."""
        if not self._compressor:
            item = np.dtype(self._header).itemsize
            size = self._counts(array, self._decoded(array, text[: _letters(item)])[:item], 1)[0]
            both = self._decoded(array, text[: _letters(item + size)])
            return self._body(array, both, 0, item)
        first = self._decoded(array, text[: _letters(self._head_room)])
        size = len(self._head(array, first))
        head = self._decoded(array, text[: _letters(size)])
        body = self._decoded(array, text[_letters(size) : _letters(size) + _letters(self._packed(array, head, size))])
        return self._body(array, head[:size] + body, 0, size)

    def _packed(self, array: Described, head: bytes, size: int) -> int:
        return sum(self._counts(array, head, size // np.dtype(self._header).itemsize)[COUNTS:])

    def _decoded(self, array: Described, text: bytes) -> bytes:
        try:
            return base64.b64decode(text, validate=True)
        except binascii.Error as error:
            self._refuse(array, f"this is no base64: {error}")

    def _counts(self, array: Described, data: bytes, count: int) -> list[int]:
        """The counts of a header."""
        item = np.dtype(self._header).itemsize
        if len(data) < item * count:
            self._refuse(array, "the array ends inside its header; is the file cut short?")
        return [int(n) for n in np.frombuffer(data, self._order + self._header, count)]

    def _body(self, array: Described, data: bytes, start: int, end: int) -> bytes:
        """The numbers after a header that stands in the bytes from start to end."""
        counts = self._counts(array, data[start:end], (end - start) // np.dtype(self._header).itemsize)
        if not self._compressor:
            if counts[0] > len(data) - end:
                self._refuse(array, f"{counts[0]} bytes are declared, but {len(data) - end} follow; is it cut short?")
            return data[end : end + counts[0]]
        blocks, size, last, *packed = counts
        made, engine = [], COMPRESSORS[self._compressor]
        for k in range(blocks):
            wanted = last if k == blocks - 1 and last else size
            self._budget.spend(wanted)
            block = data[end : end + packed[k]]
            end += packed[k]
            try:
                found = engine(block, wanted) if len(block) == packed[k] else None
            except (zlib.error, lzma.LZMAError, MemoryError):
                found = None
            if found is None:
                self._refuse(array, f"the compressed block {k} is damaged, or larger than it says")
            made.append(found)
        return b"".join(made)

    def _refuse(self, array: Described, complaint: str) -> NoReturn:
        name = array.attributes.get("Name", "")[:40]
        raise FormatError(f"{self._path}, line {array.line}: the array {name!r}: {complaint}")


def _letters(size: int) -> int:
    """How many letters so many bytes take in base64."""
    return 4 * -(-size // 3)
