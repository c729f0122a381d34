"""Destinations: whether a file can be written, asked before the long work begins."""

from __future__ import annotations

import os
from pathlib import Path

from orbiframe.errors import FormatError, UsageError
from orbiframe.registry import Registry


def require_destination(path: Path, registry: Registry, format: str | None = None) -> None:
    """Raise FormatError unless a writer takes the file (by its suffix, or the named format) and it can be made."""
    from orbiframe.formats import component_name

    require_folder(path)
    component_name(path, registry, "writer", format)


def require_folder(path: Path) -> None:
    """Raise FormatError unless a file of this path can be made or replaced in its folder."""
    folder = path.parent
    if not folder.is_dir():
        raise FormatError(f"{path} cannot be written: there is no folder {folder}; make it first")
    if path.is_dir():
        raise FormatError(f"{path} cannot be written: it is a folder; name a file")
    if not os.access(folder, os.W_OK):
        raise FormatError(f"{path} cannot be written: no permission to write in {folder}")


def require_other_file(path: Path, source: Path) -> None:
    """Raise UsageError if a file would be written over the one that is read."""
    if path.exists() and source.exists() and path.samefile(source):
        raise UsageError(f"{path} is the input itself; give the output another name")
