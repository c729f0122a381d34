"""Every command and every Python block of the documentation runs and prints what the page shows."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from documents import PAGES, ROOT, Command, blocks, commands, page_name

from orbiframe.cli.main import main

RUN = [page for page in PAGES if any(block.language in {"console", "python"} for block in blocks(page))]
SHELL = {"python3", "make", "sudo", ".venv/bin/pip", ".venv/bin/python", ".venv/bin/pytest"}
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]\d+)?")
_ROUNDING = 1e-6
_GAP = "…"


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder of its own with the datasets in it; modules imported from it are forgotten afterwards."""
    shutil.copytree(ROOT / "datasets", tmp_path / "datasets")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("ORBIFRAME_PLUGINS", raising=False)
    known = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - known:
        home = getattr(sys.modules[name], "__file__", None)
        if home and tmp_path in Path(home).parents:
            del sys.modules[name]


@pytest.mark.long
@pytest.mark.parametrize("page", RUN, ids=page_name)
def test_page_runs_from_top_to_bottom(page, place, capsys):
    names: dict[str, object] = {"__name__": "page"}
    for block in blocks(page):
        if block.title:
            (place / block.title).write_text(block.text)
            if block.title.startswith("test_"):
                _require_passing(place / block.title)
        elif block.language == "python":
            exec(compile(block.text, page_name(page), "exec"), names)
        elif block.language == "console":
            for command in commands(block.text):
                _run(command, capsys)


def _require_passing(tests: Path) -> None:
    """A test file of a page passes, in a process of its own."""
    pytest_there = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", tests.name]
    done = subprocess.run(pytest_there, cwd=tests.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def _run(command: Command, capsys) -> None:
    program, *arguments = shlex.split(command.line)
    assert program == "orbiframe", f"only orbiframe belongs in a console block, not {program}"
    capsys.readouterr()
    status = main(arguments)
    found = capsys.readouterr()
    assert status == 0, f"{command.line}: {found.err}"
    if command.output.strip():
        _require_like(command.output, found.out)


def _require_like(shown: str, found: str) -> None:
    """The same words, and numbers within a factor of two; times, rounding errors and what `…` stands for may be any."""
    expected_lines, lines = _lines(shown), _lines(found)
    if _GAP in expected_lines:
        gap = expected_lines.index(_GAP)
        lines[gap : len(lines) - len(expected_lines) + gap + 1] = [_GAP]
    for expected, line in zip(expected_lines, lines, strict=True):
        assert _words(expected) == _words(line)
        if not expected.startswith("seconds"):
            for a, b in zip(_numbers(expected), _numbers(line), strict=True):
                assert a == b or max(abs(a), abs(b)) < _ROUNDING or 0.5 <= a / b <= 2, (expected, line)


def _lines(text: str) -> list[str]:
    return [line.rstrip() for line in text.strip().splitlines()]


def _words(line: str) -> list[str]:
    return _NUMBER.sub("#", line).split()


def _numbers(line: str) -> list[float]:
    return [float(number) for number in _NUMBER.findall(line)]


@pytest.mark.parametrize("page", PAGES, ids=page_name)
def test_shell_blocks_use_known_programs_and_targets(page):
    for block in blocks(page):
        assert block.language, f"{page_name(page)}: a fenced block without a language"
        if block.language == "sh":
            for line in filter(None, block.text.splitlines()):
                _require_known(line)


def _require_known(line: str) -> None:
    program, *arguments = shlex.split(line, comments=True)
    assert program in SHELL, line
    if program == "make":
        targets = re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
        assert set(arguments) <= set(targets), line


def test_a_wrong_output_is_noticed():
    """The comparison itself: other words and other numbers fail, other times and rounding errors do not."""
    _require_like("error 1.0e-03\nseconds 2.0 (map 1.0)", "error 1.4e-03\nseconds 9.0 (map 0.1)")
    _require_like("defect 2.0e-15", "defect 7.1e-16")
    _require_like("first\n…\nlast", "first\nsecond\nthird\nlast")
    with pytest.raises(AssertionError):
        _require_like("first\n…\nlast", "first\nsecond\nthird\nother")
    for wrong in ("error 5.0e-03\nseconds 2.0 (map 1.0)", "fehler 1.0e-03\nseconds 2.0 (map 1.0)", "error 1.0e-03"):
        with pytest.raises((AssertionError, ValueError)):
            _require_like("error 1.0e-03\nseconds 2.0 (map 1.0)", wrong)
