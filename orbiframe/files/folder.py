"""Folders that outputs go to: made where they are not there."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from orbiframe.errors import FormatError
from orbiframe.files.places import species


def require_folder(path: Path) -> None:
    """Raise FormatError unless files can be written to a folder of this path, or it can be made."""
    try:
        there = next(each for each in (path, *path.absolute().parents) if os.path.lexists(each))
        mode = there.stat().st_mode
    except (OSError, ValueError) as error:
        raise FormatError(f"the folder {path} cannot be made: {error}; name another one") from error
    if not there.is_dir():
        raise FormatError(f"{path} cannot be written: {there} is {_species(mode)}; name a folder")
    if not os.access(there, os.W_OK):
        raise FormatError(f"the folder {path} cannot be written to; name another one")


def _species(mode: int) -> str:
    return "a file" if stat.S_ISREG(mode) else species(mode)


def make_folder(path: Path) -> None:
    """Make a folder where it is not there. Raises FormatError where that is not possible."""
    require_folder(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FormatError(f"the folder {path} cannot be made: {error.strerror}; name another one") from error
