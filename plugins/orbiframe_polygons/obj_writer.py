"""OBJ writer: polygons in the text format of Wavefront."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe_polygons.lines import columns_of, faces_text, save, table_text
from orbiframe_polygons.loss import tell_loss

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def write(path: Path, polyhedron: Polyhedron) -> None:
    """Write polygons, normals and vertex colours (`v x y z r g b`), each number with the digits that round-trip.

    Corners have normals of their own beside creases, and points of a texture (`vt u v`) where the polyhedron has some.
    Edges that are marked as sharp are tags `t crease 2/1/0 v w sharpness`, as OpenSubdiv reads them.

    OBJ holds no opacity and no colours of faces: a warning says what was left out.
    """
    colors = polyhedron.colors
    tell_loss(path, "colours of faces", polyhedron.face_colors is not None)
    tell_loss(path, "opacity", colors is not None and colors.shape[1] > 3)
    solid = None if colors is None else colors[:, :3]
    if polyhedron.corner_normals is not None or polyhedron.corner_uv is not None:
        _write_corners(path, polyhedron, solid)
        return
    normals = polyhedron.normals
    vertices = table_text(columns_of(polyhedron.vertices, solid), start="v ")
    directions = [] if normals is None else [table_text(columns_of(normals), start="vn ")]
    faces = faces_text(polyhedron, lead="f", first=1, twice=normals is not None)
    save(path, [], vertices, *directions, faces, _tags(polyhedron))


def _write_corners(path: Path, polyhedron: Polyhedron, colors: Floats | None) -> None:
    """Polygons whose corners name a vertex, and a point of the texture and a normal of their own."""
    textures, point = _numbered(polyhedron.corner_uv)
    normals, normal = polyhedron.normals, polyhedron.tail
    if polyhedron.corner_normals is not None:
        normals, normal = _numbered(polyhedron.corner_normals)
    columns = [polyhedron.tail, None if textures is None else point, None if normals is None else normal]
    save(
        path,
        [],
        table_text(columns_of(polyhedron.vertices, colors), start="v "),
        *([] if textures is None else [table_text(columns_of(textures), start="vt ")]),
        *([] if normals is None else [table_text(columns_of(normals), start="vn ")]),
        _faces(polyhedron.offsets.tolist(), columns),
        _tags(polyhedron),
    )


def _tags(polyhedron: Polyhedron) -> Iterator[bytes]:
    """A line for each edge that is marked as sharp, as OpenSubdiv has them."""
    marked = polyhedron.marked
    if marked is not None:
        for (v, w), sharpness in zip(marked.ends.tolist(), marked.sharpness.tolist(), strict=True):
            yield f"t crease 2/1/0 {v} {w} {sharpness!r}\n".encode("ascii")


def _numbered(table: Floats | None) -> tuple[Floats | None, Ints]:
    """The different rows of a table, and the number of each row among them."""
    if table is None:
        return None, np.zeros(0, dtype=np.intp)
    different, number = np.unique(table, axis=0, return_inverse=True)
    return different, number.ravel()


def _faces(bounds: list[int], columns: Sequence[Ints | None]) -> Iterator[bytes]:
    """A line for each face, of corners as vertex/texture/normal."""
    words = [itertools.repeat("") if column is None else map(str, (column + 1).tolist()) for column in columns]
    corners = ["/".join(parts).rstrip("/") for parts in zip(*words, strict=False)]
    return (f"f {' '.join(corners[a:b])}\n".encode("ascii") for a, b in itertools.pairwise(bounds))
