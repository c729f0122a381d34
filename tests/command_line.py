from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import NamedTuple

import pytest

from orbiframe.cli import main as program

CUBE = """OFF
8 6 12
0 0 0
0 0 1
0 1 0
0 1 1
1 0 0
1 0 1
1 1 0
1 1 1
4 0 1 3 2
4 4 6 7 5
4 0 4 5 1
4 2 3 7 6
4 0 2 6 4
4 1 5 7 3
"""


def lines_said(error: str) -> list[str]:
    """The lines of a standard error stream but those that say that work goes on: they hang on the clock."""
    return [line for line in error.splitlines() if ": at work for " not in line]


class Ran(NamedTuple):
    status: int
    out: str
    err: str


@pytest.fixture
def orbiframe(capsys, monkeypatch) -> Callable[..., Ran]:
    """Run the command line in this process; nothing is said of compilation and of long work, which depend on others."""

    def run(*arguments: object) -> Ran:
        monkeypatch.setattr(program, "compilation_told", lambda **_: nullcontext())
        monkeypatch.setattr(program, "patient", lambda *_, **__: nullcontext(lambda: None))
        capsys.readouterr()
        status = program.main([str(argument) for argument in arguments])
        return Ran(status, *capsys.readouterr())

    return run


@pytest.fixture
def cube(tmp_path) -> Path:
    path = tmp_path / "cube.off"
    path.write_text(CUBE)
    return path
