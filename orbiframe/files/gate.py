"""The gate: files to polyhedra and back, which no bad file passes."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from orbiframe.components.options import checked_options
from orbiframe.components.registry import Registry
from orbiframe.components.shown_text import shown
from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import FitError, FormatError, PluginError, TopologyError, UsageError
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.plugin import Component

if TYPE_CHECKING:
    from orbiframe.surfaces.curved_triangles import CurvedMesh
    from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.files.datasets import located
from orbiframe.files.outputs import output, require_output
from orbiframe.files.places import SIZE_LIMIT, require_readable
from orbiframe.files.soundness import require_sound


class Components(Protocol):
    """What is asked of a registry."""

    def components(self, kind: str) -> list[Component]:
        """The components of a kind."""

    def component(self, kind: str, name: str) -> Component:
        """The component of this name."""

    def for_suffix(self, kind: str, suffix: str) -> list[Component]:
        """The components of a kind for a file suffix."""

    def load(self, kind: str, name: str) -> Callable[..., object]:
        """What the component names, imported now."""


def read(
    path: str | Path,
    registry: Components | None = None,
    *,
    format: str | None = None,
    options: Mapping[str, Any] | None = None,
    degenerate: bool = False,
    size_limit: int = SIZE_LIMIT,
) -> Polyhedron:
    """The polyhedron of a file, by the reader of its suffix or by the one that `format` names.

    path: or "dataset:torus" and the like, see `orbiframe.files.located`; registry: by default all that is installed;
    options: those of the reader; degenerate: let faces of fewer than three
    different vertices pass, to be described or repaired.

    The file must be a regular one of 1 to size_limit bytes. Raises FormatError, naming the file, for anything that is
    wrong with it or with the polyhedron in it: a coordinate that is not finite, an index out of range, a face of fewer
    than three different vertices, no face at all. Whatever a reader raises, the end of the process included, becomes a
    FormatError. Raises UsageError for an unknown format or option, PluginError where the reader cannot be imported.

    >>> from orbiframe import read
    >>> read("dataset:cube")
    <Polyhedron: 8 vertices, 12 edges, 6 faces>
    """
    path = located(path)
    require_readable(path, size_limit)
    reader = _component(path, _registry(registry), "reader", format, options)
    return require_sound(_guarded(path, "reading", reader, path), path, degenerate=degenerate)


def write(
    path: str | Path,
    polyhedron: object,
    registry: Components | None = None,
    *,
    format: str | None = None,
    options: Mapping[str, Any] | None = None,
) -> None:
    """Write a polyhedron, by the writer of the file's suffix or by the one that `format` names, with its options.

    polyhedron: or what `Polyhedron.of` takes; registry: by default all that is installed.

    The file appears whole or not at all: it is made in a folder beside its place and then moved. Raises FormatError,
    naming the file, where the polyhedron or the place is unfit or the writer fails; UsageError and PluginError as in
    `read`.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from orbiframe import read, write
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write(Path(folder) / "cube.ply", read("dataset:cube"))
    ...     read(Path(folder) / "cube.ply").face_count
    6
    """
    path = Path(path)
    mesh = require_sound(_mesh(polyhedron, path), path)
    require_output(path)
    known = _registry(registry)
    if mesh.corner_uv is not None and not keeps_textures(path, known, format):
        warnings.warn(f"{path}: this format holds no texture coordinates; left out", stacklevel=2)
        mesh = replace(mesh, corner_uv=None)
    if mesh.marked is not None and not keeps_marks(path, known, format):
        warnings.warn(f"{path}: this format holds no edges marked as sharp; left out", stacklevel=2)
        mesh = replace(mesh, marked=None)
    _write_whole(path, _component(path, known, "writer", format, options), mesh)


def export(
    path: Path, surface: OrbifoldSurface, registry: Components, *, options: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Write a surface itself, exactly, by the exporter of the file's suffix with its options; what it says of the file.

    The file appears whole or not at all, as in `write`. Raises FormatError where the place is unfit or the exporter
    fails, FitError for a surface with a boundary, or without exact patches where these are asked for.
    """
    path = Path(path)
    require_output(path)
    if (options or {}).get("exact", True):
        require_no_boundary(path, open_=surface.triangulation.inside is not None)
    return dict(_write_whole(path, _component(path, registry, "exporter", None, options), surface) or {})


def require_no_boundary(path: Path, *, open_: bool) -> None:
    """Raise FitError for a surface with a boundary, which cuts exact patches and those of G+Smo in two."""
    if open_:
        raise FitError(
            f"{path}: the surface has a boundary, which exact patches do not follow; write a few faces that end there, "
            "to part.step without --exact, or curved triangles, to part.vtu with --order 3, or close the mesh first"
        )


def write_elements(path: Path, mesh: CurvedMesh, registry: Components, *, format: str | None = None) -> None:
    """Write curved triangles, by the format of elements of the file's suffix or by the one that `format` names.

    The file appears whole or not at all, and errors are as in `write`.
    """
    path = Path(path)
    require_output(path)
    _write_whole(path, _component(path, registry, "elements", format, None), mesh)


def exports(path: Path, registry: Components) -> bool:
    """Whether an exporter writes files with this suffix."""
    return any(path.suffix.lower() in c.suffixes for c in registry.components("exporter"))


def keeps_textures(path: Path, registry: Components, format: str | None = None) -> bool:
    """Whether the writer of a file keeps the texture coordinates of corners."""
    return registry.component("writer", component_name(path, registry, "writer", format)).textures


def keeps_marks(path: Path, registry: Components, format: str | None = None) -> bool:
    """Whether the writer of a file keeps edges that are marked as sharp."""
    return registry.component("writer", component_name(path, registry, "writer", format)).marks


def _mesh(given: object, path: Path) -> Polyhedron:
    """The polyhedron of what is to be written. Raises FormatError, naming the file, where it is no mesh."""
    try:
        return Polyhedron.of(given)
    except (TopologyError, UsageError) as error:
        raise FormatError(f"{path}: {error}") from error


def _registry(given: Components | None) -> Components:
    return Registry.discover() if given is None else given


# ---- which component ----------------------------------------------------------------------------------------------


def component_name(path: Path, registry: Components, kind: str, format: str | None) -> str:
    """The name of the reader or writer for a file: `format` if given, else the only one that declares the suffix.

    Raises FormatError for a suffix that none declares, PluginError for one that several do, UsageError for an unknown
    format.
    """
    if format is not None:
        registry.component(kind, format)
        return format
    suffix = located(path).suffix.lower()
    names = [c.name for c in registry.for_suffix(kind, suffix)]
    if not names:
        raise FormatError(_unknown(path, suffix, kind, registry))
    if len(names) > 1:
        raise PluginError(
            f"{path}: the {_plural(kind)} {', '.join(names)} claim '{suffix}'; name one of them as the format"
        )
    return names[0]


def _component(
    path: Path, registry: Components, kind: str, format: str | None, options: Mapping[str, Any] | None
) -> Callable[..., object]:
    target = registry.load(kind, component_name(path, registry, kind, format))
    return partial(target, **checked_options(target, options, kind, {})) if options else target


def _unknown(path: Path, suffix: str, kind: str, registry: Components) -> str:
    known = sorted({s for c in registry.components(kind) for s in c.suffixes})
    listed = f"the {_plural(kind)} know {' '.join(known)}" if known else f"there is no {kind}"
    found = f"the suffix '{suffix}' is not known" if suffix else "the name has no suffix"
    return f"{path}: {found}; {listed}. Name the format where the suffix does not say it.{did_you_mean(suffix, known)}"


def _plural(kind: str) -> str:
    return "formats of elements" if kind == "elements" else f"{kind}s"


def _guarded(path: Path, doing: str, component: Callable[..., object], *arguments: object) -> Any:
    """Call a reader or writer; what it raises becomes a FormatError that names the file and shows its words escaped."""
    try:
        return component(*arguments)
    except (FitError, FormatError, PluginError) as error:
        parts = str(error).split(str(arguments[0]))
        raise type(error)(str(path).join(shown(part) for part in parts)) from error
    except (Exception, SystemExit) as error:
        raise FormatError(f"{path}: {doing} failed: {shown(_described(error))}") from error


def _write_whole(path: Path, writer: Callable[..., object], content: object) -> Any:
    with output(path) as made:
        return _guarded(path, "writing", writer, made, content)


def _described(error: BaseException) -> str:
    if isinstance(error, SystemExit):
        return "the library for this format tried to end the program; the file is not what it expects"
    if isinstance(error, MemoryError):
        return "it asks for more memory than there is; are the counts in the file right?"
    if isinstance(error, (LookupError, AssertionError, AttributeError, TypeError)):
        return "it stopped at something that it did not expect; is the file damaged? --debug shows where"
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
