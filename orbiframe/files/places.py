"""Places: whether a file can be read or written, asked before the work begins."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import FormatError

if TYPE_CHECKING:
    pass

SIZE_LIMIT = 2**32


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


def _behind_links(path: Path) -> Path:
    """Through a link the file behind it is written, as by any other program."""
    return Path(os.path.realpath(path)) if path.is_symlink() else path
