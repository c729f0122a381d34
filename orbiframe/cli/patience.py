"""Patience: no command is silent for more than two seconds at its start, and none for long afterwards."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from orbiframe.cli.progress import status_line
from orbiframe.cli.speech import say

# Seconds until the first word, and how much longer each wait is than the one before it.
_FIRST, _GROWTH, _LONGEST = 1.5, 1.5, 60.0
_TICK = 1.0


@contextmanager
def patient(command: str, *, quiet: bool = False) -> Iterator[None]:
    """Meanwhile whoever reads the standard error stream learns that the command is at work.

    On a terminal that shows a stage, the seconds are counted behind it. Elsewhere, as in a log, there is a line after a
    second and a half, and others after longer and longer times.
    """
    if quiet:
        yield
        return
    done = threading.Event()
    thread = threading.Thread(target=_wait, args=(command, done), daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def _wait(command: str, done: threading.Event) -> None:
    start, wait = time.monotonic(), _FIRST
    due = start + wait
    while not done.wait(min(_TICK, max(due - time.monotonic(), 0.0))):
        line, now = status_line(sys.stderr), time.monotonic()
        if line is not None and line.text:
            if now - line.written >= _TICK:
                line.remark(f"{now - line.began:.0f} s")
            due = max(due, now + _TICK)
        elif now >= due:
            say(f"{command}: at work for {now - start:.0f} s …")
            wait = min(wait * _GROWTH, _LONGEST)
            due = now + wait
