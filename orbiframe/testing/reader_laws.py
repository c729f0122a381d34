"""Laws of readers: the polyhedron of a file, or a FormatError.

A reader is tried on what the writer of its format (`lab.counterpart`) makes, and on bytes that are no mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from orbiframe.errors import FormatError
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.lab import Lab, Untried
from orbiframe.testing.writer_laws import files, require_same_faces

Component = Callable[..., Any]

TABLES = ("vertices", "offsets", "tail")


def faces_are_found(reader: Component, lab: Lab) -> None:
    """A file has the faces that were written into it, with coordinates exact in float64 or in float32."""
    for path, polyhedron in _files(lab):
        require_same_faces(reader(path), polyhedron)


def file_is_unchanged(reader: Component, lab: Lab) -> None:
    """Reading changes neither the file nor its folder, and the same file gives the same polyhedron twice."""
    path = _files(lab)[0][0]
    before = _contents(lab.tmp_path)
    first, second = reader(path), reader(path)
    assert _contents(lab.tmp_path) == before, "reading changed the folder"
    for table in TABLES:
        assert np.array_equal(getattr(first, table), getattr(second, table)), f"{table} differ from run to run"


def cut_file_is_refused(reader: Component, lab: Lab) -> None:
    """A file of which only the first quarter is left is a FormatError."""
    for path, _ in _files(lab)[:1]:
        content = path.read_bytes()
        path.write_bytes(content[: len(content) // 4])
        _require_refused(reader, path)


def noise_is_refused(reader: Component, lab: Lab) -> None:
    """Bytes drawn at random, and words that are no mesh, are a FormatError."""
    path = lab.tmp_path / f"noise{lab.suffix or ''}"
    for content in (lab.rng.bytes(999), b"this is no mesh\n" * 9, b"\0" * 200):
        path.write_bytes(content)
        _require_refused(reader, path)


def _files(lab: Lab) -> list[tuple[Path, Polyhedron]]:
    """Files of the format, with the polyhedra in them."""
    if lab.counterpart is None:
        raise Untried("no writer makes files of this format; name a function (path, polyhedron) as counterpart")
    made = list(files(lab.counterpart, lab))
    if not made:
        raise Untried("the writer of this format takes none of the samples; name another function as counterpart")
    return made


def _require_refused(reader: Component, path: Path) -> None:
    try:
        found = reader(path)
    except FormatError as error:
        assert path.name in str(error), "the error does not name the file"  # noqa: PT017
        return
    except (Exception, SystemExit) as error:
        raise AssertionError(f"{type(error).__name__} instead of FormatError for {path.name}") from error
    raise AssertionError(f"{path.name} is read as {found.face_count} faces")


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


LAWS: tuple[Callable[[Component, Lab], None], ...] = (
    faces_are_found,
    file_is_unchanged,
    cut_file_is_refused,
    noise_is_refused,
)


# ---- mutants: each breaks one law ---------------------------------------------------------------------------------


def _loses_a_face(reader: Component) -> Component:
    def short(path: Path) -> Polyhedron:
        found = reader(path)
        return Polyhedron.from_corners(found.vertices, found.offsets[:-1], found.tail[: found.offsets[-2]])

    return short


def _leaves_a_cache(reader: Component) -> Component:
    def caching(path: Path) -> Polyhedron:
        path.with_suffix(".cache").write_bytes(b"read")
        found: Polyhedron = reader(path)
        return found

    return caching


def _makes_do(reader: Component) -> Component:
    def lenient(path: Path) -> Polyhedron:
        try:
            found: Polyhedron = reader(path)
        except FormatError:
            return Polyhedron.from_faces(np.eye(3), [[0, 1, 2]])
        return found

    return lenient


def _exits(reader: Component) -> Component:
    def exiting(path: Path) -> Polyhedron:
        try:
            found: Polyhedron = reader(path)
        except FormatError as error:
            raise SystemExit(1) from error
        return found

    return exiting


MUTANTS: Mapping[str, Callable[[Component], Component]] = {
    "faces_are_found": _loses_a_face,
    "file_is_unchanged": _leaves_a_cache,
    "cut_file_is_refused": _makes_do,
    "noise_is_refused": _exits,
}
