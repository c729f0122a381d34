"""Tasks for processes of their own, which import them from here."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable


def adding(base: int) -> Callable[..., tuple[int, int]]:
    """Add a number; -1 raises, -2 kills the process, -3 gives what cannot be pickled, -4 takes its time."""

    def task(item, tell):
        tell("adds", None)
        if item == -1:
            raise ValueError("minus one")
        if item == -2:
            os.kill(os.getpid(), signal.SIGKILL)
        if item == -3:
            return lambda: None
        if item == -4:
            time.sleep(60)
        print("what a library says is no message")
        return base + item, os.getpid()

    return task


def killed_once(mark) -> Callable[..., str]:
    """Kill the first process that tries."""

    def task(item, tell):
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return f"{item} done"

    return task


def broken() -> None:
    raise RuntimeError("this task cannot be made")


def counting_threads() -> Callable[..., int]:
    """How many threads a process takes for each item."""
    from orbiframe.workers import thread_count

    return lambda _item, _tell: thread_count()
