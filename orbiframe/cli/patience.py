"""Patience: no command is silent for more than two seconds at its start, and none for long afterwards."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext, redirect_stdout
from typing import Any

from orbiframe.cli.speech import say
from orbiframe.cli.status_line import StatusLine, status_line

# Seconds until the first word, and how much longer each wait is than the one before it.
_FIRST, _GROWTH, _LONGEST = 1.5, 1.5, 60.0
_TICK = 1.0


@contextmanager
def patient(command: str, *, quiet: bool = False) -> Iterator[Callable[[], None]]:
    """Meanwhile whoever reads the standard error stream learns that the command is at work, until the yield is called.

    On a terminal the seconds are counted in the last line, behind the stage if there is one; what is written on the
    standard output meanwhile stands above that line. Elsewhere, as in a log, there is a line after a second and a half,
    and others after longer and longer times.
    """
    done, line = threading.Event(), status_line(sys.stderr)
    if quiet:
        yield done.set
        return
    thread = threading.Thread(target=_log if line is None else _count, args=(command, done, line), daemon=True)
    thread.start()
    try:
        with _above(line):
            yield done.set
    finally:
        done.set()
        thread.join()
        if line:
            line.wipe()


def _above(line: StatusLine | None) -> AbstractContextManager[Any]:
    """Within, the standard output leaves a line of the same terminal alone."""
    if line is None or sys.stdout is None or not sys.stdout.isatty():
        return nullcontext()
    return redirect_stdout(line.above(sys.stdout))


def _log(command: str, done: threading.Event, _: None) -> None:
    start, wait = time.monotonic(), _FIRST
    while not done.wait(wait):
        say(f"{command}: at work for {time.monotonic() - start:.0f} s …")
        wait = min(wait * _GROWTH, _LONGEST)


def _count(command: str, done: threading.Event, line: StatusLine) -> None:
    start, own = time.monotonic(), f"{command} …"
    while not done.wait(_TICK):
        now = time.monotonic()
        if not line.text and now - start >= _FIRST:
            line.show(own, since=start)
        if line.text == own or (line.text and now - line.written >= _FIRST):
            line.remark(f"{now - line.began:.0f} s")
    if line.text == own:
        line.wipe()
