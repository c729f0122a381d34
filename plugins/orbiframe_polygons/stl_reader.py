"""STL reader: triangles of stereolithography, as text or binary; equal corners become one vertex."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.faces import require_finite
from orbiframe_polygons.text import MARK, Text, shown, table, with_line_feeds
from orbiframe_polygons.weld import welded

Floats = NDArray[np.floating]
Codes = NDArray[np.uint64]
Ints = NDArray[np.intp]

HEADER_SIZE, RECORD_SIZE = 84, 50
RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
FACET = [b"facet", b"outer", b"vertex", b"vertex", b"vertex", b"endloop", b"endfacet"]
BREAK = re.compile(rb"(?i) (?=(?:solid|facet|outer|vertex|endloop|endfacet|endsolid)(?: |$))")
# Some write the words of an end apart.
APART = re.compile(rb"(?im)^([ \t]*)end[ \t]+(?=(?:solid|facet|loop)\b)")
SPACE = re.compile(rb"\s+")
FACET_WORDS = [5, 2, 4, 4, 4, 1, 1]


def _code(word: bytes) -> np.uint64:
    return np.uint64(int.from_bytes(word.ljust(8, b"\0"), "big"))


SOLID, ENDSOLID = _code(b"solid"), _code(b"endsolid")
# Bytes at an end that tell whether a file is text, and bytes of text that are looked at together.
SAMPLE, BLOCK = 2**16, 2**24


def read(path: Path) -> Polyhedron:
    """The polyhedron of an STL file, whose triangles share nothing: corners with equal coordinates become one vertex.

    The file is binary where its size is 84 + 50 n for the count n in it, else text (of one or more solids). Normals and
    attributes are skipped. Raises FormatError with the line or byte where the file is neither, or cut short.

    Source: 3D Systems, StereoLithography Interface Specification, 1988.
    """
    corners = _binary(path) if _is_binary(path) else _ascii(path)
    if not len(corners):
        raise FormatError(f"{path}: the file holds no triangles")
    vertices, tail = welded(corners)
    del corners
    return Polyhedron.from_faces(vertices, tail.reshape(-1, 3))


def _is_binary(path: Path) -> bool:
    start = _start(path, HEADER_SIZE)
    size = HEADER_SIZE + RECORD_SIZE * int.from_bytes(start[80:84], "little")
    return len(start) == HEADER_SIZE and path.stat().st_size == size


def _start(path: Path, size: int) -> bytes:
    with path.open("rb") as file:
        return file.read(size)


def _binary(path: Path) -> Floats:
    corners: Floats = np.frombuffer(path.read_bytes(), RECORD, offset=HEADER_SIZE)["corners"]
    require_finite(corners.reshape(-1, 9), lambda k: f"{path}, byte {HEADER_SIZE + RECORD_SIZE * k}")
    return corners


def _ascii(path: Path) -> Floats:
    _require_text(path)
    try:
        return _corners(path, _pieces(path))
    except FormatError:
        # Words may be broken into lines anyhow; where they do not even then make facets, the first reason stands.
        if not _ends_in_order(path):
            raise
        with contextlib.suppress(FormatError):
            return _corners(path, _pieces(path, _facet_lines))
        raise


def _ends_in_order(path: Path) -> bool:
    """Whether the end of a solid is in the last line, so that nothing comes after it."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - SAMPLE))
        end = file.read().replace(b"\r", b"\n").rstrip()
    return b"endsolid" in _joined(end.rpartition(b"\n")[2]).lower()


def _require_text(path: Path) -> None:
    start = _start(path, SAMPLE)
    if start[:512].lstrip(b"\xef\xbb\xbf \t\r\n")[:5].lower() == b"solid" and b"\0" not in start:
        return
    if len(start) < HEADER_SIZE:
        raise FormatError(
            f"{path}: found {shown(start[:16])}; an STL file starts with 'solid' or has 84 bytes at least"
        )
    count = int.from_bytes(start[80:84], "little")
    raise FormatError(
        f"{path}, byte 80: the count {count} of triangles asks for {HEADER_SIZE + RECORD_SIZE * count} bytes, but the "
        f"file has {path.stat().st_size}; it is cut short, goes on after its end, or is no STL file"
    )


# ---- text ---------------------------------------------------------------------------------------------------------


def _pieces(path: Path, shaped: Callable[[bytes], bytes] = bytes) -> Iterator[tuple[bytes, bool]]:
    """The text in pieces of whole facets, so that its lines take little memory, and whether a piece is the last.

    shaped: gives a piece its lines.
    """
    with path.open("rb") as file:
        rest, line = file.read(len(MARK)).removeprefix(MARK), 1
        while more := file.read(BLOCK):
            while more.endswith(b"\r") and (after := file.read(1)):  # a LF after it belongs to a CR
                more += after
            rest = shaped(_joined(rest + with_line_feeds(path, more, line=line + rest.count(b"\n"))))
            end = _facets_end(rest)
            yield rest[:end], False
            line += rest.count(b"\n", 0, end)
            rest = rest[end:]
        yield rest, True


def _joined(content: bytes) -> bytes:
    """The text with `end solid` in one word."""
    apart = any(word in content for word in (b"end ", b"END ", b"End ", b"end\t", b"END\t"))
    return APART.sub(rb"\1end", content) if apart else content


def _facets_end(content: bytes) -> int:
    """The end of the last line that ends a facet."""
    facet = max(content.rfind(word) for word in (b"endfacet", b"ENDFACET"))
    return content.find(b"\n", facet) + 1 if facet >= 0 else 0


def _facet_lines(content: bytes) -> bytes:
    """The words of a text in the lines that facets have."""
    return BREAK.sub(b"\n", SPACE.sub(b" ", content))


def _corners(path: Path, pieces: Iterator[tuple[bytes, bool]]) -> Floats:
    """The corners of all facets, (n, 3, 3), from pieces of text that say whether they are the last."""
    corners: list[Floats] = [np.empty((0, 3, 3))]
    line, inside = 1, 0
    for piece, last in pieces:
        text = table(path, piece, line=line)
        keyword = _keywords(text)
        mark = np.isin(keyword, SOLID).astype(np.intp) - np.isin(keyword, ENDSOLID)
        inside = _require_solids(text, mark, inside)
        end = line + piece.count(b"\n")
        if last and inside:
            raise FormatError(f"{path}, line {end}: the file ends before 'endsolid'; is it cut short?")
        corners.append(_facets(text.only(mark == 0), keyword[mark == 0]))
        line = end
    return np.concatenate(corners)


def _facets(lines: Text, keyword: Codes) -> Floats:
    _require_facets(lines, keyword)
    vertices = lines.only(np.isin(np.arange(len(lines)) % len(FACET), (2, 3, 4)))
    return vertices.without_keyword(len(b"vertex")).numbers().reshape(-1, 3, 3)


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
