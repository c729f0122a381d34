from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import warnings
from importlib.metadata import version

import pytest
from command_line import lines_said

from orbiframe.cli import info
from orbiframe.cli.main import main


def test_help_lists_the_commands_and_says_what_the_status_means(orbiframe):
    ran = orbiframe("--help")
    assert ran.status == 0
    for word in ("fit", "info", "convert", "plugins", "exit status"):
        assert word in ran.out
    assert orbiframe().out == ran.out


def test_version(orbiframe):
    assert orbiframe("--version").out == f"orbiframe {version('orbiframe')}\n"


def test_an_unknown_command_gets_the_nearest_one(orbiframe):
    ran = orbiframe("fti", "x.off")
    assert ran.status == 2
    assert "no command named 'fti'" in ran.err
    assert "Did you mean 'fit'?" in ran.err


@pytest.mark.parametrize("arguments", [["fit"], ["fit", "a.off"], ["info"], ["--nonsense"], ["convert", "a.off"]])
def test_wrong_usage_has_status_2(orbiframe, arguments):
    ran = orbiframe(*arguments)
    assert ran.status == 2
    assert "usage:" in ran.err
    assert ran.out == ""


def failing(monkeypatch, error: BaseException) -> None:
    def run(args, registry):
        raise error

    monkeypatch.setattr(info, "run", run)


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [
        (KeyboardInterrupt(), 130, "interrupted"),
        (MemoryError(), 1, "not enough memory"),
        (PermissionError(13, "Permission denied", "mesh.off"), 1, "Permission denied: 'mesh.off'"),
        (ZeroDivisionError("division by zero"), 1, "internal error, ZeroDivisionError: division by zero"),
        (SystemExit(7), 7, ""),
    ],
)
def test_every_error_is_one_line_and_a_status(orbiframe, monkeypatch, error, status, said):
    failing(monkeypatch, error)
    ran = orbiframe("info", "a.off")
    assert ran.status == status
    assert said in ran.err
    assert len(ran.err.splitlines()) == bool(said)


@pytest.mark.parametrize("arguments", [["--debug", "info", "a.off"], ["info", "a.off", "--debug"]])
def test_debug_shows_the_traceback(orbiframe, monkeypatch, arguments):
    failing(monkeypatch, ZeroDivisionError("why"))
    ran = orbiframe(*arguments)
    assert ran.status == 1
    assert "Traceback" in ran.err
    assert "ZeroDivisionError: why" in ran.err


def test_warnings_for_users_are_shown_and_those_for_programmers_are_not(orbiframe, monkeypatch):
    def run(args, registry):
        warnings.warn("the format holds no colours", stacklevel=1)
        warnings.warn("old call", DeprecationWarning, stacklevel=1)
        warnings.warn("overflow", RuntimeWarning, stacklevel=1)
        return 0

    monkeypatch.setattr(info, "run", run)
    assert orbiframe("info", "a.off").err == "orbiframe: warning: the format holds no colours\n"


def test_a_reader_of_the_output_may_leave():
    code = "import sys; from orbiframe.cli.main import main; sys.exit(main(['plugins']))"
    reading, writing = os.pipe()
    os.close(reading)
    run = subprocess.run([sys.executable, "-c", code], stdout=writing, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writing)
    assert lines_said(run.stderr) == []
    assert run.returncode == 0


def test_an_interrupt_ends_with_one_line(tmp_path):
    code = """
import signal, sys, time
from orbiframe.cli import info, main
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where the tests run in the background
def run(args, registry):
    print("at work", flush=True)
    time.sleep(60)
    print("went on")
info.run = run
sys.exit(main.main(["info", "a.off"]))
"""
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "at work\n"
    process.send_signal(signal.SIGINT)
    out, error = process.communicate()
    assert out == ""
    assert process.returncode == 130
    assert lines_said(error) == ["orbiframe: interrupted"]


def test_main_leaves_the_warning_filters_alone():
    before = list(warnings.filters)
    main(["--help"])
    assert warnings.filters == before


@pytest.mark.parametrize("chosen", [{}, {"OMP_NUM_THREADS": "3"}])
def test_linear_algebra_has_one_thread_unless_the_user_says_otherwise(chosen):
    """In a process that knows nothing of what the tests set."""
    code = """
import json, os, sys
from orbiframe.cli.main import main
from orbiframe.workers.linear_algebra import VARIABLES
assert "numpy" not in sys.modules
main(["--version"])
print(json.dumps({name: os.environ.get(name) for name in VARIABLES}))
"""
    clean = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")} | chosen
    run = subprocess.run([sys.executable, "-c", code], env=clean, capture_output=True, text=True, check=True)
    found = json.loads(run.stdout.splitlines()[-1])
    assert found == dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1") | chosen
