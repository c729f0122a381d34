"""Laws of writers: a file holds the polyhedron, and nothing else changes.

A writer is tried together with the reader of its format (`lab.counterpart`), if there is one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import FormatError
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.lab import Lab, Untried

Component = Callable[..., Any]

TABLES = ("vertices", "offsets", "tail", "twin", "same")
# Triangles alone, quads alone, and polygons of two sizes: few, since a reader may start a process for each file.
SAMPLES = ("tetrahedron", "cube", "prism")


def faces_survive(writer: Component, lab: Lab) -> None:
    """A file read again has the same faces, corner by corner, with coordinates exact in float64 or in float32.

    The order of faces and the numbers of vertices are the file's own.
    """
    if lab.counterpart is None:
        raise Untried("no reader reads files of this format; name a function (path) as counterpart")
    for path, polyhedron in files(writer, lab):
        require_same_faces(lab.counterpart(path), polyhedron)


def input_is_unchanged(writer: Component, lab: Lab) -> None:
    """Writing changes nothing in the polyhedron."""
    for name in SAMPLES[:2]:
        polyhedron = lab.polyhedra[name]
        copies = {table: getattr(polyhedron, table).copy() for table in TABLES}
        written(writer, lab, name, polyhedron)
        for table, copy in copies.items():
            assert np.array_equal(getattr(polyhedron, table), copy), f"writing the {name} changed its {table}"


def same_bytes(writer: Component, lab: Lab) -> None:
    """The same polyhedron written twice gives the same bytes."""
    for path, polyhedron in files(writer, lab, SAMPLES[:2]):
        first = path.read_bytes()
        writer(path, polyhedron)
        assert path.read_bytes() == first, f"{path.name} differs from run to run"


def unfit_is_refused(writer: Component, lab: Lab) -> None:
    """What the format cannot hold is a FormatError, and at least the tetrahedron can be written."""
    outcomes = [written(writer, lab, name, lab.polyhedra[name]) for name in SAMPLES]
    assert outcomes[0] is not None, "the tetrahedron is refused"


def files(writer: Component, lab: Lab, names: Sequence[str] = SAMPLES) -> Iterator[tuple[Path, Polyhedron]]:
    """The files of those reference polyhedra that the format holds, with coordinates of many digits."""
    for name in names:
        polyhedron = lab.polyhedra[name]
        noise = lab.rng.normal(size=polyhedron.vertices.shape)
        moved = replace(polyhedron, vertices=polyhedron.vertices + noise / 64)
        path = written(writer, lab, name, moved)
        if path is not None:
            yield path, moved


def written(writer: Component, lab: Lab, name: str, polyhedron: Polyhedron) -> Path | None:
    """The file of a polyhedron, None where the writer refuses it."""
    path = lab.tmp_path / f"{name.replace(' ', '-')}{lab.suffix or ''}"
    try:
        writer(path, polyhedron)
    except FormatError:
        return None
    assert path.is_file(), f"no file is made for the {name}"
    return path


def require_same_faces(found: Polyhedron, wanted: Polyhedron) -> None:
    """Assert that two polyhedra have the same faces as closed rows of points, whatever their numbers."""
    single = wanted.with_vertices(wanted.vertices.astype(np.float32).astype(np.float64))
    rows = _rows(found)
    assert rows in (_rows(wanted), _rows(single)), "faces or coordinates differ after writing and reading"


def _rows(polyhedron: Polyhedron) -> list[list[tuple[float, ...]]]:
    return sorted(_from_least(polyhedron.vertices[polyhedron.face_corners(f)]) for f in range(polyhedron.face_count))


def _from_least(points: NDArray[np.float64]) -> list[tuple[float, ...]]:
    """The corners of a face, from the smallest on."""
    corners = [tuple(point) for point in points.tolist()]
    start = corners.index(min(corners))
    return corners[start:] + corners[:start]


LAWS: tuple[Callable[[Component, Lab], None], ...] = (faces_survive, input_is_unchanged, same_bytes, unfit_is_refused)


# ---- mutants: each breaks one law ---------------------------------------------------------------------------------


def _rounds(writer: Component) -> Component:
    def rounded(path: Path, polyhedron: Polyhedron) -> None:
        writer(path, polyhedron.with_vertices(polyhedron.vertices.round(4)))

    return rounded


def _scales_in_place(writer: Component) -> Component:
    def scaled(path: Path, polyhedron: Polyhedron) -> None:
        writer(path, polyhedron)
        polyhedron.vertices.__imul__(1.5)

    return scaled


def _counts_runs(writer: Component) -> Component:
    runs: list[Path] = []

    def stamped(path: Path, polyhedron: Polyhedron) -> None:
        writer(path, polyhedron)
        runs.append(path)
        path.write_bytes(path.read_bytes() + str(len(runs)).encode())

    return stamped


def _raises_at_random(writer: Component) -> Component:
    def strict(path: Path, polyhedron: Polyhedron) -> None:
        if len(polyhedron.vertices) > 4:
            raise ValueError("too many vertices")
        writer(path, polyhedron)

    return strict


MUTANTS: Mapping[str, Callable[[Component], Component]] = {
    "faces_survive": _rounds,
    "input_is_unchanged": _scales_in_place,
    "same_bytes": _counts_runs,
    "unfit_is_refused": _raises_at_random,
}
