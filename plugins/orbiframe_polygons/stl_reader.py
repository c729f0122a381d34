"""STL reader: triangles of stereolithography, as text or binary; equal corners become one vertex."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.faces import require_finite
from orbiframe_polygons.text import Text, plain, shown, table
from orbiframe_polygons.weld import welded

Floats = NDArray[np.floating]
Codes = NDArray[np.uint64]
Ints = NDArray[np.intp]

HEADER_SIZE, RECORD_SIZE = 84, 50
RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
FACET = [b"facet", b"outer", b"vertex", b"vertex", b"vertex", b"endloop", b"endfacet"]
BREAK = re.compile(rb"(?i) (?=(?:solid|facet|outer|vertex|endloop|endfacet|endsolid)(?: |$))")
SPACE = re.compile(rb"\s+")
FACET_WORDS = [5, 2, 4, 4, 4, 1, 1]


def _code(word: bytes) -> np.uint64:
    return np.uint64(int.from_bytes(word.ljust(8, b"\0"), "big"))


SOLID, ENDSOLID = _code(b"solid"), _code(b"endsolid")
# Bytes of text that are looked at together.
BLOCK = 2**24


def read(path: Path) -> Polyhedron:
    """The polyhedron of an STL file, whose triangles share nothing: corners with equal coordinates become one vertex.

    The file is binary where its size is 84 + 50 n for the count n in it, else text (of one or more solids). Normals and
    attributes are skipped. Raises FormatError with the line or byte where the file is neither, or cut short.

    Source: 3D Systems, StereoLithography Interface Specification, 1988.
    """
    data = path.read_bytes()
    corners = _binary(path, data) if _is_binary(data) else _ascii(path, data)
    if not len(corners):
        raise FormatError(f"{path}: the file holds no triangles")
    vertices, tail = welded(corners)
    return Polyhedron.from_faces(vertices, tail.reshape(-1, 3))


def _is_binary(data: bytes) -> bool:
    if len(data) < HEADER_SIZE:
        return False
    return len(data) == HEADER_SIZE + RECORD_SIZE * int.from_bytes(data[80:84], "little")


def _binary(path: Path, data: bytes) -> Floats:
    corners: Floats = np.frombuffer(data, RECORD, offset=HEADER_SIZE)["corners"]
    require_finite(corners.reshape(-1, 9), lambda k: f"{path}, byte {HEADER_SIZE + RECORD_SIZE * k}")
    return corners


def _ascii(path: Path, data: bytes) -> Floats:
    _require_text(path, data)
    content = plain(path, data)
    try:
        return _by_lines(path, content)
    except FormatError:
        # Words may be broken into lines anyhow; where they do not even then make facets, the first reason stands.
        if b"endsolid" not in content.rstrip().rpartition(b"\n")[2].lower():
            raise
        loose = BREAK.sub(b"\n", SPACE.sub(b" ", content))
        with contextlib.suppress(FormatError):
            return _by_lines(path, loose)
        raise


def _by_lines(path: Path, content: bytes) -> Floats:
    """The corners of all facets, (n, 3, 3), from blocks of the text, so that its lines take little memory."""
    corners, at, line, inside = [], 0, 1, 0
    while at < len(content):
        end = _block_end(content, at)
        text = table(path, content[at:end], line=line)
        keyword = _keywords(text)
        mark = np.isin(keyword, SOLID).astype(np.intp) - np.isin(keyword, ENDSOLID)
        inside = _require_solids(text, mark, inside)
        if inside and end == len(content):
            text.refuse(len(text) - 1, "the file ends before 'endsolid'; is it cut short?")
        facets = text.only(mark == 0)
        _require_facets(facets, keyword[mark == 0])
        vertices = facets.only(np.isin(np.arange(len(facets)) % len(FACET), (2, 3, 4)))
        corners.append(vertices.without_keyword(len(b"vertex")).numbers().reshape(-1, 3, 3))
        line += content.count(b"\n", at, end)
        at = end
    return np.concatenate(corners)


def _block_end(content: bytes, at: int) -> int:
    """The end of a line that ends a facet, or of the text."""
    if len(content) - at <= BLOCK:
        return len(content)
    facet = max(content.rfind(word, at, at + BLOCK) for word in (b"endfacet", b"ENDFACET"))
    newline = content.find(b"\n", facet) if facet > at else -1
    return newline + 1 or len(content)


def _require_text(path: Path, data: bytes) -> None:
    if data[:512].lstrip(b"\xef\xbb\xbf \t\r\n")[:5].lower() == b"solid" and b"\0" not in data:
        return
    if len(data) < HEADER_SIZE:
        raise FormatError(f"{path}: found {shown(data[:16])}; an STL file starts with 'solid' or has 84 bytes at least")
    count = int.from_bytes(data[80:84], "little")
    raise FormatError(
        f"{path}, byte 80: the count {count} of triangles asks for {HEADER_SIZE + RECORD_SIZE * count} bytes, but the "
        f"file has {len(data)}; it is cut short, goes on after its end, or is no STL file"
    )


def _keywords(text: Text) -> Codes:
    """The first word of each line, in lower case, as a number; 0 for words of more than eight letters."""
    data = np.append(text.data, np.zeros(9, dtype=np.uint8))
    inside = np.ones(len(text), dtype=np.bool_)
    code = np.zeros(len(text), dtype=np.uint64)
    for k in range(9):
        letter = data[text.begin + k]
        inside &= letter > 32
        if k < 8:
            code = code << np.uint64(8) | np.where(inside, letter | 32, 0).astype(np.uint64)
    code[inside] = 0
    return code


def _require_solids(text: Text, mark: Ints, inside: int) -> int:
    """Whether the text ends inside a solid. Raises FormatError where something stands outside of solids, or one in one.

    mark: 1 for lines of 'solid', -1 for lines of 'endsolid'; inside: 1 where the text starts inside a solid.
    """
    depth = inside + np.cumsum(mark)
    wrong = (depth != 1) & ((mark == 0) | (depth != 0))
    if wrong.any():
        text.refuse(int(wrong.argmax()), "this stands outside of the pairs of 'solid' and 'endsolid'")
    return int(depth[-1]) if len(depth) else inside


def _require_facets(facets: Text, keyword: Codes) -> None:
    wanted = np.resize(np.array([_code(word) for word in FACET]), len(facets))
    words = np.resize(FACET_WORDS, len(facets))
    wrong = np.flatnonzero((keyword != wanted) | (facets.words != words))
    if len(wrong):
        row = int(wrong[0])
        required = FACET[row % 7].decode()
        facets.refuse(row, f"found {shown(facets.line(row))}, but '{required}' with {words[row] - 1} words is required")
    if len(facets) % 7:
        facets.refuse(len(facets) - 1, "the last facet is not complete; is the file cut short?")
