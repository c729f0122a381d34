"""Cells: meshio's blocks of cells of one kind, to polygons and back; to be called in a process of its own."""

from __future__ import annotations

import contextlib
import io
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_meshio.texts import EndingText, require_counts, require_trustworthy

Ints = NDArray[np.intp]

POLYGONS = {"triangle", "quad", "polygon"}
BELOW = {"vertex", "line"}
# Where the dialect that meshio would choose is not what programs expect, or does not hold faces of several sizes.
DIALECTS = {".msh": "gmsh22"}
# What this dialect asks of every cell.
TAGS: dict[str | None, tuple[str, ...]] = {"gmsh22": ("gmsh:physical", "gmsh:geometrical")}
# SU2 has surfaces in the plane only.
PLANE = {".su2"}
# Suffixes of formats that hold larger polygons.
POLYGONAL = {".vtk", ".vtu"}
# meshio's names of the formats that are read line by line.
LINE_READERS = {
    **dict.fromkeys((".dat", ".tec"), "tecplot"),
    ".avs": "avsucd",
    **dict.fromkeys((".nas", ".bdf", ".fem"), "nastran"),
    **dict.fromkeys((".post", ".dato"), "permas"),
    ".vol": "netgen",
}
# Formats of which meshio reads what is counted, and no more.
COUNTED = {"tecplot", "avsucd"}
# Names of boundaries are not kept anyhow.
HARMLESS = re.compile(r"Warning: meshio does not support tags of string type\. Surface tag .*? will be replaced by \d+")
# Relative to the bounding box: formats that round coordinates to float32 pass, a lost digit more does not.
ROUNDING = 1e-6
LENGTH = 200


def polyhedron_of(path: Path) -> Polyhedron:
    """The polygons of a file. Raises FormatError for cells that are no polygons, and where meshio warns or ends."""
    require_trustworthy(path)
    with _strict(path):
        mesh = _mesh(path)
    if path.suffix.lower() in PLANE:
        require_counts(path, sum(len(block.data) for block in mesh.cells))
    return _polyhedron(path, mesh)


def save(path: Path, polyhedron: Polyhedron) -> None:
    """Write a file and read it again. Raises FormatError where that is not the same polyhedron."""
    if path.suffix.lower() not in POLYGONAL and polyhedron.face_sizes.max(initial=0) > 4:
        raise FormatError(
            f"{path}: this format holds triangles and quads only, but one has {polyhedron.face_sizes.max()} corners; "
            "write OFF, OBJ, PLY or VTU, or use convert --triangulate"
        )
    blocks = list(_blocks(polyhedron))
    dialect = DIALECTS.get(path.suffix.lower())
    tags = {name: [np.zeros(len(corners), dtype=np.int32) for _, corners in blocks] for name in TAGS.get(dialect, ())}
    points = _plane_points(path, polyhedron) if path.suffix.lower() in PLANE else polyhedron.vertices
    # The UGRID writer prints numbers as NumPy 1 did.
    with _strict(path), np.printoptions(legacy="1.25"):
        meshio.write(path, meshio.Mesh(points, blocks, cell_data=tags), file_format=dialect)
    _require_same(path, polyhedron, polyhedron_of(path))


def _mesh(path: Path) -> Any:
    name = LINE_READERS.get(path.suffix.lower())
    if name is None:
        return meshio.read(path)
    with EndingText(path.open("rb"), encoding="utf-8", errors="replace") as text:
        mesh = meshio.read(text, name)
        if name in COUNTED and text.read().strip():
            raise FormatError(f"{path}: the file goes on after what its counts say; only one zone is read")
    return mesh


def _plane_points(path: Path, polyhedron: Polyhedron) -> NDArray[np.float64]:
    if polyhedron.vertices[:, 2].any():
        raise FormatError(f"{path}: this format holds surfaces in the plane z = 0 only; choose OFF, OBJ, PLY or VTU")
    return polyhedron.vertices[:, :2]


def _polyhedron(path: Path, mesh: Any) -> Polyhedron:
    kinds = {block.type for block in mesh.cells}
    other = sorted(kinds - POLYGONS - BELOW)
    if other:
        raise FormatError(
            f"{path}: found cells of the kind {', '.join(other)}; only triangles, quads and polygons are read"
        )
    points = _points(path, mesh.points)
    blocks = [np.asarray(block.data) for block in mesh.cells if block.type in POLYGONS and len(block.data)]
    if not blocks:
        raise FormatError(f"{path}: the file holds no triangles, quads or polygons")
    sizes = np.concatenate([np.full(len(block), block.shape[1]) for block in blocks])
    tail = np.concatenate([block.ravel() for block in blocks]).astype(np.intp)
    _require_range(path, tail, len(points))
    return Polyhedron.from_corners(points, np.concatenate([[0], np.cumsum(sizes)]), tail)


def _points(path: Path, points: NDArray[Any]) -> NDArray[np.float64]:
    """Points in space; a plane file has the height 0."""
    table = np.asarray(points, dtype=np.float64)
    if table.ndim != 2 or table.shape[1] not in (2, 3):
        raise FormatError(f"{path}: the table of points is {table.shape}; two or three coordinates are required")
    if not np.isfinite(table).all():
        raise FormatError(f"{path}: point {np.flatnonzero(~np.isfinite(table).all(axis=1))[0]} is not finite")
    return np.pad(table, ((0, 0), (0, 3 - table.shape[1])))


def _require_range(path: Path, tail: Ints, count: int) -> None:
    bad = np.flatnonzero((tail < 0) | (tail >= count))
    if len(bad):
        raise FormatError(f"{path}: a face names vertex {tail[bad[0]]}, but the vertices are 0 to {count - 1}")


def _blocks(polyhedron: Polyhedron) -> Iterator[tuple[str, Ints]]:
    """Runs of faces of one size, so that the order of faces is kept."""
    sizes = polyhedron.face_sizes
    starts = np.flatnonzero(np.diff(sizes, prepend=-1)).tolist()
    for first, last in zip(starts, [*starts[1:], len(sizes)], strict=True):
        size = int(sizes[first])
        corners = polyhedron.tail[polyhedron.offsets[first] : polyhedron.offsets[last]]
        yield {3: "triangle", 4: "quad"}.get(size, "polygon"), corners.reshape(-1, size)


def _require_same(path: Path, written: Polyhedron, found: Polyhedron) -> None:
    same = np.array_equal(written.offsets, found.offsets) and np.array_equal(written.tail, found.tail)
    if not same or np.abs(written.vertices - found.vertices).max() > ROUNDING * written.diagonal:
        raise FormatError(f"{path}: meshio cannot write this polyhedron without loss; choose OFF, OBJ, PLY or VTU")


@contextlib.contextmanager
def _strict(path: Path) -> Iterator[None]:
    """What meshio prints is a complaint, and its end of the process an error: both become FormatError."""
    words = io.StringIO()
    try:
        with contextlib.redirect_stdout(words), contextlib.redirect_stderr(words):
            yield
    except FormatError:
        raise
    except (Exception, SystemExit) as error:
        reason = _reason(words.getvalue(), error)
        raise FormatError(f"{path}: meshio cannot make sense of this file{reason}") from error
    said = _brief(HARMLESS.sub("", " ".join(words.getvalue().split())))
    if said:
        raise FormatError(f"{path}: meshio is not sure of this file: {said}")


def _reason(printed: str, error: BaseException) -> str:
    """What meshio says for people, in print or by an error of its own; nothing of bare errors of Python."""
    own = (meshio.ReadError, meshio.WriteError, FormatError, EOFError, MemoryError, RuntimeError)
    said = _brief(printed) or (_brief(str(error)) or type(error).__name__ if isinstance(error, own) else "")
    return f": {said}" if said else "; is it damaged, or of another format?"


def _brief(words: str) -> str:
    """What meshio says on one line; it may quote much of a file."""
    plain = " ".join("".join(letter if letter.isprintable() else " " for letter in words[: 20 * LENGTH]).split())
    return plain if len(plain) <= LENGTH else f"{plain[:LENGTH]}…"
