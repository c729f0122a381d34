"""Places: whether a file can be read, asked before the work begins."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import FormatError

SIZE_LIMIT = 2**32


# ---- before a reader, round any component -------------------------------------------------------------------------


def require_readable(path: Path, size_limit: int = SIZE_LIMIT, *, empty: bool = False) -> None:
    """Raise FormatError unless there is a regular file that is no larger than the limit (in bytes), nor empty.

    empty: let an empty file pass.
    """
    try:
        status = path.stat()
    except (OSError, ValueError) as error:
        raise FormatError(_absent(path, error)) from error
    if not stat.S_ISREG(status.st_mode):
        raise FormatError(f"{path}: this is {species(status.st_mode)}, but a regular file is required")
    if status.st_size == 0 and not empty:
        raise FormatError(f"{path}: the file is empty")
    if status.st_size > size_limit:
        raise FormatError(
            f"{path}: the file has {status.st_size} bytes, more than the limit of {size_limit}; raise the limit"
        )


def _absent(path: Path, error: Exception) -> str:
    if not isinstance(error, FileNotFoundError):
        return f"{path}: the file cannot be reached: {error}"
    if path.is_symlink():
        return f"{path}: this is a link to {os.readlink(path)}, which is not there"
    folder = path.parent
    siblings = os.listdir(folder) if folder.is_dir() and os.access(folder, os.R_OK) else []
    return f"{path}: there is no such file.{did_you_mean(path.name, siblings)}"


def species(mode: int) -> str:
    """What a path leads to, in words, from the mode of its status."""
    kinds = {stat.S_IFDIR: "a folder", stat.S_IFIFO: "a pipe", stat.S_IFCHR: "a device", stat.S_IFBLK: "a device"}
    return kinds.get(stat.S_IFMT(mode), "no regular file")
