"""Every command and every Python block of the documentation runs and prints what the page shows."""

from __future__ import annotations

import importlib
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from documents import PAGES, ROOT, Command, blocks, commands, page_name

from orbiframe.cli.main import main

RUN = [page for page in PAGES if any(block.language in {"console", "python"} for block in blocks(page))]
BY_HAND = {"python", "pip", "source", "orbiframe"}
SHELL = {*BY_HAND, "python3", "make", "sudo", ".venv/bin/pip", ".venv/bin/python", ".venv/bin/pytest"}
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]\d+)?")
_ROUNDING = 1e-6
_GAP = "…"


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder of its own with the datasets in it; modules imported from it are forgotten afterwards."""
    shutil.copytree(ROOT / "datasets", tmp_path / "datasets")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("ORBIFRAME_PLUGINS", raising=False)
    yield tmp_path
    _forget(tmp_path)


def _forget(place: Path) -> None:
    """What has been imported from a folder is imported anew: another process begins."""
    for name, module in list(sys.modules.items()):
        home = getattr(module, "__file__", None)
        if home and place in Path(home).parents:
            del sys.modules[name]
    importlib.invalidate_caches()


@pytest.mark.long
@pytest.mark.parametrize("page", RUN, ids=page_name)
def test_page_runs_from_top_to_bottom(page, place, capsys, monkeypatch):
    names: dict[str, object] = {"__name__": "page"}
    for block in blocks(page):
        if block.language == "console":
            for command in commands(block.text):
                _run(command, capsys, status=1 if block.title == "status 1" else 0)
        elif block.language == "sh":
            for line in block.text.splitlines():
                _install(line, place, monkeypatch)
        elif block.title:
            (place / block.title).write_text(block.text)
            _forget(place)
            if block.title.startswith("test_"):
                _require_passing(place / block.title)
        elif block.language == "python":
            exec(compile(block.text, page_name(page), "exec"), names)


def _require_passing(tests: Path) -> None:
    """A test file of a page passes, in a process of its own."""
    pytest_there = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", tests.name]
    done = subprocess.run(pytest_there, cwd=tests.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def _install(line: str, place: Path, monkeypatch) -> None:
    """What `python -m pip install -e FOLDER` does for a folder of the page: it is found. Other lines do nothing."""
    *words, folder = shlex.split(line, comments=True) or [""]
    if words != ["python", "-m", "pip", "install", "-e"]:
        return
    entry = tomllib.loads((place / folder / "pyproject.toml").read_text())["project"]
    info = place / folder / f"{entry['name']}-1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {entry['name']}\nVersion: 1\n")
    lines = [f"{name} = {module}" for name, module in entry["entry-points"]["orbiframe"].items()]
    (info / "entry_points.txt").write_text("\n".join(["[orbiframe]", *lines]) + "\n")
    monkeypatch.syspath_prepend(place / folder)


def _run(command: Command, capsys, *, status: int = 0) -> None:
    program, *arguments = shlex.split(command.line)
    assert program == "orbiframe", f"only orbiframe belongs in a console block, not {program}"
    capsys.readouterr()
    ended = main(arguments)
    found = capsys.readouterr()
    assert ended == status, f"{command.line}: {found.err}"
    if command.output.strip():
        _require_like(command.output, found.out)


def _require_like(shown: str, found: str) -> None:
    """The same words, and numbers within a factor of two; times, rounding errors and what `…` stands for may be any."""
    first, *others = _parts(_lines(shown))
    lines = _lines(found)
    if not others:
        assert len(first) == len(lines), (shown, found)
    *middle, last = others or [[]]
    _require_same(first, lines[: len(first)])
    end = len(lines) - len(last)
    _require_same(last, lines[end:])
    start = len(first)
    for part in middle:
        starts = [k for k in range(start, end - len(part) + 1) if _words(part[0]) == _words(lines[k])]
        assert starts, f"{part[0]} is not among {lines[start:end]}"
        start = starts[0] + len(part)
        _require_same(part, lines[starts[0] : start])
    assert start <= end


def _parts(lines: list[str]) -> list[list[str]]:
    """The lines between the gaps; the first and the last part may be empty."""
    parts: list[list[str]] = [[]]
    for line in lines:
        if line == _GAP:
            parts.append([])
        else:
            parts[-1].append(line)
    return parts


def _require_same(shown: list[str], found: list[str]) -> None:
    assert len(shown) == len(found), (shown, found)
    for expected, line in zip(shown, found, strict=True):
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
    _require_like("…\nthird\n…", "first\nsecond\nthird\nlast")
    for wrong in ("first\n…\nother", "…\nfourth\n…", "…\nthird\nsecond\n…", "second\n…"):
        with pytest.raises(AssertionError):
            _require_like(wrong, "first\nsecond\nthird\nlast")
    for wrong in ("error 5.0e-03\nseconds 2.0 (map 1.0)", "fehler 1.0e-03\nseconds 2.0 (map 1.0)", "error 1.0e-03"):
        with pytest.raises((AssertionError, ValueError)):
            _require_like("error 1.0e-03\nseconds 2.0 (map 1.0)", wrong)
