"""Soundness: what later steps rely on in a polyhedron from a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import FormatError
from orbiframe.meshes.polyhedron import Polyhedron

if TYPE_CHECKING:
    pass


# ---- after every reader, before every writer ----------------------------------------------------------------------


def require_sound(polyhedron: object, path: Path, *, degenerate: bool = False) -> Polyhedron:
    """The polyhedron itself. Raises FormatError, naming the file, unless later steps can rely on it.

    It has a face; coordinates, normals and colours are finite and as many as they must be; every corner is a vertex;
    every face has three different vertices at least, unless degenerate faces are allowed.
    """
    if not isinstance(polyhedron, Polyhedron):
        raise FormatError(f"{path}: a Polyhedron is required, but there is a {type(polyhedron).__name__}")
    if polyhedron.face_count < 1:
        raise FormatError(f"{path}: there are {len(polyhedron.vertices)} vertices but no face; a surface is required")
    _require_tables(polyhedron, path)
    _require_corners(polyhedron, path)
    if not degenerate:
        _require_distinct(polyhedron, path)
    return polyhedron


def _require_tables(polyhedron: Polyhedron, path: Path) -> None:
    vertices, faces = len(polyhedron.vertices), polyhedron.face_count
    _require_table(path, "vertex", polyhedron.vertices, vertices, (3,))
    _require_table(path, "normal", polyhedron.normals, vertices, (3,))
    _require_table(path, "colour", polyhedron.colors, vertices, (3, 4))
    _require_table(path, "face colour", polyhedron.face_colors, faces, (3, 4))


def _require_table(
    path: Path, noun: str, table: NDArray[np.float64] | None, rows: int, widths: tuple[int, ...]
) -> None:
    if table is None:
        return
    if table.ndim != 2 or len(table) != rows or table.shape[1] not in widths:
        raise FormatError(f"{path}: the {noun} table is {table.shape}; {rows} rows of {widths[-1]} are required")
    if not np.isfinite(table).all():
        bad = np.flatnonzero(~np.isfinite(table).all(axis=1))
        numbers = ", ".join(f"{x:g}" for x in table[bad[0]].tolist())
        raise FormatError(f"{path}: {noun} {bad[0]} is ({numbers}), but only finite numbers are allowed")


def _require_corners(polyhedron: Polyhedron, path: Path) -> None:
    tail, offsets, count = polyhedron.tail, polyhedron.offsets, len(polyhedron.vertices)
    if offsets[0] != 0 or offsets[-1] != len(tail) or (polyhedron.face_sizes < 0).any():
        raise FormatError(f"{path}: the faces and their {len(tail)} corners do not fit together")
    if tail.min(initial=0) < 0 or tail.max(initial=-1) >= count:
        bad = int(((tail < 0) | (tail >= count)).argmax())
        face = polyhedron.face[bad]
        raise FormatError(f"{path}: face {face} names vertex {tail[bad]}, but the vertices are 0 to {count - 1}")


def _require_distinct(polyhedron: Polyhedron, path: Path) -> None:
    few = np.flatnonzero(distinct_vertices(polyhedron) < 3)
    if len(few):
        corners = " ".join(map(str, polyhedron.face_corners(int(few[0])).tolist()))
        raise FormatError(
            f"{path}: face {few[0]} has the vertices {corners}, but at least three different ones are required "
            f"({len(few)} such faces); --drop-degenerate drops them"
        )


def distinct_vertices(polyhedron: Polyhedron) -> NDArray[np.intp]:
    """How many different vertices each face has, (F,)."""
    if polyhedron.is_triangular:
        a, b, c = polyhedron.triangles.T
        different: NDArray[np.intp] = 1 + (a != b) + ((c != a) & (c != b)).astype(np.intp)
        return different
    count = np.zeros(polyhedron.face_count, dtype=np.intp)
    for size in np.unique(polyhedron.face_sizes[polyhedron.face_sizes > 0]).tolist():
        faces = np.flatnonzero(polyhedron.face_sizes == size)
        corners = np.sort(polyhedron.tail[polyhedron.offsets[faces][:, None] + np.arange(size)], axis=1)
        count[faces] = 1 + (corners[:, 1:] != corners[:, :-1]).sum(axis=1)
    return count
