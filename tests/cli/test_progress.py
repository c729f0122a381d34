"""What the standard error stream shows while a command works."""

from __future__ import annotations

import io
import sys
import time

import pytest

from orbiframe.cli import main as program, progress as module
from orbiframe.cli.progress import CompilationProgress, Progress, compilation_told
from orbiframe.compiled import compilation


class Terminal(io.StringIO):
    """A terminal that remembers what was written, and knows what stands in its lines."""

    def isatty(self) -> bool:
        return True

    def lines(self) -> list[str]:
        shown = []
        for line in self.getvalue().split("\n"):
            text = ""
            for part in line.split("\r"):
                text = part + text[len(part) :]
            shown.append(text.rstrip())
        return shown


def test_stages_are_shown_on_a_terminal_only():
    terminal = Terminal()
    progress = Progress(terminal)
    progress("map", None)
    assert terminal.lines() == ["map …"]
    progress("map", 1.25)
    assert terminal.lines() == ["map                1.25 s", ""]
    for silent in (Progress(file := io.StringIO()), Progress(quiet := Terminal(), quiet=True)):
        silent("map", None)
        silent("map", 1.0)
        assert (file.getvalue(), quiet.getvalue()) == ("", "")


def test_a_line_is_no_wider_than_the_terminal(monkeypatch):
    monkeypatch.setenv("COLUMNS", "20")
    terminal = Terminal()
    Progress(terminal)("a stage with a long name", None)
    assert terminal.lines() == ["a stage with a long"]


@pytest.fixture
def underway():
    """Functions begin to be compiled, and all end with the test."""
    with compilation.ended():
        yield compilation.begins


def wait_for(said) -> None:
    for _ in range(1000):
        if said():
            return
        time.sleep(0.01)
    raise AssertionError("nothing was said")


def test_compilation_is_told_at_once_and_again_while_it_goes_on(underway, monkeypatch):
    monkeypatch.setattr(module, "_PATIENCE", 0.01)
    monkeypatch.setattr(sys, "stderr", stream := io.StringIO())
    progress = CompilationProgress(stream)
    with compilation.heard(progress):
        underway("one")
        assert stream.getvalue() == "orbiframe: compiling, once on this machine …\n"
        underway("two")
        wait_for(lambda: "orbiframe: compiling, once on this machine: 2 functions so far …\n" in stream.getvalue())
    progress.stop()


def test_nothing_is_said_while_nothing_is_compiled(monkeypatch):
    monkeypatch.setattr(module, "_PATIENCE", 0.01)
    monkeypatch.setattr(sys, "stderr", stream := io.StringIO())
    progress = CompilationProgress(stream)
    with compilation.heard(progress), compilation.ended():
        compilation.begins("one")
    said = stream.getvalue()
    time.sleep(0.1)
    assert stream.getvalue() == said
    progress.stop()


def test_on_a_terminal_it_stands_behind_the_stage_and_goes():
    terminal = Terminal()
    stages = Progress(terminal)
    stages("map", None)
    progress = CompilationProgress(terminal)
    with compilation.heard(progress):
        with compilation.ended():
            compilation.begins("one")
            assert terminal.lines() == ["map … compiling, once on this machine …"]
            compilation.begins("two")
            assert terminal.lines() == ["map … compiling, once on this machine: 2 functions so far …"]
        assert terminal.lines() == ["map …"]
    progress.stop()
    stages("map", 3.5)
    assert terminal.lines()[0] == "map                3.50 s"


def test_quiet_is_quiet(capsys):
    with compilation_told(quiet=True), compilation.ended():
        compilation.begins("one")
    assert capsys.readouterr().err == ""
    with compilation_told(quiet=False), compilation.ended():
        compilation.begins("one")
    assert capsys.readouterr().err != ""


@pytest.mark.parametrize("quiet", [False, True])
def test_every_command_tells_unless_it_is_quiet(capsys, monkeypatch, tmp_path, quiet):
    from orbiframe.cli import fit

    def run(args, registry):
        with compilation.ended():
            compilation.begins("one")
        return 0

    monkeypatch.setattr(fit, "run", run)
    assert program.main(["fit", "a.off", "-o", "b.off", *(["--quiet"] if quiet else [])]) == 0
    assert capsys.readouterr().err == ("" if quiet else "orbiframe: compiling, once on this machine …\n")
