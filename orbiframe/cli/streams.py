"""Streams: meshes from the standard input and to the standard output, and formats chosen by name or by suffix."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TextIO

from orbiframe.components.registry import Registry
from orbiframe.errors import FormatError, PluginError, UsageError

if TYPE_CHECKING:
    from orbiframe.meshes.polyhedron import Polyhedron

STREAM = Path("-")
_BLOCK = 2**20


class Choice(NamedTuple):
    """A reader or writer that the user names, and the suffix that its files need; None for what the file says."""

    component: str | None = None
    suffix: str | None = None


def choice(kind: str, name: str | None, registry: Registry) -> Choice:
    """The reader or writer of a name ("ply", "meshio") or of a suffix ("vtk", ".vtk").

    Raises UsageError for neither.
    """
    if name is None:
        return Choice()
    suffix = f".{name.lstrip('.').lower()}"
    for component in registry.components(kind):
        if name == component.name:
            return Choice(name, component.suffixes[0] if len(component.suffixes) == 1 else None)
    for component in registry.for_suffix(kind, suffix):
        return Choice(component.name, suffix)
    return Choice(registry.component(kind, name).name)


def read(
    path: Path,
    registry: Registry,
    format: str | None = None,
    *,
    options: Mapping[str, Any] | None = None,
    degenerate: bool = False,
) -> Polyhedron:
    """The polyhedron of a file, or of the standard input for `-`; see `gate.read`.

    format: a name of a reader or a suffix.
    """
    from orbiframe.files import gate, places

    chosen = choice("reader", format, registry)
    given: dict[str, Any] = {"format": chosen.component, "options": options, "degenerate": degenerate}
    if path == STREAM:
        _require_named(chosen, "input", "-i")
        with _staged(f"stdin{chosen.suffix}", "stdin") as place:
            _receive(place, places.SIZE_LIMIT)
            return gate.read(place, registry, **given)
    if chosen.suffix in (None, path.suffix.lower()):
        return gate.read(path, registry, **given)
    places.require_readable(path)
    with _staged(f"{path.stem}{chosen.suffix}", str(path)) as place:
        place.symlink_to(path.absolute())
        return gate.read(place, registry, **given)


def write(
    path: Path,
    polyhedron: Polyhedron,
    registry: Registry,
    format: str | None = None,
    *,
    options: Mapping[str, Any] | None = None,
) -> None:
    """Write a polyhedron to a file, or to the standard output for `-`; see `gate.write`.

    format: a name of a writer or a suffix. What goes to the standard output is made whole first.
    """
    from orbiframe.files import gate, outputs

    chosen = choice("writer", format, registry)
    if path != STREAM and chosen.suffix in (None, path.suffix.lower()):
        gate.write(path, polyhedron, registry, format=chosen.component, options=options)
        return
    _require_named(chosen, "output", "-o")
    if path != STREAM:
        outputs.require_output(path)
    name = "stdout" if path == STREAM else str(path)
    with _staged(f"{Path(name).stem}{chosen.suffix}", name) as place:
        gate.write(place, polyhedron, registry, format=chosen.component, options=options)
        _require_one_file(place, name)
        _send(place, path)


def _require_named(chosen: Choice, noun: str, option: str) -> None:
    if chosen.suffix is None:
        raise UsageError(
            f"the format of the standard {noun} must be said: add {option} with a suffix, such as {option} ply"
        )


@contextmanager
def _staged(file: str, name: str) -> Iterator[Path]:
    """A place for a file in a folder of its own; errors name what the user knows instead of it."""
    from orbiframe.files.temporary_folder import temporary_folder

    with temporary_folder() as folder:
        place = folder / file
        try:
            yield place
        except (FormatError, PluginError) as error:
            raise type(error)(str(error).replace(str(place), name)) from error.__cause__


def _require_open(stream: TextIO | None, noun: str) -> None:
    if stream is None:
        raise FormatError(f"the standard {noun} is closed; name a file, or connect it")


def _receive(place: Path, limit: int) -> None:
    _require_open(sys.stdin, "input")
    with place.open("wb") as file:
        while block := _block():
            file.write(block)
            if file.tell() > limit:
                raise FormatError(f"{place}: there are more bytes than the limit of {limit}")


def _block() -> bytes:
    try:
        return sys.stdin.buffer.read(_BLOCK)
    except OSError as error:
        raise FormatError(f"the standard input cannot be read: {error.strerror}; connect it to a mesh") from error


def _send(place: Path, path: Path) -> None:
    from orbiframe.files.outputs import output

    if path == STREAM:
        _require_open(sys.stdout, "output")
        with place.open("rb") as file:
            shutil.copyfileobj(file, sys.stdout.buffer)
        sys.stdout.buffer.flush()
        return
    with output(path) as made:
        shutil.copyfile(place, made)


def _require_one_file(place: Path, name: str) -> None:
    companions = sorted(found.name for found in place.parent.iterdir() if found != place)
    if companions:
        raise FormatError(
            f"{name}: this format makes further files ({', '.join(companions)}); name a file of its suffix"
        )
