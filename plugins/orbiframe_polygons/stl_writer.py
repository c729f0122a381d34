"""STL writer: triangles of stereolithography, as text or binary."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.lines import columns_of, save, shaped_text
from orbiframe_polygons.loss import tell_loss
from orbiframe_polygons.stl_reader import RECORD

Floats = NDArray[np.float64]

FACET = [
    *("facet normal ", " ", " "),
    *("\nouter loop\nvertex ", " ", " "),
    *("\nvertex ", " ", " ") * 2,
    "\nendloop\nendfacet\n",
]
END = [b"endsolid orbiframe\n"]


def write(path: Path, polyhedron: Polyhedron, *, ascii: bool = False) -> None:
    """Write the triangles: binary with float32 coordinates, as the format wants it.

    ascii: as text, with the digits that give the same float64 again. Raises FormatError for faces that are no
    triangles, and where corners of a triangle are equal or infinite in float32. Colours and vertex normals are left
    out, with a warning.
    """
    _require_triangles(path, polyhedron)
    tell_loss(path, "colours", polyhedron.colors is not None or polyhedron.face_colors is not None)
    tell_loss(path, "normals of vertices", polyhedron.normals is not None)
    corners = polyhedron.vertices[polyhedron.triangles]
    if ascii:
        save(path, ["solid orbiframe"], shaped_text(columns_of(_normals(corners), *corners.swapaxes(0, 1)), FACET), END)
        return
    _require_single(path, polyhedron)
    records = np.zeros(len(corners), dtype=RECORD)
    records["normal"], records["corners"] = _normals(corners), corners
    count = len(corners).to_bytes(4, "little")
    path.write_bytes(b"orbiframe: binary STL".ljust(80) + count + records.tobytes())


def _require_triangles(path: Path, polyhedron: Polyhedron) -> None:
    larger = np.flatnonzero(polyhedron.face_sizes != 3)
    if len(larger):
        raise FormatError(
            f"{path}: STL holds triangles only, but face {larger[0]} has {polyhedron.face_sizes[larger[0]]} corners "
            f"({len(larger)} such faces); write OFF, OBJ or PLY, or triangulate the polyhedron first"
        )


def _require_single(path: Path, polyhedron: Polyhedron) -> None:
    with np.errstate(over="ignore"):
        corners = polyhedron.vertices.astype(np.float32)[polyhedron.triangles]
    equal = (corners == np.roll(corners, 1, axis=1)).all(axis=2).any(axis=1)
    bad = np.flatnonzero(equal | ~np.isfinite(corners).all(axis=(1, 2)))
    if len(bad):
        raise FormatError(
            f"{path}: the corners of face {bad[0]} are equal or infinite in float32, all that binary STL holds; "
            "scale the polyhedron, or write OFF, OBJ or PLY"
        )


def _normals(corners: Floats) -> Floats:
    """Unit normals of triangles (n, 3, 3); zero where the area is zero."""
    sides = corners[:, 1:] - corners[:, :1]
    sides /= np.maximum(np.abs(sides).max(axis=(1, 2), keepdims=True), np.finfo(np.float64).tiny)
    normal = np.cross(sides[:, 0], sides[:, 1])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    unit: Floats = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
    return unit
