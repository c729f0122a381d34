"""PLY writer: the Polygon File Format of Stanford, as text or binary in either order of bytes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe_polygons.faces import offsets_of
from orbiframe_polygons.lines import faces_text, save, table_text

Array = NDArray[Any]
NAMES = {"u1": "uchar", "u4": "uint", "i4": "int", "i8": "int", "f8": "double"}
COLOURS = ("red", "green", "blue", "alpha")


@dataclass(frozen=True, slots=True)
class Column:
    """A property with its type and its numbers."""

    name: str
    type: str
    values: Array


def write(path: Path, polyhedron: Polyhedron, *, ascii: bool = False, big_endian: bool = False) -> None:
    """Write polygons, normals, colours of vertices and faces, and edges marked as sharp, coordinates as float64.

    ascii: as text, with the digits that round-trip; big_endian: binary with the highest byte first. Colours are written
    as bytes where they count to 255, else as float64.
    """
    order = "" if ascii else ">" if big_endian else "<"
    vertex, face = _vertex_columns(polyhedron), _colour_columns(polyhedron.face_colors)
    count = "u1" if polyhedron.face_sizes.max(initial=0) < 256 else "u4"
    edge = _edge_columns(polyhedron)
    header = _header(order, polyhedron, vertex, face, edge, count)
    if ascii:
        marks = [table_text([c.values for c in edge])] if edge else []
        rows = table_text([c.values for c in vertex]), faces_text(polyhedron, [c.values for c in face])
        save(path, header, *rows, *marks)
        return
    body = _records(vertex, order).tobytes() + _face_bytes(polyhedron, face, order, count)
    body += _records(edge, order).tobytes() if edge else b""
    path.write_bytes("\n".join([*header, ""]).encode("ascii") + body)


def _vertex_columns(polyhedron: Polyhedron) -> list[Column]:
    columns = [Column(n, "f8", v) for n, v in zip("xyz", polyhedron.vertices.T, strict=True)]
    if polyhedron.normals is not None:
        columns += [Column(f"n{n}", "f8", v) for n, v in zip("xyz", polyhedron.normals.T, strict=True)]
    return columns + _colour_columns(polyhedron.colors)


def _colour_columns(colors: NDArray[np.float64] | None) -> list[Column]:
    if colors is None:
        return []
    steps = np.rint(colors * 255)
    exact = np.array_equal(steps / 255, colors)
    values, kind = (steps.astype(np.uint8), "u1") if exact else (colors, "f8")
    return [Column(name, kind, column) for name, column in zip(COLOURS, values.T, strict=False)]


def _edge_columns(polyhedron: Polyhedron) -> list[Column]:
    """The edges that are marked as sharp."""
    marked = polyhedron.marked
    if marked is None:
        return []
    ends = [Column(f"vertex{k + 1}", "i4", marked.ends[:, k]) for k in (0, 1)]
    return [*ends, Column("crease", "f8", marked.sharpness)]


def _header(
    order: str, polyhedron: Polyhedron, vertex: list[Column], face: list[Column], edge: list[Column], count: str
) -> list[str]:
    name = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    return [
        "ply",
        f"format {name} 1.0",
        f"element vertex {len(polyhedron.vertices)}",
        *(f"property {NAMES[c.type]} {c.name}" for c in vertex),
        f"element face {polyhedron.face_count}",
        f"property list {NAMES[count]} int vertex_indices",
        *(f"property {NAMES[c.type]} {c.name}" for c in face),
        *([f"element edge {len(edge[0].values)}"] if edge else []),
        *(f"property {NAMES[c.type]} {c.name}" for c in edge),
        "end_header",
    ]


def _records(columns: list[Column], order: str) -> Array:
    """Columns of numbers side by side, one record for each row."""
    rows = np.empty(len(columns[0].values), dtype=[(c.name, order + c.type) for c in columns])
    for column in columns:
        rows[column.name] = column.values
    return rows


def _face_bytes(polyhedron: Polyhedron, colours: list[Column], order: str, count: str) -> bytes:
    """The rows of the faces: the count, the corners and the colour; faces of one size are made together."""
    kinds = np.unique(polyhedron.face_sizes).tolist()
    blocks = {n: _faces_of_size(polyhedron, n, colours, order, count) for n in kinds}
    if len(blocks) == 1:
        return blocks[kinds[0]].tobytes()
    widths = {n: block.dtype.itemsize for n, block in blocks.items()}
    starts = offsets_of(np.array([widths[n] for n in polyhedron.face_sizes.tolist()], dtype=np.intp))
    body = np.empty(starts[-1], dtype=np.uint8)
    for n, block in blocks.items():
        first = starts[:-1][polyhedron.face_sizes == n]
        body[first[:, None] + np.arange(widths[n])] = block.view(np.uint8).reshape(len(block), -1)
    return body.tobytes()


def _faces_of_size(polyhedron: Polyhedron, size: int, colours: list[Column], order: str, count: str) -> Array:
    chosen = np.flatnonzero(polyhedron.face_sizes == size)
    dtype = [("count", order + count), ("corners", order + "i4", (size,)), *((c.name, order + c.type) for c in colours)]
    rows = np.empty(len(chosen), dtype=dtype)
    rows["count"] = size
    rows["corners"] = polyhedron.tail[polyhedron.offsets[chosen][:, None] + np.arange(size)]
    for column in colours:
        rows[column.name] = column.values[chosen]
    return rows
