"""No command is silent for more than two seconds at its start."""

from __future__ import annotations

import io
import re
import sys
import time

import pytest

from orbiframe.cli import patience
from orbiframe.cli.patience import patient
from orbiframe.cli.progress import Progress
from orbiframe.cli.speech import say


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def said_within(stream: io.StringIO, pattern: str, seconds: float) -> None:
    end = time.monotonic() + seconds
    while not re.search(pattern, stream.getvalue()):
        assert time.monotonic() < end, stream.getvalue()
        time.sleep(0.01)


def test_a_log_is_told_that_a_command_is_at_work(monkeypatch):
    monkeypatch.setattr(sys, "stderr", log := io.StringIO())
    with patient("info"):
        said_within(log, r"^orbiframe: info: at work for 2 s …\n$", 2.0)


def test_lines_become_rarer(monkeypatch):
    monkeypatch.setattr(patience, "_FIRST", 0.02)
    monkeypatch.setattr(sys, "stderr", log := io.StringIO())
    with patient("info"):
        time.sleep(0.5)
    # After 0.02, 0.03, 0.045, ...: eight of them fit into half a second, where evenly there would be 25.
    assert 2 <= len(log.getvalue().splitlines()) <= 8


def test_a_stage_on_a_terminal_gets_its_seconds(monkeypatch):
    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    with patient("fit"):
        Progress(terminal)("map", None)
        said_within(terminal, r"\rmap … 1 s", 3.0)
        Progress(terminal)("map", 1.0)
    assert "at work" not in terminal.getvalue()


def test_a_command_without_stages_is_counted_on_a_terminal(monkeypatch):
    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    with patient("group"):
        said_within(terminal, r"\rgroup … 2 s.*\rgroup … 3 s", 5.0)
    assert re.search(r"\r +\r$", terminal.getvalue()), "the last line of the terminal is free again"


def test_output_stands_above_the_line(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(sys, "stdout", terminal)
    with patient("group"):
        said_within(terminal, r"group …", 5.0)
        print("systole 3.06")
        say("look at it")
    assert re.search(r"\r +\rsystole 3.06\norbiframe: look at it\n$", terminal.getvalue())
    assert sys.stdout is terminal


def test_what_is_said_stands_above_the_line(monkeypatch):
    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    with patient("group"):
        said_within(terminal, r"group …", 5.0)
        say("look at it")
    assert re.search(r"\r +\rorbiframe: look at it\n", terminal.getvalue())


@pytest.mark.parametrize("stream", [io.StringIO, Terminal])
def test_what_waits_for_its_user_is_not_counted(monkeypatch, stream):
    monkeypatch.setattr(sys, "stderr", log := stream())
    with patient("view") as rest:
        said_within(log, r"view", 4.0)
        rest()
        time.sleep(0.2)
        before = log.getvalue()
        time.sleep(2.5)
        assert log.getvalue() == before


@pytest.mark.parametrize("quiet", [True, False])
def test_what_is_quick_or_quiet_says_nothing(monkeypatch, quiet):
    monkeypatch.setattr(sys, "stderr", log := io.StringIO())
    with patient("info", quiet=quiet):
        time.sleep(0.05)
    assert log.getvalue() == ""
