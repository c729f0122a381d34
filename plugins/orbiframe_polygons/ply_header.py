"""PLY header: the elements of the file and the types of their properties."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

import numpy as np

from orbiframe import FormatError
from orbiframe_polygons.text import named, shown

ORDERS = {b"ascii": "", b"binary_little_endian": "<", b"binary_big_endian": ">"}
KINDS = ("i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8")
OLD_NAMES = b"char uchar short ushort int uint float double".split()
NEW_NAMES = b"int8 uint8 int16 uint16 int32 uint32 float32 float64".split()
TYPES = dict(zip([*OLD_NAMES, *NEW_NAMES], KINDS * 2, strict=True))
FIRST_LINE = re.compile(rb"(?:\xef\xbb\xbf)?ply[ \t]*(\r\n|\n|\r)")


@dataclass(frozen=True, slots=True)
class Property:
    """One column of an element: a number, or a list of numbers where `count` is the type of its length."""

    name: str
    type: str
    count: str | None = None

    @property
    def least_size(self) -> int:
        """Bytes that the property takes at least, in a binary file."""
        return np.dtype(self.count or self.type).itemsize


@dataclass(frozen=True, slots=True)
class Element:
    """One table of the file: how many rows, and their properties in order."""

    name: str
    rows: int
    properties: list[Property] = field(default_factory=list)

    @property
    def least_size(self) -> int:
        """Bytes that a row takes at least, in a binary file."""
        return sum(p.least_size for p in self.properties)


@dataclass(frozen=True, slots=True)
class Header:
    """order: "<" or ">" for the order of bytes, "" for text; size: bytes of the header; lines: how many it has."""

    order: str
    elements: list[Element]
    size: int
    lines: int


def parse(path: Path, data: bytes) -> Header:
    """The header of a PLY file. Raises FormatError with the line for anything that it cannot hold."""
    first = FIRST_LINE.match(data)
    if first is None:
        raise FormatError(f"{path}, line 1: found {shown(data[:16])}, but a PLY file starts with a line 'ply'")
    newline = first[1]
    end = re.compile(rb"[\r\n]end_header[ \t]*" + re.escape(newline)).search(data, first.end() - 1)
    if end is None:
        raise FormatError(f"{path}: the header has no line 'end_header'; is the file cut short?")
    lines = data[first.end() : end.start() + 1].split(newline)[:-1]
    order, elements = _Parser(path).run(lines)
    return Header(order, elements, end.end(), len(lines) + 2)


class _Parser:
    """Walks over the lines of a header."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._line = 1
        self._order: str | None = None
        self._elements: list[Element] = []
        self._names: set[str] = set()
        self._properties: set[str] = set()

    def run(self, lines: list[bytes]) -> tuple[str, list[Element]]:
        for line in lines:
            self._line += 1
            self._statement(line.split())
        self._line += 1
        if self._order is None:
            self._refuse("the header has no line 'format'")
        for element in self._elements:
            if element.rows and not element.properties:
                self._refuse(f"the element '{named(element.name)}' has {element.rows} rows but no property")
        return self._order, self._elements

    def _statement(self, words: list[bytes]) -> None:
        match words:
            case [] | [b"comment" | b"obj_info", *_]:
                pass
            case [b"format", order, b"1.0"] if order in ORDERS and self._order is None:
                self._order = ORDERS[order]
            case [b"element", name, count] if count.isdigit() and len(count) < 19:
                self._add_element(Element(self._name(name), int(count)))
            case [b"property", b"list", count, kind, name] if self._integer(count) and kind in TYPES:
                self._add_property(Property(self._name(name), TYPES[kind], TYPES[count]))
            case [b"property", kind, name] if kind in TYPES:
                self._add_property(Property(self._name(name), TYPES[kind]))
            case _:
                self._refuse(f"found {shown(b' '.join(words))}, which is no statement of a PLY header")

    def _add_element(self, element: Element) -> None:
        if element.name in self._names:
            self._refuse(f"the element '{named(element.name)}' is declared twice")
        self._names.add(element.name)
        self._elements.append(element)
        self._properties.clear()

    def _add_property(self, added: Property) -> None:
        if not self._elements:
            self._refuse("a property stands before the first element")
        element = self._elements[-1]
        if added.name in self._properties:
            self._refuse(f"the element '{named(element.name)}' has the property '{named(added.name)}' twice")
        self._properties.add(added.name)
        element.properties.append(added)

    def _integer(self, kind: bytes) -> bool:
        return TYPES.get(kind, "f")[0] in "iu"

    def _name(self, word: bytes) -> str:
        return word.decode("utf-8", errors="replace")

    def _refuse(self, complaint: str) -> NoReturn:
        raise FormatError(f"{self._path}, line {self._line}: {complaint}")
