"""PLY body: the rows of every element, from text or from bytes, as columns."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError
from orbiframe_polygons.faces import Place, ragged
from orbiframe_polygons.ply_header import Element, Header, Property
from orbiframe_polygons.text import Text, named, plain, table

Array = NDArray[Any]
Ints = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Table:
    """An element's columns; of a list the numbers of all rows one after the other, and `sizes` how many each row has.

    place: where a row stands in the file, in words.
    """

    element: Element
    columns: dict[str, Array]
    sizes: dict[str, Ints]
    place: Place


class Source(Protocol):
    """Where numbers stand: counted in words of a text, or in bytes."""

    def size(self, kind: str) -> int:
        """How far a number of this type reaches."""

    def at(self, position: Ints, kind: str) -> Array:
        """The numbers of this type at these positions."""


@dataclass(frozen=True, slots=True)
class Words:
    """The numbers of a text, counted one by one."""

    values: NDArray[np.float64]

    def size(self, kind: str) -> int:  # noqa: ARG002
        """One word, whatever the type."""
        return 1

    def at(self, position: Ints, kind: str) -> Array:  # noqa: ARG002
        """The numbers at these places."""
        return self.values[position]


@dataclass(frozen=True, slots=True)
class Memory:
    """The bytes of a binary file."""

    data: bytes
    order: str

    def size(self, kind: str) -> int:
        """Bytes of a number of this type."""
        return np.dtype(kind).itemsize

    def at(self, position: Ints, kind: str) -> Array:
        """The numbers that start at these bytes, aligned or not."""
        span = np.arange(self.size(kind))
        picked = np.frombuffer(self.data, np.uint8)[position[:, None] + span]
        return np.frombuffer(picked.tobytes(), self.order + kind)


def tables(path: Path, data: bytes, header: Header) -> Iterator[Table]:
    """The table of each element in turn. Raises FormatError where the file ends too early or too late."""
    return _from_bytes(path, data, header) if header.order else _from_text(path, data, header)


def _from_text(path: Path, data: bytes, header: Header) -> Iterator[Table]:
    line = header.lines + 1
    text = table(path, plain(path, data[header.size :], line=line), line=line)
    try:
        return iter(list(_by_lines(text, header)))
    except FormatError:
        # Rows may be broken into lines anyhow; where they do not even then fit the header, the first reason stands.
        found = _loose(text, header)
        if found is None:
            raise
        return iter(found)


def _by_lines(text: Text, header: Header) -> Iterator[Table]:
    row = 0
    for element in header.elements:
        if element.rows > len(text) - row:
            raise FormatError(
                f"{text.path}: {element.rows} rows of '{named(element.name)}' are declared, but "
                f"{len(text) - row} lines are left; is the file cut short?"
            )
        yield _text_table(text.lines(row, row + element.rows), element)
        row += element.rows
    if row < len(text):
        text.refuse(row, "the file goes on after its last row; do the counts of the header fit?")


def _text_table(lines: Text, element: Element) -> Table:
    def place(row: int) -> str:
        return f"{lines.path}, line {lines.number[row]}"

    first = lines.first
    return _walked(element, Words(lines.numbers()), first, first + lines.words, place)


def _loose(text: Text, header: Header) -> list[Table] | None:
    """The tables where rows stand in lines of any length; None where they do not fill the file."""
    try:
        values = text.numbers()
    except FormatError:
        return None
    found, at = [], 0
    for element in header.elements:
        starts = _word_starts(values, at, element)
        if starts is None:
            return None
        found.append(_walked(element, Words(values), starts[:-1], starts[1:], _place_of_word(text, starts)))
        at = int(starts[-1])
    return found if at == len(values) else None


def _word_starts(values: NDArray[np.float64], at: int, element: Element) -> Ints | None:
    """The word where each row starts, and where the last one ends; None where they do not fit."""
    starts = [at]
    for _ in range(element.rows):
        for column in element.properties:
            if at >= len(values) or (column.count and not 0 <= values[at] <= len(values)):
                return None
            at += 1 + (int(values[at]) if column.count else 0)
        starts.append(at)
        if at > len(values) or (at == starts[-2] and len(starts) > len(values)):
            return None
    return np.array(starts, dtype=np.intp)


def _place_of_word(text: Text, starts: Ints) -> Place:
    def place(row: int) -> str:
        line = int(np.searchsorted(text.first, starts[row], side="right")) - 1
        return f"{text.path}, line {text.number[line]}"

    return place


def _from_bytes(path: Path, data: bytes, header: Header) -> Iterator[Table]:
    at = header.size
    for element in header.elements:
        if element.rows * element.least_size > len(data) - at:
            raise FormatError(
                f"{path}, byte {at}: {element.rows} rows of '{named(element.name)}' are declared, but "
                f"{len(data) - at} bytes are left; is the file cut short?"
            )
        found, at = _byte_table(path, data, header.order, element, at)
        yield found
    if at < len(data):
        raise FormatError(f"{path}, byte {at}: the file goes on after its last row for {len(data) - at} bytes")


def _byte_table(path: Path, data: bytes, order: str, element: Element, at: int) -> tuple[Table, int]:
    even = _even_rows(data, order, element, at)
    if even is not None:
        step = even.dtype.itemsize
        return _even_table(path, element, even, at), at + step * element.rows
    starts = _row_starts(path, data, order, element, at)

    def place(row: int) -> str:
        return f"{path}, byte {starts[row]}"

    return _walked(element, Memory(data, order), starts[:-1], starts[1:], place), int(starts[-1])


def _even_rows(data: bytes, order: str, element: Element, at: int) -> Array | None:
    """All rows as one structured array, if the lists of all rows are as long as those of the first."""
    lengths = _first_lengths(data, order, element, at) if element.rows else [0] * len(element.properties)
    if lengths is None:
        return None
    dtype = np.dtype([field for k, p in enumerate(element.properties) for field in _fields(k, p, order, lengths[k])])
    if element.rows * dtype.itemsize > len(data) - at:
        return None
    rows = np.frombuffer(data, dtype, element.rows, at)
    lists = [k for k, p in enumerate(element.properties) if p.count]
    return rows if all((rows[f"count {k}"] == lengths[k]).all() for k in lists) else None


def _fields(k: int, column: Property, order: str, length: int) -> list[Any]:
    if column.count is None:
        return [(f"value {k}", order + column.type)]
    return [(f"count {k}", order + column.count), (f"value {k}", order + column.type, (length,))]


def _first_lengths(data: bytes, order: str, element: Element, at: int) -> list[int] | None:
    lengths = []
    for column in element.properties:
        length = 1
        if column.count is not None:
            if at + column.least_size > len(data):
                return None
            length = int(np.frombuffer(data, order + column.count, 1, at)[0])
            at += column.least_size
        at += length * np.dtype(column.type).itemsize
        if length < 0 or at > len(data):
            return None
        lengths.append(length)
    return lengths


def _even_table(path: Path, element: Element, rows: Array, at: int) -> Table:
    columns, sizes = {}, {}
    for k, column in enumerate(element.properties):
        values = rows[f"value {k}"]
        columns[column.name] = values.reshape(-1)
        if column.count is not None:
            sizes[column.name] = np.full(len(rows), values.shape[1], dtype=np.intp)
    return Table(element, columns, sizes, lambda row: f"{path}, byte {at + row * rows.dtype.itemsize}")


def _row_starts(path: Path, data: bytes, order: str, element: Element, at: int) -> Ints:
    """The byte where each row starts, and where the last one ends: a walk from list to list."""
    steps = [_step(column, order) for column in element.properties]
    starts = [at]
    for row in range(element.rows):
        try:
            for step in steps:
                at = step(data, at)
        except struct.error:
            at = len(data) + 1
        if at > len(data):
            raise FormatError(
                f"{path}, byte {starts[-1]}: row {row} of '{named(element.name)}' does not end inside the file, or has "
                "a list of negative length"
            )
        starts.append(at)
    return np.array(starts, dtype=np.intp)


def _step(column: Property, order: str) -> Callable[[bytes, int], int]:
    """From the byte where a property starts to the byte where it ends."""
    width = np.dtype(column.type).itemsize
    if column.count is None:
        return lambda _, at: at + width
    size = column.least_size
    unpack = struct.Struct(order + np.dtype(column.count).char).unpack_from

    def over_list(data: bytes, at: int) -> int:
        (length,) = unpack(data, at)
        if length < 0:
            raise struct.error
        return int(at + size + width * length)

    return over_list


def _walked(element: Element, source: Source, begin: Ints, end: Ints, place: Place) -> Table:
    """The columns of rows of any length: one cursor for each row, moved from property to property."""
    columns: dict[str, Array] = {}
    sizes: dict[str, Ints] = {}
    cursor = begin
    for column in element.properties:
        length = np.ones(len(begin), dtype=np.intp)
        if column.count is not None:
            _require_room(element, cursor + source.size(column.count), end, place)
            length = sizes[column.name] = _lengths(source.at(cursor, column.count), element, place)
            cursor = cursor + source.size(column.count)
        width = source.size(column.type)
        _require_room(element, cursor + length * width, end, place)
        columns[column.name] = source.at(_positions(cursor, length, width), column.type)
        cursor = cursor + length * width
    _require_room(element, end, cursor, place)
    return Table(element, columns, sizes, place)


def _positions(cursor: Ints, length: Ints, width: int) -> Ints:
    within = ragged(np.zeros_like(length), length)
    return np.repeat(cursor, length) + width * within


def _lengths(values: Array, element: Element, place: Place) -> Ints:
    bad = np.flatnonzero((values < 0) | (values != np.floor(values)) | (values > np.iinfo(np.int32).max))
    if len(bad):
        raise FormatError(
            f"{place(int(bad[0]))}: found {values[bad[0]]:g} as the length of a list in '{named(element.name)}'"
        )
    return values.astype(np.intp)


def _require_room(element: Element, reached: Ints, end: Ints, place: Place) -> None:
    bad = np.flatnonzero(reached > end)
    if len(bad):
        raise FormatError(f"{place(int(bad[0]))}: the row of '{named(element.name)}' does not fit the header")
