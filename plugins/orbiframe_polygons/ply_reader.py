"""PLY reader: the Polygon File Format of Stanford, as text or binary in either order of bytes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe.meshes import MarkedEdges
from orbiframe_polygons.faces import corners, offsets_of, require_colours, require_finite, require_sizes, whole
from orbiframe_polygons.ply_body import Table, tables
from orbiframe_polygons.ply_header import parse
from orbiframe_polygons.strips import RESTART, triangles_of_strips
from orbiframe_polygons.text import named

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

STRIPS = "tristrips"
SHARPNESS = ("crease", "sharpness", "sharp")


def read(path: Path) -> Polyhedron:
    """The polyhedron of a PLY file: polygons, normals, colours of vertices and faces, edges marked as sharp.

    An element 'edge' with the properties vertex1, vertex2 and crease, sharpness or sharp marks edges where the number
    is above 0. Strips of triangles are read, each ended by -1 or by the end of its list. Other elements and properties
    are skipped. Raises FormatError with the line or byte where header and body do not fit, where an index is out of
    range and where a coordinate is not finite.

    Source: G. Turk, The PLY Polygon File Format, 1994.
    """
    data = path.read_bytes()
    header = parse(path, data)
    found = {table.element.name: table for table in tables(path, data, header)}
    if "vertex" not in found or not found.keys() & {"face", STRIPS}:
        missing = "vertex" if "vertex" not in found else "face"
        raise FormatError(f"{path}: the header declares no element '{missing}'; polygons need both vertex and face")
    vertex, face = found["vertex"], found.get("face")
    vertices = _columns(path, vertex, ("x", "y", "z"))
    if vertices is None:
        raise FormatError(f"{path}: the element 'vertex' lacks one of the properties x, y and z")
    offsets, tail = _all_faces(path, found, len(vertices))
    mesh = Polyhedron.from_corners(
        vertices,
        offsets,
        tail,
        normals=_columns(path, vertex, ("nx", "ny", "nz")),
        colors=_colours(path, vertex),
        face_colors=None if face is None or STRIPS in found else _colours(path, face),
    )
    return replace(mesh, marked=_marks(path, found["edge"], len(vertices))) if "edge" in found else mesh


def _marks(path: Path, edge: Table, vertex_count: int) -> MarkedEdges | None:
    """The edges that are marked as sharp; None where the element says nothing of that."""
    known = [_columns(path, edge, ("vertex1", "vertex2", name)) for name in SHARPNESS]
    rows = next((table for table in known if table is not None), None)
    if rows is None:
        return None
    pairs = np.full(len(rows), 2, dtype=np.intp)
    ends = corners(rows[:, :2].ravel(), pairs, vertex_count, edge.place).reshape(-1, 2)
    return MarkedEdges.of(ends, rows[:, 2])


def _columns(path: Path, table: Table, names: tuple[str, ...]) -> Floats | None:
    """The columns of these names as float64, (rows, columns), None where one is missing."""
    if not all(name in table.columns for name in names):
        return None
    for name in names:
        if name in table.sizes:
            raise FormatError(
                f"{path}: the property '{named(name)}' of '{named(table.element.name)}' is a list, not a number"
            )
    values = np.stack([table.columns[name].astype(np.float64) for name in names], axis=1)
    require_finite(values, table.place)
    return values


def _all_faces(path: Path, found: dict[str, Table], vertex_count: int) -> tuple[Ints, Ints]:
    """The faces, and after them the triangles of the strips."""
    kinds = {"face": _faces, STRIPS: _strips}
    lists = [read(path, found[name], vertex_count) for name, read in kinds.items() if name in found]
    sizes = np.concatenate([np.diff(offsets) for offsets, _ in lists])
    return offsets_of(sizes), np.concatenate([tail for _, tail in lists])


def _strips(path: Path, strips: Table, vertex_count: int) -> tuple[Ints, Ints]:
    """The triangles of all strips; -1 starts a strip anew."""
    lists = _list(path, strips)
    order = whole(
        strips.columns[lists], lambda k: strips.place(int(np.searchsorted(np.cumsum(strips.sizes[lists]), k, "right")))
    )
    # Every list starts anew too.
    order = np.insert(order, offsets_of(strips.sizes[lists])[:-1], RESTART)
    made = triangles_of_strips(order)
    sizes = np.full(len(made), 3, dtype=np.intp)
    return offsets_of(sizes), corners(made.ravel(), sizes, vertex_count, lambda _: f"{path}: the strips")


def _faces(path: Path, face: Table, vertex_count: int) -> tuple[Ints, Ints]:
    name = _list(path, face)
    sizes = face.sizes[name]
    require_sizes(sizes, face.place)
    return offsets_of(sizes), corners(face.columns[name], sizes, vertex_count, face.place)


def _list(path: Path, table: Table) -> str:
    """The name of the list of corners."""
    for name in ("vertex_indices", "vertex_index"):
        if name in table.sizes:
            return name
    raise FormatError(f"{path}: the element '{named(table.element.name)}' has no list 'vertex_indices'")


def _colours(path: Path, table: Table) -> Floats | None:
    """The colours of a table from 0 to 1: integers count to the largest of their type, other numbers to 1."""
    opaque = ("red", "green", "blue")
    names = (*opaque, "alpha") if "alpha" in table.columns else opaque
    values = _columns(path, table, names)
    if values is None:
        return None
    kinds = [np.dtype(p.type) for name in names for p in table.element.properties if p.name == name]
    colors: Floats = values / [_largest(kind) for kind in kinds]
    require_colours(colors, path)
    return colors


def _largest(kind: np.dtype[Any]) -> int:
    return 1 if kind.kind == "f" else int(np.iinfo(kind).max)
