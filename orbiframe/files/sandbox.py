"""Confinement: a library that may crash, hang or ask for all memory is called in a process of its own."""

from __future__ import annotations

import importlib
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import FormatError, OrbiframeError, PluginError
from orbiframe.files.confinement import confine
from orbiframe.files.temporary_folder import temporary_folder
from orbiframe.meshes.polyhedron import Polyhedron

SECONDS = 60.0
# Beside what the libraries take: room for small files, and for each byte of a larger one so many.
MEMORY, FACTOR = 2**28, 64
TABLES = ("vertices", "offsets", "tail", "normals", "colors", "face_colors")
# Exit statuses of the child that say what its last words are.
NAMES_ANOTHER = "the file names another one, which is not opened"
STATUS = {FormatError: 65, PluginError: 69}


def confined_read(target: str, path: Path, *, seconds: float = SECONDS, memory: int = MEMORY) -> Polyhedron:
    """What the function `target` ("package.module:function") makes of a file, called in a process of its own.

    seconds, memory: the most time and the most bytes of memory that the process may take for a small file; a larger one
    gets a second more for each megabyte and 64 bytes for each byte. Memory is counted from the import of the target's
    module on, where the system can limit it. The process can open no other file, see `confinement.confine`. Raises
    FormatError if the process ends in any way but well; FormatError and PluginError of the function are passed on.
    """
    with temporary_folder() as folder:
        parcel = folder / "polyhedron.npz"
        _run("read", target, path, parcel, *_limits(path, seconds, memory))
        return _unpacked(parcel)


def confined_tables(
    target: str, path: Path, *, seconds: float = SECONDS, memory: int = MEMORY
) -> dict[str, NDArray[Any]]:
    """The named arrays, of numbers or text, that the function `target` makes of a file; see `confined_read`."""
    with temporary_folder() as folder:
        parcel = folder / "tables.npz"
        _run("tables", target, path, parcel, *_limits(path, seconds, memory))
        with np.load(parcel, allow_pickle=False) as tables:
            return dict(tables)


def confined_write(
    target: str, path: Path, polyhedron: Polyhedron, *, seconds: float = SECONDS, memory: int = MEMORY
) -> None:
    """Call the function `target` with a path and a polyhedron in a process of its own; see `confined_read`."""
    with temporary_folder() as folder:
        parcel = folder / "polyhedron.npz"
        _pack(parcel, polyhedron)
        _run("write", target, path, parcel, *_limits(parcel, seconds, memory))


def _limits(path: Path, seconds: float, memory: int) -> tuple[float, int]:
    size = path.stat().st_size if path.is_file() else 0
    return seconds + size / 2**20, memory + FACTOR * size


def _run(verb: str, target: str, path: Path, parcel: Path, seconds: float, memory: int) -> None:
    words = [verb, target, str(path.absolute()), str(parcel), str(memory)]
    # -P: no module in the current folder may stand in for an installed one.
    command = [sys.executable, "-P", "-m", "orbiframe.files.sandbox", *words]
    try:
        done = subprocess.run(command, capture_output=True, stdin=subprocess.DEVNULL, timeout=seconds, check=False)
    except subprocess.TimeoutExpired as error:
        raise FormatError(f"{path}: the library for this format took more than {seconds:g} seconds; stopped") from error
    if done.returncode == 0:
        return
    words = done.stderr.decode("utf-8", errors="replace").strip().splitlines()
    for kind, status in STATUS.items():
        if done.returncode == status:
            raise kind(words[-1].replace(str(path.absolute()), str(path)) if words else str(path))
    raise FormatError(
        f"{path}: the library for this format {_ending(done.returncode)}; the file is not what it expects"
    )


def _ending(status: int) -> str:
    if status >= 0:
        return f"ended its process with status {status}"
    return f"crashed ({signal.Signals(-status).name})" if -status in list(signal.Signals) else "crashed"


def _pack(parcel: Path, polyhedron: Polyhedron) -> None:
    tables = {name: getattr(polyhedron, name) for name in TABLES}
    np.savez(parcel, **{name: table for name, table in tables.items() if table is not None})


def _unpacked(parcel: Path) -> Polyhedron:
    with np.load(parcel, allow_pickle=False) as tables:
        return Polyhedron.from_corners(**{name: tables[name] for name in TABLES if name in tables})


# ---- inside the process -------------------------------------------------------------------------------------------


def main(verb: str, target: str, path: str, parcel: str, memory: str) -> int:
    """Call the target; what stops it is said in one line on the standard error stream."""
    module, _, name = target.partition(":")
    function = getattr(importlib.import_module(module), name)
    _limit_memory(int(memory))
    place, folders = Path(path), [Path(parcel).parent]
    confine([place], [*folders, place.parent] if verb == "write" else folders)
    try:
        if verb == "read":
            _pack(Path(parcel), function(Path(path)))
        elif verb == "tables":
            np.savez(parcel, **function(Path(path)))
        else:
            function(Path(path), _unpacked(Path(parcel)))
    except OrbiframeError as error:
        return _said(str(error), STATUS.get(type(error), STATUS[FormatError]))
    except MemoryError:
        return _said(f"{path}: the library asks for more memory than allowed; are the counts in the file right?")
    except SystemExit:
        return _said(f"{path}: the library for this format ended its process; the file is not what it expects")
    except PermissionError as error:
        return _said(f"{path}: {error.args[0] if len(error.args) == 1 else NAMES_ANOTHER}")
    except Exception:
        # What a library says of its own errors, such as KeyError, helps nobody.
        return _said(f"{path}: the library for this format cannot make sense of the file; is it damaged?")
    return 0


def _said(words: str, status: int = STATUS[FormatError]) -> int:
    print(" ".join(words.split()), file=sys.stderr)
    return status


def _limit_memory(size: int) -> None:
    """No more memory than what is in use now and so many bytes."""
    try:
        import resource

        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except (ImportError, OSError):  # not on Windows, not on macOS
        return
    size += pages * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (size if hard < 0 else min(size, hard), hard))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
