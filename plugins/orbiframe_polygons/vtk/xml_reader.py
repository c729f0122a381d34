"""Reader of VTK's XML files: polygons of PolyData (.vtp) and UnstructuredGrid (.vtu)."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.parts import polyhedron_of
from orbiframe_polygons.vtk.arrays import Arrays, Described
from orbiframe_polygons.vtk.cells import Cells, parts_of
from orbiframe_polygons.xml_events import parse

Ints = NDArray[np.intp]

PARTS = ("Points", "Cells", "Verts", "Lines", "Strips", "Polys")
# Marks of cells that are hidden, or that another piece has too.
GHOSTS = "vtkGhostType"
KINDS = ("PolyData", "UnstructuredGrid")


@dataclass(slots=True)
class _Piece:
    attributes: dict[str, str]
    line: int
    arrays: dict[tuple[str, str], Described] = field(default_factory=dict)


def read(path: Path) -> Polyhedron:
    """The polygons and strips of a VTK file in XML, its pieces side by side.

    The numbers stand as text, in base64 or appended, plain or compressed with zlib, LZ4 or LZMA. Data at points and
    cells is skipped; vertices, lines and solids are passed over with a warning, as long as there are faces. Raises
    FormatError with the line for other kinds of data, for XML with entities, for cells of higher order, and where
    counts and numbers do not fit.

    Source: VTK File Formats, "XML File Formats".
    """
    content = path.read_bytes()
    tree = _Tree(path)
    end = content.find(b"<AppendedData")
    # Appended bytes are no XML.
    parse(path, content if end < 0 else content[:end], tree.start, tree.text, tree.end, whole=end < 0)
    if tree.root is None or not tree.pieces:
        raise FormatError(f"{path}: there is no Piece of a VTKFile; is it a VTK file?")
    arrays = Arrays(path, tree.root, content)
    pieces = [_cells(path, tree.root["type"], piece, arrays) for piece in tree.pieces]
    return polyhedron_of(parts_of(path, pieces))


@dataclass(slots=True)
class _Tree:
    """What is met on the way through the file; the text of arrays that are not needed is not kept."""

    path: Path
    root: dict[str, str] | None = None
    pieces: list[_Piece] = field(default_factory=list)
    _within: list[str] = field(default_factory=list)
    _array: Described | None = None

    def start(self, name: str, attributes: dict[str, str], line: int) -> None:
        outer = self._within[-1] if self._within else ""
        self._within.append(name)
        if not outer:
            if name != "VTKFile" or attributes.get("type") not in KINDS:
                self._refuse(
                    line,
                    f"found {name[:40]} of the type {attributes.get('type', '')[:40]!r}; {' or '.join(KINDS)} is read",
                )
            self.root = attributes
        elif name == "Piece":
            if "Source" in attributes:
                self._refuse(line, "the piece stands in another file, which is not opened")
            self.pieces.append(_Piece(attributes, line))
        elif name == "DataArray" and self.pieces and (outer in PARTS or attributes.get("Name") == GHOSTS):
            key = (outer, "" if outer == "Points" else attributes.get("Name", ""))
            if key in self.pieces[-1].arrays:
                self._refuse(line, f"{outer} has a second array {key[1][:40]!r}")
            self._array = self.pieces[-1].arrays[key] = Described(attributes, line)

    def text(self, characters: str) -> None:
        if self._array is not None and self._within[-1] == "DataArray":
            self._array.text.append(characters)

    def end(self, name: str) -> None:
        self._within.pop()
        if name == "DataArray":
            self._array = None

    def _refuse(self, line: int, complaint: str) -> NoReturn:
        raise FormatError(f"{self.path}, line {line}: {complaint}")


def _cells(path: Path, kind: str, piece: _Piece, arrays: Arrays) -> Cells:
    ghosts = piece.arrays.get(("CellData", GHOSTS))
    if ghosts is not None and arrays.whole(ghosts, None).any():
        raise FormatError(
            f"{path}, line {ghosts.line}: some cells are ghosts ({GHOSTS}), which is not read; drop them first"
        )
    points = _count(path, piece, "NumberOfPoints")
    cells = Cells(path, np.empty((0, 3)))
    if points:
        cells.points = arrays.floats(_array(path, piece, "Points", ""), 3 * points).reshape(-1, 3)
    if kind == "UnstructuredGrid":
        count = _count(path, piece, "NumberOfCells")
        if count:
            types = arrays.whole(_array(path, piece, "Cells", "types"), count)
            cells.add_cells(types, *_lists(path, piece, "Cells", count, arrays))
        return cells
    for name in ("Verts", "Lines"):
        count = _count(path, piece, f"NumberOf{name}")
        if count:
            cells.pass_over("vertices" if name == "Verts" else "lines", count)
    for name, add in (("Polys", cells.add_polygons), ("Strips", cells.add_strips)):
        count = _count(path, piece, f"NumberOf{name}")
        if count:
            add(*_lists(path, piece, name, count, arrays))
    return cells


def _lists(path: Path, piece: _Piece, part: str, count: int, arrays: Arrays) -> tuple[Ints, Ints]:
    """The offsets of so many lists, with the 0 before the first, and their corners."""
    ends = arrays.whole(_array(path, piece, part, "offsets"), count)
    return np.concatenate([[0], ends]), arrays.whole(_array(path, piece, part, "connectivity"), None)


def _array(path: Path, piece: _Piece, part: str, name: str) -> Described:
    if (part, name) not in piece.arrays:
        raise FormatError(f"{path}, line {piece.line}: the piece has no array {name or 'of coordinates'} in {part}")
    return piece.arrays[part, name]


def _count(path: Path, piece: _Piece, name: str) -> int:
    word = piece.attributes.get(name, "0")
    if not (word.isascii() and word.isdigit() and len(word) < 16):
        raise FormatError(f"{path}, line {piece.line}: {name} is {word[:20]!r}, but a count is required")
    return int(word)
