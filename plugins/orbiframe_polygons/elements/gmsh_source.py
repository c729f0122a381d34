"""Source of Gmsh: a stream of numbers, as words of a text or as bytes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn, Protocol

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError
from orbiframe_polygons.faces import EXACT
from orbiframe_polygons.text import Text

Array = NDArray[Any]


class Source(Protocol):
    """Numbers that are taken one table after the other."""

    def take(self, kinds: str, rows: int = 1) -> list[Array]:
        """The next rows as columns: i, a whole number; s, a size; d, a float. A count is at most 16 digits long."""

    def refuse(self, complaint: str) -> NoReturn:
        """Raise FormatError with the place."""

    def require_end(self) -> None:
        """Raise FormatError where something is left."""


@dataclass(slots=True)
class Words:
    """The words of a section of a text, all numbers."""

    path: Path
    text: Text
    values: NDArray[np.float64]
    at: int = 0

    def take(self, kinds: str, rows: int = 1) -> list[Array]:
        """The next rows as columns."""
        size = len(kinds) * rows
        if rows < 0 or size > len(self.values) - self.at:
            self.refuse(
                f"{rows} rows of {len(kinds)} numbers are declared, but the section ends; is the file cut short?"
            )
        block = self.values[self.at : self.at + size].reshape(rows, len(kinds))
        columns = [column if kind == "d" else self._whole(column) for kind, column in zip(kinds, block.T, strict=True)]
        self.at += size
        return columns

    def _whole(self, column: Array) -> Array:
        integers = column.astype(np.int64)
        wrong = (integers != column) | (np.abs(column) > EXACT)
        if wrong.any():
            self.refuse(f"found {column[wrong.argmax()]:g}, but a whole number is required")
        return integers

    def refuse(self, complaint: str) -> NoReturn:
        """Raise FormatError with the line."""
        if not len(self.text):
            raise FormatError(f"{self.path}: {complaint}")
        word = min(self.at, len(self.values) - 1)
        row = int(np.searchsorted(self.text.first, word, side="right")) - 1
        self.text.refuse(row, complaint)

    def require_end(self) -> None:
        """Raise FormatError where something is left."""
        if self.at < len(self.values):
            self.refuse("the section goes on after what its counts say")


@dataclass(slots=True)
class Bytes:
    """The bytes of a binary file, from a place on.

    order: of the bytes; size: bytes of a size, 4 or 8.
    """

    path: Path
    data: bytes
    at: int
    order: str
    size: int = 8

    def take(self, kinds: str, rows: int = 1) -> list[Array]:
        """The next rows as columns."""
        types = {"i": "i4", "s": f"u{self.size}", "d": "f8"}
        dtype = np.dtype([(str(k), self.order + types[kind]) for k, kind in enumerate(kinds)])
        if rows < 0 or rows * dtype.itemsize > len(self.data) - self.at:
            self.refuse(f"{rows} rows of {dtype.itemsize} bytes are declared, but the file ends; is it cut short?")
        block = np.frombuffer(self.data, dtype, rows, self.at)
        self.at += rows * dtype.itemsize
        columns = [block[str(k)] for k in range(len(kinds))]
        for kind, column in zip(kinds, columns, strict=True):
            if kind == "s" and len(column) and int(column.max()) >= EXACT:
                self.refuse(f"found {column.max()}, but a size below {EXACT:g} is required")
        return [c.astype(np.float64 if k == "d" else np.int64) for k, c in zip(kinds, columns, strict=True)]

    def refuse(self, complaint: str) -> NoReturn:
        """Raise FormatError with the byte."""
        raise FormatError(f"{self.path}, byte {self.at}: {complaint}")

    def require_end(self) -> None:
        """The end of a section is looked for by its reader."""
