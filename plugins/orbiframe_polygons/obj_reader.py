"""OBJ reader: polygons in the text format of Wavefront."""

from __future__ import annotations

import re
import warnings
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.faces import colours, corners, offsets_of, require_colours, require_sizes, whole
from orbiframe_polygons.obj_tags import marks
from orbiframe_polygons.text import Text, read_text, shown

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Statements without polygons: names, materials, drawing, points and lines.
IGNORED = frozenset(
    b"vt vp o g s mg mtllib usemtl usemap maplib l p bevel c_interp d_interp lod shadow_obj trace_obj".split()
)
CORNER = re.compile(rb"[+-]?\d++(/[+-]?\d*+(/([+-]?\d++)?)?)?")
BLANK, SLASH = 32, 47


def read(path: Path) -> Polyhedron:
    """The polyhedron of an OBJ file: polygons, normals, and colours after the coordinates (`v x y z r g b`).

    Negative indices count back from where they stand. Names and groups are skipped, and no material file is opened.
    Texture coordinates are kept where every corner has some. Tags `t crease 2/1/0 v w sharpness`, as OpenSubdiv has
    them, mark edges as sharp. Normals are kept where all corners of each vertex have the same normal; where the file
    has none, corners may name them anyhow. Raises FormatError with the line for anything else that the format does not
    know, free-form curves included.

    Source: Wavefront, Advanced Visualizer manual, appendix B1: Object files.
    """
    text = read_text(path, continued=True)
    vertex, texture, normal, face, tag = (_starting(text, word) for word in (b"v", b"vt", b"vn", b"f", b"t"))
    _require_known(text, vertex | normal | face | tag)
    vertices, colors = _vertices(text.only(vertex))
    places, directions = _textures(text.only(texture)), _normals(text.only(normal))
    faces = text.only(face).without_keyword(1)
    if not len(faces):
        raise FormatError(f"{path}: the file holds no faces (lines that start with f)")
    seen = [np.cumsum(kind, dtype=np.intp)[face] for kind in (vertex, texture, normal)]
    counts = len(vertices), len(places), len(directions)
    points, place, pointers = _corners(faces, *zip(seen, counts, strict=True))
    normals = _per_vertex(points, pointers, directions, len(vertices))
    mesh = Polyhedron.from_corners(vertices, offsets_of(faces.words), points, normals=normals, colors=colors)
    mesh = mesh if place is None else replace(mesh, corner_uv=places[place])
    return replace(mesh, marked=marks(text.only(tag), len(vertices))) if tag.any() else mesh


def _starting(text: Text, word: bytes) -> Bools:
    """Which lines start with this word."""
    data = np.append(text.data, np.zeros(len(word) + 1, dtype=np.uint8))
    fits = data[text.begin + len(word)] <= BLANK
    for k, code in enumerate(word):
        fits &= data[text.begin + k] == code
    return fits


def _require_known(text: Text, known: Bools) -> None:
    for row in np.flatnonzero(~known).tolist():
        word = text.line(row).split(None, 1)[0]
        if word not in IGNORED:
            text.refuse(row, f"found {shown(word)}; v, vt, vn, f, groups and materials are read, nothing else")


def _vertices(text: Text) -> tuple[Floats, Floats | None]:
    text = text.without_keyword(1)
    wrong = np.flatnonzero(~np.isin(text.words, (3, 4, 6, 7)))
    if len(wrong):
        text.refuse(int(wrong[0]), f"found {text.words[wrong[0]]} numbers, but a vertex has 3, or 6 with a colour")
    values = text.numbers()
    vertices = values[text.first[:, None] + np.arange(3)]
    coloured = text.words >= 6
    if not coloured.all():
        if coloured.any():
            warnings.warn(f"{text.path}: only some vertices have colours; all are left out", stacklevel=2)
        return vertices, None
    colors = colours(values[(text.first + text.words)[:, None] - np.arange(3, 0, -1)]) if len(text) else None
    require_colours(colors, text.path)
    return vertices, colors


def _normals(text: Text) -> Floats:
    text = text.without_keyword(2)
    wrong = np.flatnonzero(text.words != 3)
    if len(wrong):
        text.refuse(int(wrong[0]), f"found {text.words[wrong[0]]} numbers, but a normal has 3")
    return text.numbers().reshape(-1, 3)


def _textures(text: Text) -> Floats:
    """The first two numbers of each; a third one is a depth, and a second one that lacks is 0."""
    text = text.without_keyword(2)
    wrong = np.flatnonzero(~np.isin(text.words, (1, 2, 3)))
    if len(wrong):
        text.refuse(int(wrong[0]), f"found {text.words[wrong[0]]} numbers, but a texture coordinate has 1 to 3")
    values = np.append(text.numbers(), 0.0)
    second = np.where(text.words > 1, text.first + 1, len(values) - 1)
    return np.stack([values[text.first], values[second]], axis=1)


def _corners(
    faces: Text, vertices: tuple[Ints, int], textures: tuple[Ints, int], normals: tuple[Ints, int]
) -> tuple[Ints, Ints | None, Ints | None]:
    """The vertex of each corner and, where every corner has one, its texture coordinates and its normal.

    vertices, textures, normals: how many of them stand before each face, and in the whole file.
    """

    def place(face: int) -> str:
        return f"{faces.path}, line {faces.number[face]}"

    sizes = faces.words
    require_sizes(sizes, place)
    values, slot = _numbers_and_slots(faces)
    points = corners(_from_zero(faces, values[slot == 0], vertices[0]), sizes, vertices[1], place)

    def of_all(number: int, known: tuple[Ints, int], noun: str) -> Ints | None:
        if not known[1] or (slot == number).sum() != len(points):
            return None
        return corners(_from_zero(faces, values[slot == number], known[0]), sizes, known[1], place, noun=noun)

    return points, of_all(1, textures, "texture coordinate"), of_all(2, normals, "normal")


def _numbers_and_slots(faces: Text) -> tuple[Floats, Ints]:
    """All numbers of all corners, and how many slashes precede each in its corner (v/vt/vn)."""
    slash = faces.data == SLASH
    if not slash.any():
        values = faces.numbers()
        return values, np.zeros(len(values), dtype=np.intp)
    number = _starts((faces.data > BLANK) & ~slash)
    word = _starts(faces.data > BLANK)
    at, words_at = np.flatnonzero(number), np.flatnonzero(word)
    slashes = np.cumsum(slash, dtype=np.int32)
    slot = slashes[at] - slashes[words_at][np.cumsum(word, dtype=np.int32)[at] - 1]
    data = np.where(slash, np.uint8(BLANK), faces.data)
    loose = replace(faces, data=data, words=np.diff(np.searchsorted(at, faces.begin), append=len(at)))
    values = loose.numbers()
    if (slot > 2).any() or (slot == 0).sum() != len(words_at) or slash[words_at].any():
        _blame(faces)
    return values, slot.astype(np.intp)


def _starts(inside: Bools) -> Bools:
    """Where runs of marked bytes start."""
    starts = inside.copy()
    starts[1:] &= ~inside[:-1]
    return starts


def _blame(faces: Text) -> NoReturn:
    for row in range(len(faces)):
        for word in faces.line(row).split():
            if not CORNER.fullmatch(word):
                faces.refuse(row, f"found {shown(word)}, but a corner is written v, v/vt, v//vn or v/vt/vn")
    raise FormatError(f"{faces.path}: the corners of the faces cannot be read")


def _from_zero(faces: Text, values: Floats, seen: Ints) -> Ints:
    """Indices that count from 0, where those of the file count from 1, or from -1 backwards."""

    def row(corner: int) -> int:
        return int(np.searchsorted(np.cumsum(faces.words), corner, side="right"))

    index = whole(values, lambda corner: f"{faces.path}, line {faces.number[row(corner)]}")
    if not index.all():
        faces.refuse(row(int((index == 0).argmax())), "found the index 0, but OBJ counts from 1")
    if index.min(initial=1) > 0:
        return index - 1
    return np.where(index < 0, np.repeat(seen, faces.words) + index, index - 1)


def _per_vertex(points: Ints, pointers: Ints | None, directions: Floats, count: int) -> Floats | None:
    """The normals of the vertices, where all corners of each vertex agree."""
    if pointers is None:
        return None
    normals = np.zeros((count, 3))
    normals[points] = directions[pointers]
    return normals if (normals[points] == directions[pointers]).all() else None
