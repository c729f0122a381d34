"""XDMF reader: polygons in the XML format of the eXtensible Data Model, with the numbers inside."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.faces import corners, offsets_of, ragged, require_sizes, whole
from orbiframe_polygons.text import Text, shown, table
from orbiframe_polygons.xml_events import parse

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

WIDTHS = {"XYZ": 3, "XY": 2}
SIZES = {"triangle": 3, "quadrilateral": 4}
# Codes of cells in a mixed topology; a polygon says how many corners it has.
POLYGON, CODES = 3, {4: 3, 5: 4}


def read(path: Path) -> Polyhedron:
    """The polygons of the one grid of an XDMF file whose numbers stand in the file itself.

    Read are triangles, quadrilaterals, polygons and a mixture of them, counted from BaseOffset; attributes are skipped.
    Raises FormatError for numbers in other files (HDF5 or binary), which are never opened, for references and includes,
    for items, grids and geometries of other kinds, for an Order, and where Dimensions or NumberOfElements differ from
    the numbers.

    Source: XDMF Model and Format, version 3, https://www.xdmf.org/index.php/XDMF_Model_and_Format
    """
    grid = _Grid(path)
    parse(path, path.read_bytes(), grid.start, grid.text, grid.end)
    points = _points(grid)
    sizes, tail = _faces(grid)
    return Polyhedron.from_corners(points, offsets_of(sizes), corners(tail, sizes, len(points), lambda _: str(path)))


def _points(grid: _Grid) -> Floats:
    values = grid.item("Geometry").numbers()
    kind = grid.kind("Geometry", "XYZ")
    width = WIDTHS.get(kind.upper())
    if width is None or len(values) % width:
        raise FormatError(
            f"{grid.path}: the geometry is {shown(kind.encode())} with {len(values)} numbers; XYZ or XY is read"
        )
    grid.require_dimensions("Geometry", len(values), width)
    return np.pad(values.reshape(-1, width), ((0, 0), (0, 3 - width)))


@dataclass(slots=True)
class _Grid:
    """What is met on the way through the file."""

    path: Path
    attributes: dict[str, dict[str, str]] = field(default_factory=dict)
    _items: dict[str, tuple[int, list[str]]] = field(default_factory=dict)
    _dimensions: dict[str, str] = field(default_factory=dict)
    _within: list[str] = field(default_factory=list)

    def start(self, name: str, attributes: dict[str, str], line: int) -> None:
        outer = self._within[-1] if self._within else ""
        self._within.append(name)
        if name == "include" or (name == "DataItem" and attributes.get("Format", "XML").upper() != "XML"):
            self._refuse(line, "the numbers stand in another file, which is never opened; save them as XML, inline")
        if "Reference" in attributes:
            self._refuse(line, "references to other parts are not read")
        if name == "Grid" and attributes.get("GridType", "Uniform").lower() == "subset":
            self._refuse(line, "a grid of the type 'SubSet' is not read")
        if name == "DataItem":
            self._require_plain(attributes, outer, line)
        if name in ("Geometry", "Topology"):
            if name in self.attributes:
                self._refuse(line, f"there is a second {name}; one grid is read")
            self.attributes[name] = attributes
        if name == "DataItem" and outer in ("Geometry", "Topology"):
            if outer in self._items:
                self._refuse(line, f"the {outer} has a second item; one is read")
            self._items[outer] = (line, [])
            self._dimensions[outer] = attributes.get("Dimensions", "")

    def _require_plain(self, attributes: dict[str, str], outer: str, line: int) -> None:
        """Raise FormatError for an item that is made of others, or whose numbers are packed."""
        kind = attributes.get("ItemType", "Uniform")
        if kind.lower() != "uniform" or outer == "DataItem":
            self._refuse(
                line, f"items of the type {kind[:20]!r}, and items inside others, are not read; save plain ones"
            )
        for name in ("Function", "Seek", "Compression"):
            if attributes.get(name, "0").lower() not in ("0", "raw"):
                self._refuse(line, f"an item with {name}={attributes[name][:20]!r} is not read; save plain ones")

    def text(self, characters: str) -> None:
        if self._within[-1] == "DataItem" and self._within[-2:-1] and self._within[-2] in self._items:
            self._items[self._within[-2]][1].append(characters)

    def end(self, _: str) -> None:
        self._within.pop()

    def kind(self, name: str, default: str) -> str:
        """The type of the geometry or the topology."""
        attributes = self.attributes.get(name, {})
        return attributes.get(f"{name}Type", attributes.get("Type", default))

    def require_dimensions(self, name: str, count: int, width: int) -> None:
        """Raise FormatError where the Dimensions of the item of a part differ from its numbers."""
        words = self._dimensions[name].split()
        if not words:
            return
        sizes = [int(word) if word.isascii() and word.isdigit() and len(word) < 19 else -1 for word in words]
        if min(sizes) < 0 or math.prod(sizes) != count or (len(sizes) > 1 and width and sizes[-1] != width):
            line = self._items[name][0]
            self._refuse(line, f"the Dimensions are {self._dimensions[name][:40]!r}, but {count} numbers follow")

    def item(self, name: str) -> Text:
        """The numbers of the geometry or the topology."""
        if name not in self._items:
            raise FormatError(f"{self.path}: there is no {name} with numbers in it; is this an XDMF file?")
        line, parts = self._items[name]
        return table(self.path, "".join(parts).encode(), line=line)

    def _refuse(self, line: int, complaint: str) -> None:
        raise FormatError(f"{self.path}, line {line}: {complaint}")


def _faces(grid: _Grid) -> tuple[Ints, Ints]:
    attributes = grid.attributes.get("Topology", {})
    text = grid.item("Topology")
    numbers = whole(text.numbers(), lambda word: f"{text.path}, line {_line(text, word)}")
    base = _count(grid, attributes.get("BaseOffset", "0"), "BaseOffset")
    if "Order" in attributes:
        raise FormatError(f"{grid.path}: the topology has an Order of its corners, which is not read")
    if grid.kind("Topology", "").lower() == "mixed":
        sizes, tail = _mixed(text, numbers)
        grid.require_dimensions("Topology", len(numbers), 0)
    else:
        size = _size(grid, attributes, len(numbers))
        sizes, tail = np.full(len(numbers) // size, size, dtype=np.intp), numbers
        grid.require_dimensions("Topology", len(numbers), size)
    _require_count(grid, attributes, len(sizes))
    return sizes, tail - base


def _size(grid: _Grid, attributes: dict[str, str], count: int) -> int:
    """How many corners each face has."""
    kind = grid.kind("Topology", "").lower()
    per_face = _count(grid, attributes.get("NodesPerElement", "0"), "NodesPerElement")
    size = SIZES.get(kind, per_face if kind == "polygon" else 0)
    if size < 3 or count % size or per_face not in (0, size):
        raise FormatError(
            f"{grid.path}: the topology is {shown(kind.encode())} with {count} numbers; triangles, "
            "quadrilaterals and polygons are read"
        )
    return size


def _require_count(grid: _Grid, attributes: dict[str, str], found: int) -> None:
    for name in ("NumberOfElements", "Dimensions"):
        words = attributes.get(name, "").split()
        if words and math.prod(_count(grid, word, name) for word in words) != found:
            said = attributes[name][:40]
            raise FormatError(f"{grid.path}: the topology has {name}={said!r}, but there are {found} faces")


def _count(grid: _Grid, word: str, name: str) -> int:
    if not (word.isascii() and word.isdigit() and len(word) < 19):
        raise FormatError(f"{grid.path}: the topology has {name}={word[:20]!r}, but a whole number is required")
    return int(word)


def _mixed(text: Text, numbers: Ints) -> tuple[Ints, Ints]:
    first, sizes = [], []
    codes, at = numbers.tolist(), 0
    while at < len(codes):
        named = codes[at] == POLYGON
        size = codes[at + 1] if named and at + 1 < len(codes) else CODES.get(codes[at], 0)
        start = at + 1 + named
        if size <= 0 or start + size > len(codes):
            line = _line(text, at)
            raise FormatError(
                f"{text.path}, line {line}: found the cell code {codes[at]}; polygons (3 n), triangles (4) "
                "and quadrilaterals (5) with all their corners are read"
            )
        first.append(start)
        sizes.append(size)
        at = start + size
    lengths = np.array(sizes, dtype=np.intp)
    require_sizes(lengths, lambda face: f"{text.path}, line {_line(text, first[face])}")
    return lengths, numbers[ragged(np.array(first, dtype=np.intp), lengths)]


def _line(text: Text, word: int) -> int:
    return int(text.number[np.searchsorted(text.first, word, side="right") - 1])
