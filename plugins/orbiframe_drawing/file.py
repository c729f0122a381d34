"""Pictures into files: the suffix chooses the format, and the file appears whole or not at all."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from orbiframe import UsageError
from orbiframe.files import require_output, write_bytes
from orbiframe_drawing.picture import Picture
from orbiframe_drawing.plot import pdf_bytes, png_bytes
from orbiframe_drawing.svg import svg_text

_FORMATS: dict[str, Callable[[Picture], bytes]] = {
    ".svg": lambda picture: svg_text(picture).encode("utf-8"),
    ".png": png_bytes,
    ".pdf": pdf_bytes,
}


def require_picture_file(path: Path) -> None:
    """Raise UsageError for a suffix of no picture, FormatError where the file cannot be made."""
    if path.suffix.lower() not in _FORMATS:
        raise UsageError(f"{path} is no file for a picture; give it the suffix {', '.join(_FORMATS)}")
    require_output(path)


def save_picture(picture: Picture, path: str | Path) -> None:
    """Write a picture as .svg, .png or .pdf; PNG and PDF need matplotlib.

    The same picture gives the same bytes, with one version of matplotlib. Raises UsageError for another suffix,
    FormatError for a file that cannot be written, PluginError where matplotlib is missing.
    """
    target = Path(path)
    require_picture_file(target)
    write_bytes(target, _FORMATS[target.suffix.lower()](picture))
