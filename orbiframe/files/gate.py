"""Formats: files to polyhedra and back, through one gate that no bad file passes."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import FitError, FormatError, PluginError
from orbiframe.components.options import checked_options
from orbiframe.plugin import Component
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.suggestion import did_you_mean

if TYPE_CHECKING:
    from orbiframe.surfaces.surface import OrbifoldSurface

SIZE_LIMIT = 2**32


class Components(Protocol):
    """What is asked of a registry."""

    def components(self, kind: str) -> list[Component]:
        """The components of a kind."""

    def component(self, kind: str, name: str) -> Component:
        """The component of this name."""

    def load(self, kind: str, name: str) -> Callable[..., object]:
        """What the component names, imported now."""


def read(
    path: Path,
    registry: Components,
    *,
    format: str | None = None,
    options: Mapping[str, Any] | None = None,
    degenerate: bool = False,
    size_limit: int = SIZE_LIMIT,
) -> Polyhedron:
    """The polyhedron of a file, by the reader of its suffix or by the one that `format` names.

    options: those of the reader; degenerate: let faces of fewer than three different vertices pass, to be described or
    repaired.

    The file must be a regular one of 1 to size_limit bytes. Raises FormatError, naming the file, for anything that is
    wrong with it or with the polyhedron in it: a coordinate that is not finite, an index out of range, a face of fewer
    than three different vertices, no face at all. Whatever a reader raises, the end of the process included, becomes a
    FormatError. Raises UsageError for an unknown format or option, PluginError where the reader cannot be imported.
    """
    path = Path(path)
    require_readable(path, size_limit)
    reader = _component(path, registry, "reader", format, options)
    return require_sound(_guarded(path, "reading", reader, path), path, degenerate=degenerate)


def write(
    path: Path,
    polyhedron: Polyhedron,
    registry: Components,
    *,
    format: str | None = None,
    options: Mapping[str, Any] | None = None,
) -> None:
    """Write a polyhedron, by the writer of the file's suffix or by the one that `format` names, with its options.

    The file appears whole or not at all: it is made in a folder beside its place and then moved. Raises FormatError,
    naming the file, where the polyhedron or the place is unfit or the writer fails; UsageError and PluginError as in
    `read`.
    """
    path = Path(path)
    require_sound(polyhedron, path)
    require_writable(_behind_links(path))
    _write_whole(path, _component(path, registry, "writer", format, options), polyhedron)


def export(path: Path, surface: OrbifoldSurface, registry: Components) -> None:
    """Write a surface itself, exactly, by the exporter of the file's suffix.

    The file appears whole or not at all, as in `write`. Raises FormatError where the place is unfit or the exporter
    fails, FitError for a surface that has no exact patches.
    """
    path = Path(path)
    require_writable(_behind_links(path))
    _write_whole(path, _component(path, registry, "exporter", None, None), surface)


def exports(path: Path, registry: Components) -> bool:
    """Whether an exporter writes files with this suffix."""
    return any(path.suffix.lower() in c.suffixes for c in registry.components("exporter"))


# ---- which component ----------------------------------------------------------------------------------------------


def component_name(path: Path, registry: Components, kind: str, format: str | None) -> str:
    """The name of the reader or writer for a file: `format` if given, else the only one that declares the suffix.

    Raises FormatError for a suffix that none declares, PluginError for one that several do, UsageError for an unknown
    format.
    """
    if format is not None:
        return registry.component(kind, format).name
    suffix = path.suffix.lower()
    names = [c.name for c in registry.components(kind) if suffix in c.suffixes]
    if not names:
        raise FormatError(_unknown(path, suffix, kind, registry))
    if len(names) > 1:
        raise PluginError(f"{path}: the {kind}s {', '.join(names)} claim '{suffix}'; name one of them as the format")
    return names[0]


def _component(
    path: Path, registry: Components, kind: str, format: str | None, options: Mapping[str, Any] | None
) -> Callable[..., object]:
    target = registry.load(kind, component_name(path, registry, kind, format))
    return partial(target, **checked_options(target, options, kind, {})) if options else target


def _unknown(path: Path, suffix: str, kind: str, registry: Components) -> str:
    known = sorted({s for c in registry.components(kind) for s in c.suffixes})
    listed = f"the {kind}s know {' '.join(known)}" if known else f"there is no {kind}"
    found = f"the suffix '{suffix}' is not known" if suffix else "the name has no suffix"
    return f"{path}: {found}; {listed}. Name the format where the suffix does not say it.{did_you_mean(suffix, known)}"


# ---- before a reader, round any component -------------------------------------------------------------------------


def require_readable(path: Path, size_limit: int = SIZE_LIMIT) -> None:
    """Raise FormatError unless there is a regular file that is neither empty nor larger than the limit (in bytes)."""
    try:
        status = path.stat()
    except (OSError, ValueError) as error:
        raise FormatError(_absent(path, error)) from error
    if not stat.S_ISREG(status.st_mode):
        raise FormatError(f"{path}: this is {_species(status.st_mode)}, but a regular file is required")
    if status.st_size == 0:
        raise FormatError(f"{path}: the file is empty")
    if status.st_size > size_limit:
        raise FormatError(
            f"{path}: the file has {status.st_size} bytes, more than the limit of {size_limit}; raise the limit"
        )


def require_writable(path: Path) -> None:
    """Raise FormatError unless a file can be made here: its folder is there and nothing but a file is in place."""
    if not path.parent.is_dir():
        raise FormatError(f"{path}: there is no folder {path.parent}; make it first")
    if path.exists() and not path.is_file():
        raise FormatError(f"{path}: this is {_species(path.stat().st_mode)}; only regular files are written")


def _folder_beside(path: Path) -> tempfile.TemporaryDirectory[str]:
    try:
        return tempfile.TemporaryDirectory(dir=path.parent, prefix=".orbiframe-")
    except OSError as error:
        raise FormatError(f"{path}: nothing can be written in the folder {path.parent}: {error.strerror}") from error


def _absent(path: Path, error: Exception) -> str:
    if not isinstance(error, FileNotFoundError):
        return f"{path}: the file cannot be reached: {error}"
    if path.is_symlink():
        return f"{path}: this is a link to {os.readlink(path)}, which is not there"
    folder = path.parent
    siblings = os.listdir(folder) if folder.is_dir() and os.access(folder, os.R_OK) else []
    return f"{path}: there is no such file.{did_you_mean(path.name, siblings)}"


def _species(mode: int) -> str:
    kinds = {stat.S_IFDIR: "a folder", stat.S_IFIFO: "a pipe", stat.S_IFCHR: "a device", stat.S_IFBLK: "a device"}
    return kinds.get(stat.S_IFMT(mode), "no regular file")


def _guarded(path: Path, doing: str, component: Callable[..., object], *arguments: object) -> Any:
    """Call a reader or writer; whatever it raises becomes a FormatError that names the file."""
    try:
        return component(*arguments)
    except (FitError, FormatError, PluginError) as error:
        raise type(error)(str(error).replace(str(arguments[0]), str(path))) from error
    except (Exception, SystemExit) as error:
        raise FormatError(f"{path}: {doing} failed: {_described(error)}") from error


def _write_whole(path: Path, writer: Callable[..., object], content: object) -> None:
    """Have a file made in a folder beside its place and then moved there."""
    target = _behind_links(path)
    with _folder_beside(target) as folder:
        made = Path(folder) / path.name
        _guarded(path, "writing", writer, made, content)
        _move(made, target)


def _behind_links(path: Path) -> Path:
    """Through a link the file behind it is written, as by any other program."""
    return Path(os.path.realpath(path)) if path.is_symlink() else path


def _described(error: BaseException) -> str:
    if isinstance(error, SystemExit):
        return "the library for this format tried to end the program; the file is not what it expects"
    if isinstance(error, MemoryError):
        return "it asks for more memory than there is; are the counts in the file right?"
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__


def _move(made: Path, target: Path) -> None:
    """Move what a writer made to its place, the file itself last."""
    if not made.is_file() or made.stat().st_size == 0:
        raise FormatError(f"{target}: the writer of this format made no file; choose another format")
    for companion in sorted(made.parent.iterdir()):
        if companion != made:
            companion.replace(target.parent / companion.name)
    made.replace(target)


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
