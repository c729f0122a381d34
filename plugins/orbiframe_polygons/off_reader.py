"""OFF reader: the Object File Format of Geomview, in text."""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Notice, Polyhedron
from orbiframe_polygons import off_binary
from orbiframe_polygons.faces import colours, corners, offsets_of, ragged, require_colours, require_sizes, whole
from orbiframe_polygons.text import Text, read_text, shown

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Some write the counts straight after the word.
HEADER = re.compile(rb"(ST)?(C)?(N)?(4)?(n)?OFF(?=\d|$)")
# So many bytes are looked through for the word BINARY.
START = 4096
BINARY = re.compile(rb"(?:#[^\n]*\n|\s)*+(ST)?(C)?(N)?(4)?(n)?OFF[ \t]+BINARY[^\n]*\n")


@dataclass(frozen=True, slots=True)
class Kind:
    """What the first word of the file says of each vertex."""

    texture: bool = False
    coloured: bool = False
    normals: bool = False

    @property
    def widths(self) -> tuple[int, ...]:
        """How many numbers a vertex may have: colours have three or four components."""
        plain = 3 + 3 * self.normals + 2 * self.texture
        if self.coloured:
            return (plain + 3, plain + 4)
        # Some leave the C away.
        return (plain,) if self.normals or self.texture else (plain, plain + 3, plain + 4)


@dataclass(frozen=True, slots=True)
class Parts:
    """What a polyhedron is made of."""

    points: Floats
    sizes: Ints
    tail: Ints
    face_colors: Floats | None


def read(path: Path) -> Polyhedron:
    """The polyhedron of an OFF file: polygons, normals (N), colours of vertices (C) and of faces.

    The word OFF may be missing, and the counts may follow it on its line. Vertices and faces stand one to a line, or
    anyhow where nothing but them is in the file. Texture coordinates (ST) are skipped. Colours count to 1 or to 255;
    vertices of six or seven numbers have one, with a notice, even where the header does not say so. Files with the word
    BINARY hold big-endian numbers. Raises FormatError with the line for anything that is not so, for 4OFF and nOFF
    (points of another dimension), and where the counts differ from what follows; only faces beyond the declared ones
    are left out with a warning.

    Source: http://www.geomview.org/docs/html/OFF.html
    """
    with path.open("rb") as file:
        head = BINARY.match(file.read(START))
    kind, parts = _text_parts(path) if head is None else _binary_parts(path, head)
    normals, colors = _tables(path, kind, parts.points)
    return Polyhedron.from_corners(
        parts.points[:, :3],
        offsets_of(parts.sizes),
        parts.tail,
        normals=normals,
        colors=colors,
        face_colors=parts.face_colors,
    )


def _binary_parts(path: Path, head: re.Match[bytes]) -> tuple[Kind, Parts]:
    texture, coloured, normals, four, general = (part is not None for part in head.groups())
    if four or general:
        raise FormatError(f"{path}: found {shown(head[0].strip())}, but only points of three dimensions are read")
    kind = Kind(texture, coloured, normals)
    parts = Parts(
        *off_binary.parts(path, path.read_bytes(), head.end(), kind.widths[-1] if coloured else kind.widths[0])
    )
    require_colours(parts.face_colors, path)
    return kind, parts


def _text_parts(path: Path) -> tuple[Kind, Parts]:
    kind, text = _kind(read_text(path))
    try:
        parts = _by_lines(kind, text)
    except FormatError:
        # Numbers may be broken into lines anyhow; where they do not even then fit the counts, the first reason stands.
        found = _loose_vertices(kind, text) or _loose(kind, text)
        if found is None:
            raise
        parts = found
    return kind, parts


def _kind(text: Text) -> tuple[Kind, Text]:
    """The kind of the file, and its text after the word that says so."""
    if not len(text):
        raise FormatError(f"{text.path}: the file holds no words; an OFF file starts with OFF and its counts")
    words = text.line(0).split()
    found = HEADER.match(words[0])
    if found is None and not words[0].isdigit():
        text.refuse(0, f"found {shown(words[0])}, but an OFF file starts with OFF (or COFF, NOFF, CNOFF, STOFF)")
    if found is None:
        return Kind(), text
    texture, coloured, normals, four, general = (part is not None for part in found.groups())
    if four or general:
        text.refuse(
            0, f"found {shown(words[0])}, but only points of three dimensions are read, not of another dimension"
        )
    if len(text) == 1 and words == [found[0]]:
        text.refuse(0, "the file ends after its header; the counts of vertices, faces and edges are required")
    kind = Kind(texture, coloured, normals)
    return kind, text.without_first_word() if words[0] == found[0] else text.without_start(found.end())


# ---- one vertex or face to a line ---------------------------------------------------------------------------------


def _by_lines(kind: Kind, text: Text) -> Parts:
    vertices, faces = _counts(text)
    end = 1 + vertices + faces
    if len(text) < end:
        raise FormatError(
            f"{text.path}, line {text.number[0]}: {vertices} vertices and {faces} faces are declared, but "
            f"{len(text) - 1} lines follow; is the file cut short?"
        )
    points = _vertices(text.lines(1, 1 + vertices), kind)
    parts = Parts(points, *_faces(text.lines(1 + vertices, end), vertices))
    if len(text) > end:
        _require_faces_alone(text.lines(end, len(text)), vertices, faces)
    return parts


def _counts(text: Text) -> tuple[int, int]:
    words = text.line(0).split()
    if len(words) not in (2, 3) or not all(word.isdigit() and len(word) < 19 for word in words):
        text.refuse(0, f"found {shown(b' '.join(words))}, but the counts of vertices, faces and edges are required")
    return int(words[0]), int(words[1])


def _require_faces_alone(text: Text, vertices: int, faces: int) -> None:
    """Faces beyond the declared ones are left out with a warning, as other readers do; anything else is refused."""
    try:
        sizes, _, _ = _faces(text, vertices)
    except FormatError:
        text.refuse(0, "the file goes on after its last face; do the counts fit the lines?")
    found = "1 face line" if len(sizes) == 1 else f"{len(sizes)} face lines"
    place = f"{text.path}, line {text.number[0]}"
    warnings.warn(f"{place}: {found} more than the {faces} declared; left out", stacklevel=2)


def _vertices(text: Text, kind: Kind) -> Floats:
    width = int(text.words[0]) if len(text) and text.words[0] in kind.widths else kind.widths[0]
    wrong = text.words != width
    if wrong.any():
        required = " or ".join(map(str, kind.widths))
        row = int(wrong.argmax())
        text.refuse(row, f"found {text.words[row]} numbers, but a vertex has {required}")
    return text.numbers().reshape(-1, width)


def _tables(path: Path, kind: Kind, points: Floats) -> tuple[Floats | None, Floats | None]:
    """Normals and colours of the vertices."""
    normals = points[:, 3:6] if kind.normals else None
    start = 6 if kind.normals else 3
    unsaid = not (kind.coloured or kind.normals or kind.texture) and points.shape[1] > 3
    coloured = kind.coloured or unsaid
    colors = colours(points[:, start : points.shape[1] - 2 * kind.texture]) if coloured else None
    if unsaid:
        more = points.shape[1] - 3
        warnings.warn(f"{path.name}: vertices have {more} more numbers, read as colours", Notice, stacklevel=2)
    require_colours(colors, path)
    return normals, colors


def _faces(text: Text, vertex_count: int) -> tuple[Ints, Ints, Floats | None]:
    """The sizes, corners and colours of faces."""

    def place(face: int) -> str:
        return f"{text.path}, line {text.number[face]}"

    values, first, words = text.numbers(), text.first, text.words
    sizes = whole(values[first], place)
    require_sizes(sizes, place)
    _require_words(text, sizes)
    tail = corners(values[ragged(first + 1, sizes)], sizes, vertex_count, place)
    return sizes, tail, _face_colours(text.path, values, first + 1 + sizes, words - 1 - sizes)


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


# ---- numbers broken into lines anyhow -----------------------------------------------------------------------------


def _loose_vertices(kind: Kind, text: Text) -> Parts | None:
    """Faces one to a line after vertices in lines of any length; None where that does not fit the counts."""
    try:
        vertices, faces = _counts(text)
    except FormatError:
        return None
    ends = np.cumsum(text.words[1:])
    for width in kind.widths:
        row = 2 + int(np.searchsorted(ends, vertices * width))
        if len(text) - row == faces > 0 and ends[row - 2] == vertices * width:
            points = text.lines(1, row).numbers().reshape(-1, width)
            return Parts(points, *_faces(text.lines(row, len(text)), vertices))
    return None


def _loose(kind: Kind, text: Text) -> Parts | None:
    """Counts, vertices and faces without colours in lines of any length; None where that does not fit the counts."""
    try:
        values = text.numbers()
    except FormatError:
        return None
    if len(values) < 3 or (values[:3] != np.floor(np.abs(values[:3]))).any() or (values[:3] > len(values)).any():
        return None
    vertices, count = int(values[0]), int(values[1])
    for width in kind.widths:
        start = 3 + vertices * width
        firsts = _face_starts(values, start, count)
        if firsts is not None:
            return _loose_parts(text, values[3:start].reshape(-1, width), values, firsts)
    return None


def _face_starts(values: Floats, at: int, count: int) -> Ints | None:
    """Where the count of each face stands, if these faces fill the numbers from `at` on."""
    starts = []
    for _ in range(count):
        if at >= len(values) or not 3 <= values[at] <= len(values) or values[at] % 1:
            return None
        starts.append(at)
        at += 1 + int(values[at])
    return np.array(starts, dtype=np.intp) if at == len(values) else None


def _loose_parts(text: Text, points: Floats, values: Floats, starts: Ints) -> Parts:
    def place(face: int) -> str:
        row = int(np.searchsorted(text.first, starts[face], side="right")) - 1
        return f"{text.path}, line {text.number[row]}"

    sizes = values[starts].astype(np.intp)
    return Parts(points, sizes, corners(values[ragged(starts + 1, sizes)], sizes, len(points), place), None)
