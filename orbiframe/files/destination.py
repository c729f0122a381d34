"""Destinations: whether a file can be written, asked before the long work begins."""

from __future__ import annotations

import os
from pathlib import Path

from orbiframe.components.registry import Registry
from orbiframe.errors import FormatError, UsageError


def require_destination(path: Path, registry: Registry, format: str | None = None, *, kind: str = "writer") -> None:
    """Raise FormatError unless a writer takes the file (by its suffix, or the named format) and it can be made."""
    from orbiframe.files.gate import component_name, exports

    require_folder(path)
    if kind == "writer" and format is None and exports(path, registry):
        _require_writer(path, registry)
    name = component_name(path, registry, kind, format)
    if kind == "exporter":
        registry.load(kind, name)  # a missing library is found before the fit, not after it


def require_picture(path: Path, name: str, registry: Registry) -> None:
    """Raise UsageError unless the picture can have the suffix of the file, FormatError where the place is unfit.

    Raises PluginError where what draws it cannot be imported.
    """
    suffixes = registry.component("picture", name).suffixes
    require_folder(path)
    if path.suffix.lower() not in suffixes:
        raise UsageError(f"{path} is no file for a picture; give it the suffix {', '.join(suffixes)}")
    registry.load("picture", name)


def _require_writer(path: Path, registry: Registry) -> None:
    """Raise FormatError for a format that holds exact surfaces only."""
    if not any(path.suffix.lower() in c.suffixes for c in registry.components("writer")):
        raise FormatError(
            f"{path} holds exact surfaces, which need piecewise polynomials from `orbiframe fit`: add --basis ps2 or "
            "--basis ps6; a mesh goes to a file such as surface.ply"
        )


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
