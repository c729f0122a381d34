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
Bools = NDArray[np.bool_]

HEADER_SIZE, RECORD_SIZE = 84, 50
RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
FACET = [b"facet", b"outer", b"vertex", b"vertex", b"vertex", b"endloop", b"endfacet"]
BREAK = re.compile(rb"(?i) (?=(?:solid|facet|outer|vertex|endloop|endfacet|endsolid)(?: |$))")
FACET_WORDS = [5, 2, 4, 4, 4, 1, 1]


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
        return _corners(table(path, content))
    except FormatError:
        # Words may be broken into lines anyhow; where they do not even then make facets, the first reason stands.
        if b"endsolid" not in content.rstrip().rpartition(b"\n")[2].lower():
            raise
        loose = BREAK.sub(b"\n", b" ".join(content.split()))
        with contextlib.suppress(FormatError):
            return _corners(table(path, loose))
        raise


def _corners(text: Text) -> Floats:
    keyword = _keywords(text)
    solid, endsolid = (np.isin(keyword, _code(word)) for word in (b"solid", b"endsolid"))
    _require_solids(text, solid, endsolid)
    facets = text.only(~solid & ~endsolid)
    _require_facets(facets, keyword[~solid & ~endsolid])
    corners = facets.only(np.isin(np.arange(len(facets)) % len(FACET), (2, 3, 4)))
    return corners.without_keyword(len(b"vertex")).numbers().reshape(-1, 3, 3)


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


def _code(word: bytes) -> np.uint64:
    return np.uint64(int.from_bytes(word.ljust(8, b"\0"), "big"))


def _require_solids(text: Text, solid: Bools, endsolid: Bools) -> None:
    starts, ends = np.flatnonzero(solid), np.flatnonzero(endsolid)
    if len(starts) > len(ends):
        text.refuse(len(text) - 1, "the file ends before 'endsolid'; is it cut short?")
    # A file is solid … endsolid, solid … endsolid, and so on: each solid starts on the line after the end of the last.
    before = np.concatenate([[-1], ends])
    if len(starts) != len(ends) or (starts != before[:-1] + 1).any() or before[-1] != len(text) - 1:
        raise FormatError(f"{text.path}: something stands outside of the pairs of 'solid' and 'endsolid'")


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
