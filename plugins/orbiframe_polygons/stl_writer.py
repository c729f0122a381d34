"""STL writer: triangles of stereolithography, as text or binary."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe.files import require_triangles
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
BLOCK = 2**14
END = [b"endsolid orbiframe\n"]


def write(path: Path, polyhedron: Polyhedron, *, ascii: bool = False) -> None:
    """Write the triangles: binary with float32 coordinates, as the format wants it.

    ascii: as text, with the digits that give the same float64 again. Raises FormatError for faces that are no
    triangles, and where corners of a triangle are equal or infinite in float32. Colours and vertex normals are left
    out, with a warning.
    """
    require_triangles(path, polyhedron, "STL")
    tell_loss(path, "colours", polyhedron.colors is not None or polyhedron.face_colors is not None)
    tell_loss(path, "normals of vertices", polyhedron.normals is not None)
    if ascii:
        corners = polyhedron.vertices[polyhedron.triangles]
        save(path, ["solid orbiframe"], shaped_text(columns_of(_normals(corners), *corners.swapaxes(0, 1)), FACET), END)
        return
    blocks = [_records(path, polyhedron, first).tobytes() for first in range(0, polyhedron.face_count, BLOCK)]
    count = polyhedron.face_count.to_bytes(4, "little")
    path.write_bytes(b"".join([b"orbiframe: binary STL".ljust(80), count, *blocks]))


def _records(path: Path, polyhedron: Polyhedron, first: int) -> NDArray[np.void]:
    """The records of a block of triangles, from the first on."""
    corners = polyhedron.vertices[polyhedron.triangles[first : first + BLOCK]]
    records = np.zeros(len(corners), dtype=RECORD)
    with np.errstate(over="ignore"):
        single = corners.astype(np.float32)
    _require_single(path, single, first)
    records["normal"], records["corners"] = _normals(corners), single
    return records


def _require_single(path: Path, corners: NDArray[np.float32], first: int) -> None:
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    equal = _equal(a, b) | _equal(b, c) | _equal(c, a)
    finite = np.isfinite(corners.reshape(-1, 9))
    bad = np.flatnonzero(equal if finite.all() else equal | ~finite.all(axis=1))
    if len(bad):
        raise FormatError(
            f"{path}: the corners of face {first + bad[0]} are equal or infinite in float32, which is all that binary "
            "STL holds; scale the polyhedron, or write OFF, OBJ or PLY"
        )


def _equal(a: NDArray[np.float32], b: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Whether points (n, 3) coincide; by columns, which is several times quicker than along rows of three."""
    same: NDArray[np.bool_] = (a[:, 0] == b[:, 0]) & (a[:, 1] == b[:, 1]) & (a[:, 2] == b[:, 2])
    return same


def _normals(corners: Floats) -> Floats:
    """Unit normals of triangles (n, 3, 3); zero where the area is zero. By columns, see `_equal`."""
    u, v = (np.ascontiguousarray((corners[:, k] - corners[:, 0]).T) for k in (1, 2))
    largest = np.maximum(np.abs(u), np.abs(v))
    scale = np.maximum(np.maximum(largest[0], largest[1]), np.maximum(largest[2], np.finfo(np.float64).tiny))
    u, v = u / scale, v / scale
    normal = np.stack([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
    length = np.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    unit: Floats = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
    return unit.T
