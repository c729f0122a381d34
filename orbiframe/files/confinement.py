"""Confinement: a process that from now on opens the files it was given and its own program, and nothing else."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
from collections.abc import Iterable
from pathlib import Path

# Numbers of system calls of Linux 5.13 and later, alike on all machines; rights as in linux/landlock.h.
CREATE, ADD, RESTRICT = 444, 445, 446
NO_NEW_RIGHTS = 38
EXECUTE, WRITE_FILE, READ_FILE, READ_DIR, TRUNCATE = 1, 2, 4, 8, 1 << 14
FIRST_RIGHTS = (1 << 13) - 1
ON_FILES = EXECUTE | WRITE_FILE | READ_FILE | TRUNCATE
READING = EXECUTE | READ_FILE | READ_DIR
# Where programs and their libraries are, beside those of Python.
SYSTEM = ("/usr", "/lib", "/lib64", "/proc", "/sys", "/dev", "/etc/ld.so.cache", "/opt")
# What a reader of files has no business with.
FORBIDDEN = ("socket.connect", "socket.bind", "subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "os.fork")


def confine(readable: Iterable[Path], writable: Iterable[Path]) -> None:
    """Let this process open only these files to read, files in these folders to write, and its own program.

    The kernel refuses all others where it can (Landlock, Linux 5.13), for libraries in C too; calls from Python are
    refused everywhere. Opening another file raises PermissionError. There is no way back.
    """
    files, folders = [Path(os.path.realpath(p)) for p in readable], [Path(os.path.realpath(p)) for p in writable]
    program = [
        Path(os.path.realpath(p)) for p in {*sys.path, sys.prefix, sys.base_prefix, *SYSTEM} if os.path.exists(p)
    ]
    _ask_kernel(files, folders, program)
    _ask_python(files, folders, program)


def _ask_python(files: list[Path], folders: list[Path], program: list[Path]) -> None:
    def listen(event: str, arguments: tuple[object, ...]) -> None:
        if event in FORBIDDEN:
            raise PermissionError(f"{event} is not allowed while a file is read")
        if event == "open" and isinstance(arguments[0], (str, bytes)):
            place = Path(os.path.realpath(os.fsdecode(arguments[0])))
            if place not in files and not any(place.is_relative_to(p) for p in (*folders, *program)):
                raise PermissionError("the file names another one, which is not opened")

    sys.addaudithook(listen)


# ---- Landlock -----------------------------------------------------------------------------------------------------


class _Ruleset(ctypes.Structure):
    _fields_ = (("handled", ctypes.c_uint64),)


class _Rule(ctypes.Structure):
    _pack_ = 1
    _layout_ = "ms"
    _fields_ = (("allowed", ctypes.c_uint64), ("descriptor", ctypes.c_int32))


def _ask_kernel(files: list[Path], folders: list[Path], program: list[Path]) -> None:
    if not sys.platform.startswith("linux"):
        return
    library = ctypes.CDLL(None)
    version = library.syscall(CREATE, None, 0, 1)
    if version < 1:
        return
    rights = FIRST_RIGHTS | (TRUNCATE if version >= 3 else 0)
    ruleset = _Ruleset(rights)
    descriptor = library.syscall(CREATE, ctypes.byref(ruleset), ctypes.sizeof(ruleset), 0)
    if descriptor < 0:
        return
    try:
        for places, allowed in ((files, READ_FILE), (folders, rights), (program, READING)):
            for place in places:
                _allow(library, descriptor, place, allowed & rights)
        _allow(library, descriptor, Path("/dev/null"), (READ_FILE | WRITE_FILE | TRUNCATE) & rights)
        if library.prctl(NO_NEW_RIGHTS, 1, 0, 0, 0) == 0:
            library.syscall(RESTRICT, descriptor, 0)
    finally:
        os.close(descriptor)


def _allow(library: ctypes.CDLL, ruleset: int, place: Path, allowed: int) -> None:
    with contextlib.suppress(OSError):
        handle = os.open(place, os.O_PATH | os.O_CLOEXEC)
        try:
            rule = _Rule(allowed if place.is_dir() else allowed & ON_FILES, handle)
            library.syscall(ADD, ruleset, 1, ctypes.byref(rule), 0)
        finally:
            os.close(handle)
