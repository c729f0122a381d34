"""OFF reader: the Object File Format of Geomview, in text."""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.faces import colours, corners, offsets_of, ragged, require_colours, require_sizes, whole
from orbiframe_polygons.text import Text, read_text, shown

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

HEADER = re.compile(rb"(ST)?(C)?(N)?(4)?(n)?OFF")


@dataclass(frozen=True, slots=True)
class Header:
    """What the first lines of the file say; row: the first line of the table after them."""

    texture: bool
    coloured: bool
    normals: bool
    vertices: int
    faces: int
    row: int

    @property
    def widths(self) -> tuple[int, ...]:
        """How many numbers a vertex line may hold: colours have three or four components."""
        plain = 3 + 3 * self.normals + 2 * self.texture
        return (plain + 3, plain + 4) if self.coloured else (plain,)


def read(path: Path) -> Polyhedron:
    """The polyhedron of an OFF file: polygons, normals (N), colours of vertices (C) and of faces.

    The word OFF may be missing, and the counts may follow it on its line. Texture coordinates (ST) are skipped. Colours
    count to 1 or to 255. Raises FormatError with the line for anything that is not so, for 4OFF and nOFF (points of
    another dimension), for binary files, and where the counts differ from what follows; only faces beyond the declared
    ones are left out with a warning.

    Source: http://www.geomview.org/docs/html/OFF.html
    """
    text = read_text(path)
    header = _header(text)
    _require_counts(text, header)
    split = header.row + header.vertices
    vertices, normals, colors = _vertices(text.lines(header.row, split), header)
    offsets, tail, face_colors = _faces(text.lines(split, split + header.faces), header.vertices)
    return Polyhedron.from_corners(vertices, offsets, tail, normals=normals, colors=colors, face_colors=face_colors)


def _header(text: Text) -> Header:
    if not len(text):
        raise FormatError(f"{text.path}: the file holds no words; an OFF file starts with OFF and its counts")
    words = text.line(0).split()
    found = HEADER.fullmatch(words[0])
    if found is None and not words[0].isdigit():
        text.refuse(0, f"found {shown(words[0])}, but an OFF file starts with OFF (or COFF, NOFF, CNOFF, STOFF)")
    if found is None:
        return _counted(text, (False, False, False), words, 0)
    texture, coloured, normals, four, general = (part is not None for part in found.groups())
    if four or general:
        text.refuse(0, f"{shown(words[0])} holds points of another dimension; three coordinates a vertex are required")
    if words[1:2] == [b"BINARY"]:
        text.refuse(0, "binary OFF is not read; save the mesh as text or as PLY")
    if len(words) == 1 and len(text) == 1:
        text.refuse(0, "the file ends after its header; the counts of vertices, faces and edges are required")
    flags = (texture, coloured, normals)
    return _counted(text, flags, words[1:], 0) if len(words) > 1 else _counted(text, flags, text.line(1).split(), 1)


def _counted(text: Text, flags: tuple[bool, bool, bool], words: list[bytes], row: int) -> Header:
    if len(words) not in (2, 3) or not all(word.isdigit() and len(word) < 19 for word in words):
        text.refuse(row, f"found {shown(b' '.join(words))}, but the counts of vertices, faces and edges are required")
    return Header(*flags, int(words[0]), int(words[1]), row + 1)


def _require_counts(text: Text, header: Header) -> None:
    present = len(text) - header.row
    declared = header.vertices + header.faces
    if present < declared:
        raise FormatError(
            f"{text.path}, line {text.number[header.row - 1]}: {header.vertices} vertices and {header.faces} faces are "
            f"declared, but {present} lines follow; is the file cut short?"
        )
    if present > declared:
        _require_faces_alone(text, header, header.row + declared)


def _require_faces_alone(text: Text, header: Header, row: int) -> None:
    """Faces beyond the declared ones are left out with a warning, as other readers do; anything else is refused."""
    try:
        offsets, _, _ = _faces(text.lines(row, len(text)), header.vertices)
    except FormatError:
        text.refuse(row, "the file goes on after its last face; do the counts fit the lines?")
    place = f"{text.path}, line {text.number[row]}"
    count = len(offsets) - 1
    found = "1 face line" if count == 1 else f"{count} face lines"
    warnings.warn(f"{place}: {found} more than the {header.faces} declared; left out", stacklevel=2)


def _vertices(text: Text, header: Header) -> tuple[Floats, Floats | None, Floats | None]:
    width = int(text.words[0]) if len(text) and text.words[0] in header.widths else header.widths[0]
    wrong = np.flatnonzero(text.words != width)
    if len(wrong):
        required = " or ".join(map(str, header.widths))
        text.refuse(int(wrong[0]), f"found {text.words[wrong[0]]} numbers, but a vertex has {required}")
    table = text.numbers().reshape(-1, width)
    normals = table[:, 3:6] if header.normals else None
    start = 6 if header.normals else 3
    colors = colours(table[:, start : width - 2 * header.texture]) if header.coloured else None
    require_colours(colors, text.path)
    return table[:, :3], normals, colors


def _faces(text: Text, vertex_count: int) -> tuple[Ints, Ints, Floats | None]:
    def place(face: int) -> str:
        return f"{text.path}, line {text.number[face]}"

    values, first, words = text.numbers(), text.first, text.words
    sizes = whole(values[first], place)
    require_sizes(sizes, place)
    _require_words(text, sizes)
    tail = corners(values[ragged(first + 1, sizes)], sizes, vertex_count, place)
    return offsets_of(sizes), tail, _face_colours(text.path, values, first + 1 + sizes, words - 1 - sizes)


def _require_words(text: Text, sizes: Ints) -> None:
    extra = text.words - 1 - sizes
    wrong = np.flatnonzero(~np.isin(extra, (0, 1, 3, 4)))
    if len(wrong):
        row = int(wrong[0])
        found = f"found {text.words[row] - 1} numbers after the count {sizes[row]}"
        text.refuse(row, f"{found}; {sizes[row]} corners and a colour of none, 1, 3 or 4 numbers are required")


def _face_colours(path: Path, values: Floats, first: Ints, sizes: Ints) -> Floats | None:
    # One number is an index into a table of colours that is not in the file.
    if not (sizes >= 3).any():
        return None
    if len(np.unique(sizes)) > 1:
        warnings.warn(f"{path}: not all faces have a colour of one kind; their colours are left out", stacklevel=2)
        return None
    table = colours(values[ragged(first, sizes)].reshape(len(sizes), -1))
    require_colours(table, path)
    return table
