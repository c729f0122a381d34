"""A confined process opens the files it was given and its program; all else is refused, by the kernel where it can."""

from __future__ import annotations

import ctypes
import subprocess
import sys

import pytest

CONFINED = """
import ctypes, os, sys
from pathlib import Path
from orbiframe.files.confinement import confine, _ask_kernel
given, folder, other = map(Path, sys.argv[1:4])
if sys.argv[4] == "kernel":
    _ask_kernel([given], [folder], [Path("/usr"), Path("/proc")])
else:
    confine([given], [folder])
def tried(action):
    try:
        action()
        return "done"
    except PermissionError:
        return "refused"
    except Exception as error:
        return type(error).__name__
c = ctypes.CDLL(None, use_errno=True)
c.fopen.restype = ctypes.c_void_p
c.fopen.argtypes = [ctypes.c_char_p, ctypes.c_char_p]
def by_c(path, mode):
    if not c.fopen(os.fsencode(path), mode):
        raise PermissionError
print(tried(given.read_bytes), tried(other.read_bytes), tried(lambda: given.write_bytes(b"x")),
      tried(lambda: (folder / "new").write_bytes(b"x")), tried(lambda: (other.parent / "new").write_bytes(b"x")),
      tried(lambda: by_c(given, b"r")), tried(lambda: by_c(other, b"r")), tried(lambda: by_c(other, b"w")),
      tried(lambda: os.system("true")))
"""


def kernel_confines() -> bool:
    return sys.platform.startswith("linux") and ctypes.CDLL(None).syscall(444, None, 0, 1) >= 1


def outcomes(tmp_path, way: str) -> list[str]:
    folder, elsewhere = tmp_path / "folder", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.mkdir()
    (tmp_path / "given").write_bytes(b"given")
    (elsewhere / "other").write_bytes(b"other")
    words = [sys.executable, "-c", CONFINED, str(tmp_path / "given"), str(folder), str(elsewhere / "other"), way]
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout.split()


def test_python_opens_what_was_given_and_nothing_else(tmp_path):
    found = outcomes(tmp_path, "both")
    assert found[:2] == ["done", "refused"]
    assert found[3:5] == ["done", "refused"]
    assert found[8] == "refused"


@pytest.mark.skipif(not kernel_confines(), reason="this kernel has no Landlock")
@pytest.mark.parametrize("way", ["kernel", "both"])
def test_the_kernel_refuses_it_to_libraries_in_c_too(tmp_path, way):
    found = outcomes(tmp_path, way)
    assert found[:8] == ["done", "refused", "refused", "done", "refused", "done", "refused", "refused"]
