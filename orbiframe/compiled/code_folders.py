"""Code folders: where machine code is kept, and whose code is trusted."""

from __future__ import annotations

import contextlib
import hashlib
import os
import stat
import sys
import tempfile
import warnings
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple
from uuid import uuid4

_OTHERS_WRITE, _GROUP_WRITES = stat.S_IWOTH, stat.S_IWGRP


class CodeFolder(NamedTuple):
    """A folder for machine code.

    private: it belongs to the user alone, and holds the code of many programs; otherwise it lies beside one program and
    is trusted as that is. lasting: nobody empties it.
    """

    path: Path
    private: bool
    lasting: bool


def code_folders(source: Path) -> list[CodeFolder]:
    """The folders for the functions of a file, in the order in which they are tried.

    `__pycache__` beside the file, the user's own folder for such things, and a temporary one. The environment variable
    NUMBA_CACHE_DIR stands for the first two.
    """
    named = os.environ.get("NUMBA_CACHE_DIR", "")
    lasting, temporary = named or _user_folder(), _temporary_folder()
    folders = [] if named else [CodeFolder(source.parent / "__pycache__", False, True)]
    folders += [CodeFolder(Path(lasting) / "orbiframe", True, True)] if lasting else []
    return folders + ([CodeFolder(temporary, True, False)] if temporary else [])


def read_code(source: Path, name: str) -> Iterator[bytes]:
    """The contents of all files of this name in folders that can be trusted."""
    for folder in code_folders(source):
        with contextlib.suppress(OSError):
            _require_trusted(folder, source)
            yield _file(folder, source, name).read_bytes()


def write_code(source: Path, name: str, content: bytes) -> None:
    """Write a file into the first folder that takes it; warns, once, where none does or only one that does not last."""
    folders = code_folders(source)
    for folder in folders:
        with contextlib.suppress(OSError):
            folder.path.mkdir(mode=0o700 if folder.private else 0o777, parents=folder.private, exist_ok=True)
            _require_trusted(folder, source)
            _write(_file(folder, source, name), content)
            if not folder.lasting:
                _warn(f"for a while in {folder.path}, where it may be deleted")
            return
    _warn("not at all, so that every run compiles again")


def _file(folder: CodeFolder, source: Path, name: str) -> Path:
    """A folder of many programs holds files of one name, which differ by the place of their sources."""
    place = hashlib.sha256(str(source.resolve().parent).encode()).hexdigest()[:16]
    return folder.path / (f"{place}-{name}" if folder.private else name)


def _write(file: Path, content: bytes) -> None:
    """Put a file in its place whole."""
    passing = file.with_name(f"{file.name}.{uuid4().hex[:16]}")
    try:
        passing.write_bytes(content)
        passing.replace(file)
    except OSError:
        passing.unlink(missing_ok=True)
        raise


def _require_trusted(folder: CodeFolder, source: Path) -> None:
    """Raise OSError for a folder where somebody can have put code whom the user and the program do not depend on."""
    if not hasattr(os, "getuid"):
        return
    found = folder.path.lstat()
    owners = {os.getuid()} if folder.private else {os.getuid(), 0, source.stat().st_uid}
    others = _OTHERS_WRITE | _GROUP_WRITES if folder.private else _OTHERS_WRITE
    if not stat.S_ISDIR(found.st_mode) or found.st_uid not in owners or found.st_mode & others:
        raise PermissionError(f"{folder.path} may hold code of other users")


def _user_folder() -> str | None:
    """The folder of the user for what can be made again, as the system has it; None where there is none."""
    if sys.platform == "win32":
        return os.environ.get("LOCALAPPDATA")
    named = os.environ.get("XDG_CACHE_HOME", "")
    home = os.path.expanduser("~")
    if os.path.isabs(named) or not os.path.isabs(home):
        return named if os.path.isabs(named) else None
    return os.path.join(home, "Library/Caches" if sys.platform == "darwin" else ".cache")


def _temporary_folder() -> Path | None:
    user = os.getuid() if hasattr(os, "getuid") else "user"
    with contextlib.suppress(OSError):
        return Path(tempfile.gettempdir()) / f"orbiframe-{user}"
    return None


@cache
def _warn(where: str) -> None:
    warnings.warn(
        f"compiled code can be kept neither beside the program nor in the folder of the user: it is kept {where}; "
        "to end this, name a folder of yours that can be written to in the environment variable NUMBA_CACHE_DIR",
        stacklevel=2,
    )
