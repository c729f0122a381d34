"""Reader of legacy VTK: polygons of POLYDATA and UNSTRUCTURED_GRID, as text or binary, versions 1 to 5.1."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.faces import offsets_of, whole
from orbiframe_polygons.parts import polyhedron_of
from orbiframe_polygons.text import shown, table, with_line_feeds
from orbiframe_polygons.vtk.cells import Cells, parts_of

Array = NDArray[Any]
Ints = NDArray[np.intp]

HEAD = re.compile(rb"#[ \t]*vtk[ \t]+datafile[ \t]+version[ \t]+(\d)\.(\d+)[^\n]*\n[^\n]*\n", re.IGNORECASE)
KEYWORD = re.compile(rb"\n[ \t]*(?=[A-Za-z_])")
# What the data types are in binary files.
TYPES = {
    "char": "i1", "unsigned_char": "u1", "short": "i2", "unsigned_short": "u2", "int": "i4", "unsigned_int": "u4",
    "long": "i8", "unsigned_long": "u8", "float": "f4", "double": "f8", "vtkidtype": "i4", "vtktypeint64": "i8",
    "vtktypeuint64": "u8", "vtktypeint32": "i4", "vtktypeuint32": "u4",
}  # fmt: skip
DATASETS = ("POLYDATA", "UNSTRUCTURED_GRID")
POLYDATA = {"VERTICES": "vertices", "LINES": "lines", "POLYGONS": "", "TRIANGLE_STRIPS": ""}
# From here on there is data at points and cells, which is not needed.
GHOSTS = b"vtkGhostType"
DATA = ("POINT_DATA", "CELL_DATA")


def read(path: Path) -> Polyhedron:
    """The polygons and strips of a legacy VTK file.

    Data at points and cells is skipped, text and colours included; vertices, lines and solids are passed over with a
    warning, as long as there are faces. Raises FormatError with the line or byte for other data sets, for cells of
    higher order, and where counts and numbers do not fit.

    Source: VTK File Formats, "Simple Legacy Formats", and the change of cells in version 5.1.
    """
    source = _Source(path)
    kind = source.words(2)
    if kind[0] != "DATASET" or kind[1] not in DATASETS:
        source.refuse(f"found {shown(' '.join(kind).encode())}; the data sets {' and '.join(DATASETS)} are read")
    cells = _cells(source, kind[1])
    return polyhedron_of(parts_of(path, [cells]))


class _Source:
    """The bytes of the file, and the place where it is read."""

    def __init__(self, path: Path) -> None:
        self.path = path
        data = path.read_bytes()
        # The line ends of a binary file are left as they are.
        head = HEAD.match(data.replace(b"\r\n", b"\n") if b"\r" in data[:300] and not _binary(data) else data)
        if head is None:
            raise FormatError(f"{path}, line 1: found {shown(data[:20])}, but '# vtk DataFile Version' is required")
        self.version = (int(head[1]), int(head[2]))
        self.binary = _binary(data)
        self.data = data if self.binary else with_line_feeds(path, data)
        self.at = HEAD.match(self.data).end()  # type: ignore[union-attr]
        mode = self.words(1)[0]
        if mode not in ("ASCII", "BINARY"):
            self.refuse(f"found {shown(mode.encode())}, but ASCII or BINARY is required")

    def line(self) -> str | None:
        """The next line that is not blank, None at the end of the file."""
        while self.at < len(self.data):
            end = self.data.find(b"\n", self.at)
            end = len(self.data) if end < 0 else end
            line, self.at = self.data[self.at : end].strip(), end + 1
            if line:
                return line[:1000].decode("utf-8", errors="replace")
        self.at = len(self.data)
        return None

    def words(self, count: int) -> list[str]:
        """The words of the next line in capitals, so many at least."""
        line = self.line()
        words = [] if line is None else line.split()
        if len(words) < count:
            self.refuse(f"found {shown((line or '').encode())}; is the file cut short?")
        return [word.upper() for word in words]

    def count(self, word: str) -> int:
        """A count."""
        if not (word.isascii() and word.isdigit() and len(word) < 16):
            self.refuse(f"found {shown(word.encode())}, but a count is required")
        return int(word)

    def numbers(self, count: int, kind: str) -> Array:
        """So many numbers of a type."""
        if kind.lower() not in TYPES:
            self.refuse(f"found the type {shown(kind.encode())}, which is not known")
        return self._bytes(count, TYPES[kind.lower()]) if self.binary else self._text(count)

    def whole(self, count: int, kind: str) -> Ints:
        """So many whole numbers."""
        place = self.at
        return whole(self.numbers(count, kind), lambda _: f"{self.path}, {self._place(place)}")

    def _bytes(self, count: int, kind: str) -> Array:
        dtype = np.dtype(f">{kind}")
        if count * dtype.itemsize > len(self.data) - self.at:
            self.refuse(f"{count} numbers of {dtype.itemsize} bytes are declared, but the file ends; is it cut short?")
        found = np.frombuffer(self.data, dtype, count, self.at)
        self.at += count * dtype.itemsize
        return found

    def _text(self, count: int) -> Array:
        found = KEYWORD.search(self.data, max(0, self.at - 1))
        end = len(self.data) if found is None else found.end()
        part = self.data[self.at : end]
        values = table(self.path, part, line=self.data.count(b"\n", 0, self.at) + 1).numbers()
        if len(values) != count:
            self.refuse(f"{count} numbers are declared, but {len(values)} follow; is the file cut short?")
        self.at = end
        return values

    def skip_words_or_strings(self, count: int, kind: str) -> None:
        """Pass over an array of a field: strings stand one to a line."""
        if kind.lower() not in ("string", "utf8_string", "bit", "variant"):
            self.numbers(count, kind)
        elif self.binary:
            self.refuse(f"the field of the type {shown(kind.encode())} before the mesh is not read; save it without")
        else:
            for _ in range(count):
                if self.line() is None:
                    self.refuse("the file ends inside a field; is it cut short?")

    def skip_to_blank(self) -> None:
        """Pass over lines to the next blank one."""
        end = re.compile(rb"\n[ \t\r]*\n").search(self.data, max(0, self.at - 1))
        self.at = len(self.data) if end is None else end.end()

    def refuse(self, complaint: str) -> NoReturn:
        """Raise FormatError with the line of a text, the byte of a binary file."""
        raise FormatError(f"{self.path}, {self._place(self.at)}: {complaint}")

    def _place(self, at: int) -> str:
        return f"byte {at}" if self.binary else f"line {self.data.count(chr(10).encode(), 0, max(0, at - 1)) + 1}"


def _binary(data: bytes) -> bool:
    lines = data[:2000].split(b"\n", 3)
    return len(lines) > 2 and lines[2].strip().upper() == b"BINARY"


def _cells(source: _Source, dataset: str) -> Cells:
    """The points and cells of the data set."""
    cells = Cells(source.path, np.empty((0, 3)))
    listed: tuple[Ints, Ints] | None = None
    types: Ints | None = None
    met: set[str] = set()
    while (line := source.line()) is not None:
        words = line.split()
        name = words[0].upper()
        if name in DATA:
            if GHOSTS in source.data[source.at :]:
                source.refuse(
                    "some cells or points may be ghosts (vtkGhostType), which is not read; drop the array first"
                )
            break
        if name in met:
            source.refuse(f"{name} stands twice")
        met.add(name)
        if name == "POINTS" and len(words) == 3:
            count = source.count(words[1])
            cells.points = source.numbers(3 * count, words[2]).astype(np.float64).reshape(-1, 3)
            if not np.isfinite(cells.points).all():
                source.refuse("a coordinate is not finite")
        elif name in POLYDATA and dataset == "POLYDATA" and len(words) == 3:
            _add(cells, name, *_lists(source, words))
        elif name == "CELLS" and dataset == "UNSTRUCTURED_GRID" and len(words) == 3:
            listed = _lists(source, words)
        elif name == "CELL_TYPES" and dataset == "UNSTRUCTURED_GRID" and len(words) == 2:
            types = source.whole(source.count(words[1]), "int")
        elif name == "METADATA":
            met.discard(name)
            source.skip_to_blank()
        elif name == "FIELD" and len(words) == 3:
            _skip_field(source, source.count(words[2]))
        else:
            source.refuse(f"found {shown(line.encode())}, which is not known here; it is not read")
    if dataset == "UNSTRUCTURED_GRID":
        if listed is None or types is None:
            source.refuse("the data set has no CELLS or no CELL_TYPES; is the file cut short?")
        cells.add_cells(types, *listed)
    return cells


def _add(cells: Cells, name: str, offsets: Ints, connectivity: Ints) -> None:
    if name == "POLYGONS":
        cells.add_polygons(offsets, connectivity)
    elif name == "TRIANGLE_STRIPS":
        cells.add_strips(offsets, connectivity)
    else:
        cells.pass_over(POLYDATA[name], len(offsets) - 1)


def _lists(source: _Source, words: list[str]) -> tuple[Ints, Ints]:
    """The offsets and corners of cells: apart since version 5.0, one after the other before it."""
    first, second = source.count(words[1]), source.count(words[2])
    if source.version >= (5, 0):
        if not first:
            return np.zeros(1, dtype=np.intp), np.empty(0, dtype=np.intp)
        offsets = source.whole(first, _array_type(source, "OFFSETS"))
        return offsets, source.whole(second, _array_type(source, "CONNECTIVITY"))
    return _unpacked(source, source.whole(second, "int"), first)


def _array_type(source: _Source, name: str) -> str:
    words = source.words(2)
    if words[0] != name:
        source.refuse(f"found {shown(words[0].encode())}, but {name} is required")
    return words[1]


def _unpacked(source: _Source, packed: Ints, count: int) -> tuple[Ints, Ints]:
    """Offsets and corners of lists, each after its length."""
    if count and len(packed) % count == 0 and (packed[:: len(packed) // count] == len(packed) // count - 1).all():
        rows = packed.reshape(count, -1)
        return np.arange(count + 1) * (rows.shape[1] - 1), np.ascontiguousarray(rows[:, 1:]).ravel()
    lengths, listed, at = [], packed.tolist(), 0
    for _ in range(count):
        if at >= len(listed) or not 0 <= listed[at] <= len(listed):
            source.refuse(f"the lists of {count} cells do not fit their {len(listed)} numbers")
        lengths.append(listed[at])
        at += 1 + listed[at]
    if at != len(listed):
        source.refuse(f"the lists of {count} cells do not fit their {len(listed)} numbers")
    sizes = np.array(lengths, dtype=np.intp)
    keep = np.ones(len(packed), dtype=np.bool_)
    keep[offsets_of(sizes + 1)[:-1]] = False
    return offsets_of(sizes), packed[keep]


def _skip_field(source: _Source, arrays: int) -> None:
    for _ in range(min(arrays, len(source.data))):
        line = source.line()
        while line is not None and line.upper() == "METADATA":
            source.skip_to_blank()
            line = source.line()
        words = (line or "").split()
        if len(words) != 4:
            source.refuse(
                f"found {shown((line or '').encode())}, but the name, counts and type of an array are required"
            )
        source.skip_words_or_strings(source.count(words[1]) * source.count(words[2]), words[3])
