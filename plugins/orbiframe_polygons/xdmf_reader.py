"""XDMF reader: polygons in the XML format of the eXtensible Data Model, with the numbers inside."""

from __future__ import annotations

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

SIZES = {"triangle": 3, "quadrilateral": 4}
# Codes of cells in a mixed topology; a polygon says how many corners it has.
POLYGON, CODES = 3, {4: 3, 5: 4}


def read(path: Path) -> Polyhedron:
    """The polygons of the one grid of an XDMF file whose numbers stand in the file itself.

    Read are triangles, quadrilaterals, polygons and a mixture of them; attributes are skipped. Raises FormatError for
    numbers in other files (HDF5 or binary), which are never opened, for references and includes, for cells of other
    kinds, and with the line for numbers that do not fit.

    Source: XDMF Model and Format, version 3, https://www.xdmf.org/index.php/XDMF_Model_and_Format
    """
    grid = _Grid(path)
    parse(path, path.read_bytes(), grid.start, grid.text, grid.end)
    vertices = grid.item("Geometry").numbers()
    width = {"XYZ": 3, "XY": 2}.get(grid.attributes["Geometry"].get("GeometryType", "XYZ").upper())
    if width is None or len(vertices) % width:
        raise FormatError(f"{path}: the geometry has {len(vertices)} numbers, which are no rows of XYZ or XY")
    points = np.pad(vertices.reshape(-1, width), ((0, 0), (0, 3 - width)))
    sizes, tail = _faces(grid)
    return Polyhedron.from_corners(points, offsets_of(sizes), corners(tail, sizes, len(points), lambda _: str(path)))


@dataclass(slots=True)
class _Grid:
    """What is met on the way through the file."""

    path: Path
    attributes: dict[str, dict[str, str]] = field(default_factory=dict)
    _items: dict[str, tuple[int, list[str]]] = field(default_factory=dict)
    _within: list[str] = field(default_factory=list)

    def start(self, name: str, attributes: dict[str, str], line: int) -> None:
        outer = self._within[-1] if self._within else ""
        self._within.append(name)
        if name == "include" or (name == "DataItem" and attributes.get("Format", "XML").upper() != "XML"):
            self._refuse(line, "the numbers stand in another file, which is never opened; save them as XML, inline")
        if "Reference" in attributes:
            self._refuse(line, "references to other parts are not read")
        if name in ("Geometry", "Topology"):
            if name in self.attributes:
                self._refuse(line, f"there is a second {name}; one grid is read")
            self.attributes[name] = attributes
        if name == "DataItem" and outer in ("Geometry", "Topology"):
            if outer in self._items:
                self._refuse(line, f"the {outer} has a second item; one is read")
            self._items[outer] = (line, [])

    def text(self, characters: str) -> None:
        if self._within[-1] == "DataItem" and self._within[-2:-1] and self._within[-2] in self._items:
            self._items[self._within[-2]][1].append(characters)

    def end(self, _: str) -> None:
        self._within.pop()

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
    kind = attributes.get("TopologyType", attributes.get("Type", "")).lower()
    if kind == "mixed":
        return _mixed(text, numbers)
    per_face = attributes.get("NodesPerElement", "")
    size = SIZES.get(kind, int(per_face) if kind == "polygon" and per_face.isdigit() and len(per_face) < 10 else 0)
    if size < 3 or len(numbers) % size:
        raise FormatError(
            f"{text.path}: the topology is {shown(kind.encode())} with {len(numbers)} numbers; triangles, "
            "quadrilaterals and polygons are read"
        )
    return np.full(len(numbers) // size, size, dtype=np.intp), numbers


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
