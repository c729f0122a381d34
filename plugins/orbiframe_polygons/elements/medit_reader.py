"""Medit reader: triangles and quadrilaterals of .mesh and .meshb, as of mmg, TetGen and FreeFem."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.elements.numbered import Numbered, tell_passed
from orbiframe_polygons.faces import whole
from orbiframe_polygons.parts import polyhedron_of
from orbiframe_polygons.text import named, plain, shown, table

WORD = re.compile(rb"(?<![\w.+-])[A-Za-z]\w*")
FACES = {"Triangles": 3, "Quadrilaterals": 4}
SOLIDS = {"Tetrahedra": 4, "Hexahedra": 8, "Hexaedra": 8, "Prisms": 6, "Pentahedra": 6, "Pyramids": 5}
# Whole numbers in a row of a table that leaves points and faces as they are.
HARMLESS = {
    **dict.fromkeys(("Corners", "Ridges", "RequiredVertices", "RequiredEdges", "RequiredTriangles"), 1),
    **dict.fromkeys(("RequiredQuadrilaterals", "OpenTriangles", "OpenQuadrilaterals", "OpenBoundary"), 1),
    **dict.fromkeys(("RequiredTetrahedra", "ParallelVertices", "ParallelEdges", "ParallelTriangles"), 1),
    **dict.fromkeys(("NormalAtVertices", "TangentAtVertices"), 2),
    **dict.fromkeys(("TangentAtEdges", "NormalAtTriangleVertices", "NormalAtQuadrilateralVertices"), 3),
    "VertexOnGeometricVertex": 2,
    "SubDomainFromMesh": 4,
    "SubDomainFromGeom": 4,
}
# Tables of coordinates: as many numbers in a row as the dimension says.
DIRECTIONS = {"Normals", "Tangents"}
# The numbers of keywords in binary files.
CODES = {
    1: "MeshVersionFormatted", 3: "Dimension", 4: "Vertices", 5: "Edges", 6: "Triangles", 7: "Quadrilaterals",
    8: "Tetrahedra", 9: "Prisms", 10: "Hexahedra", 13: "Corners", 14: "Ridges", 15: "RequiredVertices",
    16: "RequiredEdges", 17: "RequiredTriangles", 18: "RequiredQuadrilaterals", 19: "TangentAtEdges",
    20: "NormalAtVertices", 21: "NormalAtTriangleVertices", 22: "NormalAtQuadrilateralVertices", 49: "Pyramids",
    54: "End", 58: "Tangents", 59: "TangentAtVertices", 60: "Normals",
}  # fmt: skip
# Keywords with one number after them.
SINGLE = {"MeshVersionFormatted", "Dimension", "AngleOfCornerBound"}
NOT_KNOWN = "this keyword is not known, or changes what others mean; it is not read"


@dataclass(frozen=True, slots=True)
class Section:
    """A keyword with the table after it."""

    name: str
    place: str
    rows: NDArray[Any]

    def place_of(self, _: int) -> str:
        """The place of the table, for any of its numbers."""
        return self.place


def read(path: Path) -> Polyhedron:
    """The triangles and quadrilaterals of a Medit file; coordinates in the plane get the height 0.

    Edges, solids and vertices on their own are passed over with a warning, as long as there are faces; corners, ridges,
    required elements, normals and tangents are skipped. Raises FormatError for keywords that are not known, among them
    those of elements of the second order and of further files, and where the file does not end with End.

    Source: P. Frey, MEDIT, INRIA technical report 0253; L. Maréchal, libMeshb 7.
    """
    data = path.read_bytes()
    binary = data[:4] in (b"\1\0\0\0", b"\0\0\0\1")
    return _polyhedron(path, _binary(path, data) if binary else _text(path, plain(path, data)))


def _polyhedron(path: Path, sections: Iterator[Section]) -> Polyhedron:
    block, met = Numbered(path), set()
    for section in sections:
        if section.name in met:
            raise FormatError(f"{section.place}: the keyword {section.name} stands twice")
        met.add(section.name)
        if section.name == "Vertices":
            points = section.rows[:, :-1].astype(np.float64)
            block.add_nodes(np.arange(1, len(points) + 1), np.pad(points, ((0, 0), (0, 3 - points.shape[1]))))
        elif section.name in FACES:
            rows = whole(section.rows.ravel(), section.place_of).reshape(section.rows.shape)
            # The elements have no numbers; faces of different kinds must not seem to be one.
            names = np.arange(len(rows)) + (2**40 if section.name == "Quadrilaterals" else 0)
            block.add_faces(names, rows[:, :-1])
        elif section.name == "Edges" or section.name in SOLIDS:
            block.skip(section.name.lower(), len(section.rows), solid=section.name in SOLIDS)
    tell_passed(path, [block])
    return polyhedron_of([block.part()])


def _width(name: str, dimension: int) -> int | None:
    """How many numbers a row of a table has, its reference at the end included; None for no table that is known."""
    cells = {**FACES, **SOLIDS, "Edges": 2}
    if name == "Vertices":
        return dimension + 1
    if name in cells:
        return cells[name] + 1
    return dimension if name in DIRECTIONS else HARMLESS.get(name)


# ---- text ---------------------------------------------------------------------------------------------------------


def _text(path: Path, text: bytes) -> Iterator[Section]:
    text = re.sub(rb"#[^\n]*", b"", text)
    words = list(WORD.finditer(text))
    head = text[: words[0].start()] if words else text
    if not words or words[0][0].lower() != b"meshversionformatted" or head.strip():
        raise FormatError(
            f"{path}, line 1: found {shown(text[:20])}, but a Medit file starts with MeshVersionFormatted"
        )
    names = {name.lower(): name for name in (*FACES, *SOLIDS, *HARMLESS, *DIRECTIONS, *CODES.values(), "Edges")}
    dimension, line, at = 3, 1, 0
    for k, word in enumerate(words):
        line += text.count(b"\n", at, word.start())
        at = word.start()
        found = word[0].decode("ascii", errors="replace")
        name, place = names.get(found.lower(), found), f"{path}, line {line}"
        stop = words[k + 1].start() if k + 1 < len(words) else len(text)
        width = _width(name, dimension)
        if width is None and name not in SINGLE and name != "End":
            raise FormatError(f"{place}: {named(found)}: {NOT_KNOWN}")
        values = table(path, text[word.end() : stop], line=line).numbers()
        if name == "End":
            if len(values) or k + 1 < len(words):
                raise FormatError(f"{place}: the file goes on after End")
            return
        if width is None:
            dimension = _single(place, name, values, dimension)
            continue
        if not len(values) or (len(values) - 1) != values[0] * width:
            following = (text[stop:].split(None, 1) or [b"nothing"])[0]
            raise FormatError(
                f"{place}: {name} says {f'{values[0]:g}' if len(values) else 'no'} rows of {width} numbers, but "
                f"{max(0, len(values) - 1)} numbers follow, then {shown(following)}; is the file cut short?"
            )
        yield Section(name, place, values[1:].reshape(-1, width))
    raise FormatError(
        f"{path}, line {text.rstrip().count(chr(10).encode()) + 1}: the file ends without 'End'; is it cut short?"
    )


def _single(place: str, name: str, values: NDArray[np.float64], dimension: int) -> int:
    """The dimension of the file after a keyword with one number."""
    if len(values) != 1 or (name == "Dimension" and values[0] not in (2, 3)):
        raise FormatError(f"{place}: {name} is followed by {values[:3].tolist()}, but one number (2 or 3) is required")
    return int(values[0]) if name == "Dimension" else dimension


# ---- binary -------------------------------------------------------------------------------------------------------


def _binary(path: Path, data: bytes) -> Iterator[Section]:
    """The sections of a binary file: each begins with its code and the place of the next."""
    order = "<" if data[0] else ">"
    version = struct.unpack_from(f"{order}i", data, 4)[0] if len(data) >= 8 else 0
    if version not in (1, 2, 3, 4):
        raise FormatError(f"{path}, byte 4: this is Medit of version {version}, but versions 1 to 4 are read")
    real, wide, pointer = (
        ("f4" if version == 1 else "f8"),
        ("i8" if version == 4 else "i4"),
        ("q" if version > 2 else "i"),
    )
    dimension, at = 3, 8

    def number(kind: str, place: int) -> int:
        try:
            return int(struct.unpack_from(order + kind, data, place)[0])
        except struct.error:
            _cut(path, place)

    while True:
        code, following = number("i", at), number(pointer, at + 4)
        name, place = CODES.get(code, f"keyword {code}"), f"{path}, byte {at}"
        body = at + 4 + struct.calcsize(pointer)
        if name == "End":
            return
        if following and not body <= following <= len(data):
            _cut(path, at)
        if name == "Dimension":
            dimension = number("i", body)
            if dimension not in (2, 3):
                raise FormatError(f"{place}: the dimension is {dimension}, but 2 or 3 is required")
            at = following or body + 4
            continue
        width = _width(name, dimension)
        if width is None:
            raise FormatError(f"{place}: {name}: {NOT_KNOWN}")
        count = number("q" if version == 4 else "i", body)
        body += 8 if version == 4 else 4
        floats = dimension if name == "Vertices" or name in DIRECTIONS else 0
        dtype = np.dtype([("f", order + real, floats), ("i", order + wide, width - floats)])
        end = body + count * dtype.itemsize
        if count < 0 or end > len(data) or (following and following != end):
            raise FormatError(f"{place}: {count} rows of {name} do not fit into the file; is it cut short?")
        rows = np.frombuffer(data, dtype, count, body)
        yield Section(
            name, place, np.concatenate([rows["f"].astype(np.float64), rows["i"]], axis=1) if floats else rows["i"]
        )
        at = end


def _cut(path: Path, at: int) -> NoReturn:
    raise FormatError(f"{path}, byte {at}: the file ends too early; is it cut short?")
