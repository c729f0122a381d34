"""Tecplot reader: one zone of triangles or quadrilaterals of a data file in text."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.faces import corners, offsets_of
from orbiframe_polygons.text import Text, named, read_text, shown

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

TOKEN = re.compile(r'"[^"]*"|\([^()]*(?:\([^()]*\)[^()]*)*\)|=|[^\s,="()]+|\S')
NUMBER = re.compile(rb"[+-]?[\d.]")
AXES = {"X": 0, "Y": 1, "Z": 2, "COORDINATEX": 0, "COORDINATEY": 1, "COORDINATEZ": 2}
KINDS = {"TRIANGLE": 3, "QUADRILATERAL": 4, "FETRIANGLE": 3, "FEQUADRILATERAL": 4}
PACKINGS = {"FEPOINT": "POINT", "FEBLOCK": "BLOCK"}
# Words of a zone that leave the mesh as it is.
HARMLESS = {"T", "DT", "C", "STRANDID", "SOLUTIONTIME", "PARENTZONE", "AUXDATA", "VARLOCATION"}
KNOWN = {"N", "NODES", "E", "ELEMENTS", "F", "ET", "DATAPACKING", "ZONETYPE"}
# Records beside zones.
RECORDS = {"GEOMETRY", "TEXT", "CUSTOMLABELS"}
SKIPPED = ("DATASETAUXDATA", "VARAUXDATA", "FILETYPE")


@dataclass(slots=True)
class _Head:
    """What the head of the file says."""

    variables: list[str] = field(default_factory=list)
    zone: dict[str, str] = field(default_factory=dict)


def read(path: Path) -> Polyhedron:
    """The triangles or quadrilaterals of the one zone of a Tecplot file in text, with its numbers by point or by block.

    Names count in letters of any size; further variables are skipped; a quadrilateral that repeats a corner beside it
    is a triangle. Raises FormatError with the line for ordered zones, solids, a second zone, and by name for what is
    shared between zones or not known.

    Source: Tecplot 360 Data Format Guide, "ASCII Data".
    """
    text = read_text(path)
    row, head = _head(text)
    axes, size, nodes, elements = _meant(text, head)
    values = text.lines(row, len(text)).numbers()
    widths = _widths(text, head, nodes, elements)
    asked = int(widths.sum()) + size * elements
    if len(values) != asked:
        raise FormatError(
            f"{path}: the zone asks for {asked} numbers, but {len(values)} follow; is it cut short, or two zones?"
        )
    points = _points(head, values, widths, axes, nodes)
    tail = corners(values[len(values) - size * elements :] - 1, np.full(elements, size), nodes, lambda _: str(path))
    sizes, tail = _without_repeats(tail.reshape(-1, size))
    return Polyhedron.from_corners(points, offsets_of(sizes), tail)


def _head(text: Text) -> tuple[int, _Head]:
    """The first line with numbers, and what stands before it."""
    lines, row = [], 0
    while row < len(text) and not NUMBER.match(text.line(row)):
        lines.append((row, text.line(row).decode("utf-8", errors="replace")))
        row += 1
    head, words = _Head(), [(at, word) for at, line in lines for word in TOKEN.findall(line) if word != ","]
    place, k = "", 0
    while k < len(words):
        at, word = words[k]
        name = word.upper()
        value = words[k + 2][1] if k + 2 < len(words) and words[k + 1][1] == "=" else None
        if name in RECORDS and value is None:
            text.refuse(at, f"found {shown(word.encode())}, which is not read; save the zone alone")
        if name in ("TITLE", *SKIPPED) and (value is not None or name in SKIPPED):
            place = ""
            k += 3 if value is not None else 4
        elif name == "VARIABLES" and value is not None:
            place, k = "VARIABLES", k + 2
        elif name == "ZONE":
            if head.zone:
                text.refuse(at, "there is a second zone; one zone is read")
            place, k = "ZONE", k + 1
        elif place == "VARIABLES" and value is None:
            head.variables.append(word.strip('"').strip())
            k += 1
        elif place == "ZONE" and value is not None:
            _set(text, at, head, name, value)
            k += 3
        elif place == "ZONE" and name == "AUXDATA":
            k += 4
        else:
            text.refuse(at, f"found {shown(word.encode())}, which is not known here; it is not read")
    return row, head


def _set(text: Text, at: int, head: _Head, name: str, value: str) -> None:
    if name in head.zone:
        text.refuse(at, f"{named(name)} stands twice in the zone")
    if name not in HARMLESS | KNOWN:
        text.refuse(at, f"{named(name)} is not known, or changes what others mean; it is not read")
    head.zone[name] = value.strip('"').upper()


def _meant(text: Text, head: _Head) -> tuple[list[int], int, int, int]:
    """The columns of X, Y and Z, the corners of a face, and the counts of nodes and elements."""
    names = [name.upper().split("[")[0].split("(")[0].strip().replace(" ", "") for name in head.variables]
    found = {AXES[name]: k for k, name in enumerate(names) if name in AXES}
    if not {0, 1} <= found.keys() or len(found) != sum(name in AXES for name in names):
        listed = ", ".join(map(named, head.variables))[:80]
        raise FormatError(f"{text.path}: the variables are {listed or 'missing'}, but X, Y and Z are required")
    zone = head.zone
    kind = zone.get("ZONETYPE", zone.get("ET", "ordered"))
    if kind not in KINDS:
        raise FormatError(f"{text.path}: the zone is of the kind {kind[:30]!r}; triangles and quadrilaterals are read")
    nodes, elements = (_count(text, zone, names) for names in (("N", "NODES"), ("E", "ELEMENTS")))
    return [found[axis] for axis in sorted(found)], KINDS[kind], nodes, elements


def _count(text: Text, zone: dict[str, str], names: tuple[str, ...]) -> int:
    words = [zone[name] for name in names if name in zone]
    if len(words) != 1 or not (words[0].isascii() and words[0].isdigit() and len(words[0]) < 16):
        raise FormatError(f"{text.path}: the zone needs one whole number {' or '.join(names)}, but has {words[:2]}")
    return int(words[0])


def _packing(text: Text, head: _Head) -> str:
    given = head.zone.get("DATAPACKING", PACKINGS.get(head.zone.get("F", "FEPOINT"), head.zone.get("F", "")))
    if given not in ("POINT", "BLOCK"):
        raise FormatError(f"{text.path}: the numbers are packed as {given[:30]!r}, but POINT or BLOCK is required")
    return given


def _widths(text: Text, head: _Head, nodes: int, elements: int) -> Ints:
    """How many numbers each variable has: one for each node, or for each element where it lies there."""
    widths = np.full(len(head.variables), nodes, dtype=object)
    location = head.zone.get("VARLOCATION", "")
    if _packing(text, head) == "BLOCK":
        for listed, kind in re.findall(r"\[([0-9,\s-]+)\]\s*\)?\s*=\s*\(?(\w+)", location):
            for first, last in re.findall(r"([0-9]{1,6})\s*(?:-\s*([0-9]{1,6}))?", listed):
                if kind == "CELLCENTERED":
                    widths[int(first) - 1 : int(last or first)] = elements
    elif "CELLCENTERED" in location:
        raise FormatError(f"{text.path}: variables in the cells stand in blocks only (DATAPACKING=BLOCK)")
    return widths


def _points(head: _Head, values: Floats, widths: Ints, axes: list[int], nodes: int) -> Floats:
    if len(set(widths[axes])) > 1 or widths[axes[0]] != nodes:
        raise FormatError("the coordinates must be given at the nodes")
    count = int(widths.sum())
    if "BLOCK" in (head.zone.get("DATAPACKING"), PACKINGS.get(head.zone.get("F", ""))):
        starts = np.concatenate([[0], np.cumsum(widths.astype(np.intp))])
        table = np.stack([values[starts[k] : starts[k] + nodes] for k in axes], axis=1)
    else:
        table = values[:count].reshape(nodes, -1)[:, axes]
    return np.pad(table, ((0, 0), (0, 3 - len(axes))))


def _without_repeats(faces: Ints) -> tuple[Ints, Ints]:
    """The sizes and corners of faces where a corner of a quadrilateral that repeats its neighbour counts once."""
    kept = faces != np.roll(faces, -1, axis=1) if faces.shape[1] == 4 else np.ones(faces.shape, dtype=np.bool_)
    whole = kept.sum(axis=1) < 3
    kept[whole] = True
    return kept.sum(axis=1).astype(np.intp), faces[kept]
