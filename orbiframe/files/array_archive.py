"""Array archives: NumPy's .npz files, read with nothing pickled and no memory taken before its size is known to fit."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

# Arrays are some 5 times as large as the file that holds them; zeros packed to make a large array are 1000 times.
ROOM, TIMES = 2**24, 64


class Shape(NamedTuple):
    """What an archive says of an array before it is read."""

    type: np.dtype[Any]
    shape: tuple[int, ...]
    by_columns: bool

    @property
    def size(self) -> int:
        """In bytes."""
        size = self.type.itemsize
        for length in self.shape:
            size *= length
        return size


class ArrayArchive:
    """An archive opened for reading: first the shapes of all arrays, then the arrays.

    Raises ValueError for arrays of anything but numbers and texts, that are not as long as they say, or that are
    together far larger than the file; and whatever zipfile, zlib and numpy raise for what is no whole archive.
    """

    def __init__(self, path: Path) -> None:
        self._file = zipfile.ZipFile(path)
        self._limit = ROOM + TIMES * path.stat().st_size
        self.shapes: Mapping[str, Shape] = self._read_shapes()

    def __enter__(self) -> ArrayArchive:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def read(self, name: str) -> NDArray[Any]:
        """An array, of which every byte has been checked against the sum in the archive."""
        shape = self.shapes[name]
        with self._file.open(f"{name}.npy") as member:
            _read_header(member, name)
            content = member.read(shape.size)
            if len(content) != shape.size or member.read(1):
                raise ValueError(f"the array '{name}' is not as long as its header says")
        numbers = np.frombuffer(bytearray(content), shape.type)  # of bytes that may be written, as compiled code asks
        native = numbers.astype(shape.type.newbyteorder("="), copy=False)
        return native.reshape(shape.shape, order="F" if shape.by_columns else "C")

    def _read_shapes(self) -> dict[str, Shape]:
        shapes: dict[str, Shape] = {}
        for entry in self._file.infolist():
            name = entry.filename.removesuffix(".npy")
            if name in shapes or name == entry.filename:
                raise ValueError(f"'{entry.filename}' is no array, or is there twice")
            if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise ValueError(f"the array '{name}' is packed in a way that numpy does not use")
            with self._file.open(entry) as member:
                shapes[name] = _read_header(member, name)
            if entry.file_size > shapes[name].size + 2**16:
                raise ValueError(f"the array '{name}' is not as long as its header says")
        total = sum(shape.size for shape in shapes.values())
        if total > self._limit:
            raise ValueError(f"its arrays take {total} bytes, and a file of its size holds at most {self._limit}")
        return shapes


def _read_header(member: Any, name: str) -> Shape:
    version = npy.read_magic(member)
    if version not in ((1, 0), (2, 0)):
        raise ValueError(f"the array '{name}' has a header of version {version}")
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, fortran, type_ = read(member)
    if type_.kind not in "biufU" or type_.hasobject:
        raise ValueError(f"the array '{name}' holds neither numbers nor a text")
    if any(length < 0 for length in shape):
        raise ValueError(f"the array '{name}' has a negative length")
    return Shape(type_, tuple(map(int, shape)), bool(fortran))
