"""Destinations: whether a file can be written, asked before the long work begins."""

from __future__ import annotations

from pathlib import Path

from orbiframe.components.registry import Registry
from orbiframe.errors import FormatError, UsageError
from orbiframe.files.outputs import require_output


def require_destination(path: Path, registry: Registry, format: str | None = None, *, kind: str = "writer") -> None:
    """Raise FormatError unless a writer takes the file (by its suffix, or the named format) and it can be made."""
    from orbiframe.files.gate import component_name, exports

    require_output(path)
    if kind == "writer" and format is None and exports(path, registry):
        _require_writer(path, registry)
    name = component_name(path, registry, kind, format)
    if kind == "exporter":
        registry.load(kind, name)  # a missing library is found before the fit, not after it


def require_textures(path: Path, registry: Registry, format: str | None = None) -> None:
    """Raise UsageError unless the writer of the file keeps texture coordinates."""
    from orbiframe.files.gate import keeps_textures

    if not keeps_textures(path, registry, format):
        known = sorted({s for c in registry.components("writer") if c.textures for s in c.suffixes})
        raise UsageError(f"{path}: this format holds no texture coordinates; write {', '.join(known)}")


def require_picture(path: Path, name: str, registry: Registry) -> None:
    """Raise UsageError unless the picture can have the suffix of the file, FormatError where the place is unfit.

    Raises PluginError where what draws it cannot be imported.
    """
    suffixes = registry.component("picture", name).suffixes
    require_output(path)
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
