"""Outputs: everything that is written appears whole or not at all, and never in place of what it must not replace.

Meshes, exact surfaces, surface files, reports, loops and pictures all come through here.
"""

from __future__ import annotations

import os
import shutil
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from orbiframe.errors import FormatError, UsageError
from orbiframe.files.places import species
from orbiframe.files.temporary_folder import temporary_folder


def require_output(path: Path) -> None:
    """Raise FormatError unless a file of this path can be made, or a regular one replaced.

    Through a link it is the file behind the link. Devices, pipes and folders are never replaced.
    """
    try:
        folder = _behind_links(path).parent
        there = path.stat() if _exists(path) else None
        if not folder.is_dir():
            raise FormatError(f"{path} cannot be written: there is no folder {folder}; make it first")
    except (OSError, ValueError) as error:
        raise FormatError(f"{path} cannot be written: {_reason(error)}") from error
    if there is not None and not stat.S_ISREG(there.st_mode):
        raise FormatError(
            f"{path} cannot be written: it is {species(there.st_mode)}; only regular files are written, name one"
        )
    if there is not None and not os.access(path, os.W_OK):
        raise FormatError(f"{path} cannot be written: it is there and may not be changed; name another file")
    if not os.access(folder, os.W_OK):
        raise FormatError(f"{path} cannot be written: no permission to write in {folder}")


def require_apart(outputs: Mapping[str, Path | None], inputs: Mapping[str, Path | None]) -> None:
    """Raise UsageError if two files, named by what the user calls them, are one and one of them is written."""
    seen: dict[Path | tuple[int, int], str] = {}
    for name, path in (*inputs.items(), *outputs.items()):
        if path is None:
            continue
        mark = _identity(path)
        if mark in seen and name in outputs:
            other = seen[mark]
            if other in inputs:
                raise UsageError(f"{path} is {other} itself; give {name} another file")
            raise UsageError(f"{path} is named by {other} and by {name}; give each a file of its own")
        seen[mark] = name


@contextmanager
def output(path: Path) -> Iterator[Path]:
    """A place for a file, of the same name, in a folder of its own; at the end of the block it is moved to `path`.

    Whatever else lies in the folder is moved along, but replaces only what the old file names (as a glTF file names its
    buffer). What is replaced keeps its mode and its links. Raises FormatError for a place that cannot be written, a
    block that leaves no file, and any OSError on the way; the old file is left as it was.
    """
    require_output(path)
    try:
        target = _behind_links(path)
        with temporary_folder(target.parent) as folder:
            made = folder / path.name
            yield made
            _require_made(made, path)
            companions = [found for found in sorted(folder.iterdir()) if found != made]
            _require_own(companions, target)
            for companion in companions:
                _move(companion, target.parent / companion.name)
            _move(made, target)
    except OSError as error:
        raise FormatError(f"{path} cannot be written: {_reason(error)}") from error


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file; see `output`."""
    with output(path) as made:
        made.write_bytes(content)


def write_text(path: Path, text: str) -> None:
    """Write a text in UTF-8; see `output`."""
    write_bytes(path, text.encode("utf-8", errors="backslashreplace"))


def _exists(path: Path) -> bool:
    """Whether there is something at the path, behind links; a link to nothing is a file to be made."""
    try:
        path.stat()
    except FileNotFoundError:
        return False
    return True


def _behind_links(path: Path) -> Path:
    """Through a link the file behind it is written, as by any other program."""
    return Path(os.path.realpath(path)) if path.is_symlink() else path


def _identity(path: Path) -> Path | tuple[int, int]:
    """What is equal for two names of one file; a file that is not there yet is known by its folder and name."""
    try:
        status = path.stat()
        return status.st_dev, status.st_ino
    except (OSError, ValueError):
        return Path(os.path.realpath(path))


def _require_made(made: Path, path: Path) -> None:
    if not made.is_file() or made.stat().st_size == 0:
        raise FormatError(f"{path}: the writer of this format made no file; choose another format")


def _require_own(companions: list[Path], target: Path) -> None:
    """Raise FormatError if a further file would replace one that does not belong to the old file."""
    there = [found.name for found in companions if os.path.lexists(target.parent / found.name)]
    if not there:
        return
    old = target.read_bytes() if target.is_file() else b""
    for name in there:
        place = target.parent / name
        if place.is_symlink() or not place.is_file() or os.fsencode(name) not in old:
            raise FormatError(
                f"{target} cannot be written: this format needs the file {place} beside it, which is there and not "
                "part of what is replaced; move it away, or give another name"
            )


def _move(made: Path, target: Path) -> None:
    """Put a finished file in its place; one that is replaced keeps its mode, and its other names if it has any."""
    if not target.exists():
        made.replace(target)
        return
    status = target.stat()
    if status.st_nlink > 1:
        _pour(made, target, status.st_size)
        return
    made.chmod(stat.S_IMODE(status.st_mode))
    made.replace(target)


def _pour(made: Path, target: Path, size: int) -> None:
    """The content of a file into one that has several names; the room for it is taken before the old one is lost."""
    with made.open("rb") as source, target.open("r+b") as file:
        length = os.fstat(source.fileno()).st_size
        if length > size and hasattr(os, "posix_fallocate"):
            try:
                os.posix_fallocate(file.fileno(), size, length - size)
            except OSError:
                file.truncate(size)
                raise
        shutil.copyfileobj(source, file)
        file.truncate()


def _reason(error: Exception) -> str:
    return (error.strerror or str(error)) if isinstance(error, OSError) else str(error)
