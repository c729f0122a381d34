"""Kept code is used again only while nothing has changed that it was made of, and only from folders to be trusted."""

from __future__ import annotations

import importlib.util
import itertools
import os
import subprocess
import sys
from pathlib import Path

import pytest

from orbiframe.compiled import code_folders, compilation, fingerprint, kept_code
from orbiframe.compiled.code_folders import CodeFolder

# Two files: a function, and the helper that it calls, whose own helper and constant are in the same file.
CALLER = """
from {helper} import FACTOR, LEVELS, aided
from orbiframe.compiled import compiled

@compiled
def result(x):
    return FACTOR * aided(x) + LEVELS[1]
"""
HELPER = """
import numpy as np
from orbiframe.compiled import compiled

FACTOR = 1
LEVELS = (0, 0)
_SHIFT = np.array([0, 1])

@compiled{options}
def _deep(x):
    return x + _SHIFT[1]

@compiled
def aided(x):
    "A sentence on it."
    return _deep(x)
"""


class Heard:
    """The names of the functions that are compiled."""

    def __init__(self) -> None:
        self.names: list[str] = []

    def begins(self, name: str) -> None:
        self.names.append(name)

    def ends(self) -> None:
        assert compilation.underway == []


class Package:
    """Two modules in a folder, imported anew after each edit, as a new process does; machine code in `kept`."""

    def __init__(self, folder: Path) -> None:
        self.folder, self._numbers = folder, itertools.count()
        self.texts = {"helper": HELPER.format(options=""), "caller": CALLER}

    def run(self, x: object = 1) -> tuple[object, list[str]]:
        """The result, and the functions that had to be compiled for it."""
        helper, heard = self._imported("helper"), Heard()
        sys.modules["helper_of_a_test"] = helper
        caller = self._imported("caller")
        with compilation.heard(heard):
            return caller.result(x), heard.names

    def edit(self, file: str, old: str, new: str) -> None:
        assert old in self.texts[file]
        self.texts[file] = self.texts[file].replace(old, new)

    def _imported(self, file: str):
        path = self.folder / f"{file}.py"
        path.write_text(self.texts[file].format(helper="helper_of_a_test") if file == "caller" else self.texts[file])
        spec = importlib.util.spec_from_file_location(f"{file}_of_a_test", path)
        module = importlib.util.module_from_spec(spec)
        # Not from a cache of Python's own, which looks at seconds.
        exec(compile(path.read_text(), str(path), "exec"), vars(module))
        return module


@pytest.fixture
def package(tmp_path, monkeypatch):
    monkeypatch.setattr(code_folders, "code_folders", lambda source: [CodeFolder(tmp_path / "kept", True, True)])
    yield Package(tmp_path)
    sys.modules.pop("helper_of_a_test", None)


def test_code_is_kept(package):
    assert package.run() == (2, ["result", "aided", "_deep"])
    assert package.run() == (2, [])


EDITS = [
    ("helper", "return x + _SHIFT[1]", "return x + 100", 101),
    ("helper", "return _deep(x)", "return _deep(x) + 1", 3),
    ("helper", "[0, 1]", "[0, 5]", 6),
    ("helper", "FACTOR = 1", "FACTOR = 2", 4),
    ("helper", "(0, 0)", "(0, 10)", 12),
    ("caller", "FACTOR * aided(x)", "aided(x) - FACTOR", 1),
]


@pytest.mark.parametrize(("file", "old", "new", "expected"), EDITS, ids=[f"{e[1]} - {e[2]}" for e in EDITS])
def test_an_edit_is_seen_by_all_who_depend_on_it(package, file, old, new, expected):
    assert package.run()[0] == 2
    package.edit(file, old, new)
    assert package.run()[0] == expected
    assert package.run() == (expected, [])


def test_without_the_fingerprint_of_helpers_an_edit_is_missed(package, monkeypatch):
    """What numba's own cache does: it looks at the caller alone."""
    monkeypatch.setattr(kept_code, "fingerprint", lambda function: fingerprint._own(function)[0])
    assert package.run()[0] == 2
    package.edit("helper", "return x + _SHIFT[1]", "return x + 100")
    assert package.run()[0] == 2


def test_options_of_a_helper_count(package):
    package.run()
    package.texts["helper"] = HELPER.format(options="(may_divide_by_zero=True)")
    assert package.run() == (2, ["result", "aided", "_deep"])


@pytest.mark.parametrize(("old", "new"), [("A sentence", "Another one"), ("FACTOR = 1", "# A word.\n\nFACTOR = 1")])
def test_words_do_not_count(package, old, new):
    package.run()
    package.edit("helper", old, new)
    assert package.run() == (2, [])


def test_going_back_and_forth_leaves_one_file_for_each_function(package):
    for _ in range(2):
        package.edit("helper", "x + _SHIFT[1]", "x + 7")
        assert package.run()[0] == 8
        package.edit("helper", "x + 7", "x + _SHIFT[1]")
        assert package.run()[0] == 2
    assert len(list((package.folder / "kept").iterdir())) == 3


def test_types_have_files_of_their_own(package):
    package.run()
    assert package.run(1.5) == (2.5, ["result", "aided", "_deep"])
    assert package.run() == (2, [])
    assert package.run(1.5) == (2.5, [])


def test_what_has_no_fingerprint_is_refused(package):
    package.edit("helper", "LEVELS = (0, 0)", "LEVELS = [0, 0]")
    with pytest.raises(TypeError, match="result names LEVELS: a list has no fingerprint"):
        package.run()


@pytest.mark.parametrize(
    "damage", [lambda code: code[:-1], lambda code: b"", lambda code: code[:-9] + b"x" + code[-8:]]
)
def test_a_damaged_file_is_as_good_as_none(package, damage):
    package.run()
    for file in (package.folder / "kept").iterdir():
        file.write_bytes(damage(file.read_bytes()))
    assert package.run() == (2, ["result", "aided", "_deep"])
    assert package.run() == (2, [])


def test_a_file_of_another_function_is_as_good_as_none(package):
    package.run()
    kept = sorted((package.folder / "kept").iterdir())
    contents = [file.read_bytes() for file in kept]
    for file, content in zip(kept, contents[1:] + contents[:1], strict=True):
        file.write_bytes(content)
    assert package.run() == (2, ["result", "aided", "_deep"])


def test_a_setting_that_changes_machine_code_counts(package, monkeypatch):
    package.run()
    monkeypatch.setenv("NUMBA_BOUNDSCHECK", "1")
    assert package.run()[1] != []


PROCESS = """
import sys
sys.path.insert(0, sys.argv[1])
import caller
print(caller.result(1), caller.result(1.5))
"""


def test_several_processes_at_once(tmp_path):
    """None sees half a file of another, and what they leave serves the next."""
    (tmp_path / "caller.py").write_text(CALLER.format(helper="helper"))
    (tmp_path / "helper.py").write_text(HELPER.format(options=""))
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "kept")}
    command = [sys.executable, "-c", PROCESS, str(tmp_path)]
    running = [subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    assert [process.communicate()[0] for process in running] == ["2 2.5\n"] * 3
    kept = list((tmp_path / "kept" / "orbiframe").iterdir())
    assert len(kept) == 6
    assert {file.suffix for file in kept} == {".nbc"}
