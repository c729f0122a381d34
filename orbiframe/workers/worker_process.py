"""Worker process: makes its task, then does it for one item after the other, until there is nobody to ask.

Messages are pickles on the standard streams. In: the path for modules, the maker of the task, the items. Out:
("told", (stage, seconds)) as often as the task tells something, then ("done", result) or ("raised", error).
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import Any, BinaryIO

from orbiframe.compiled import compilation
from orbiframe.workers.threads import VARIABLE

# The word that a worker says in place of a stage while it compiles.
COMPILING = "compiling"
Tell = Callable[[str, float | None], None]
Task = Callable[[Any, Tell], Any]


def main() -> None:
    """Serve whoever started this process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # an interrupt is for the process that hands out the work
    source, target = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no message
    os.environ.setdefault(VARIABLE, "1")  # the processors are for the other workers
    sys.path[:0] = [entry for entry in pickle.load(source) if entry not in sys.path]
    make, arguments = pickle.load(source)
    task: Task = make(*arguments)
    with compilation.heard(_Compiling(target)), suppress(EOFError, BrokenPipeError):  # nobody asks any more
        while True:
            _send(target, *_answer(task, pickle.load(source), target))


def _answer(task: Task, item: Any, target: BinaryIO) -> tuple[str, Any]:
    try:
        return "done", task(item, lambda stage, seconds: _send(target, "told", (stage, seconds)))
    except BrokenPipeError:
        raise
    except Exception as error:
        return "raised", error


class _Compiling:
    """Tells how many functions have been compiled."""

    def __init__(self, target: BinaryIO) -> None:
        self.count, self._target = 0, target

    def begins(self, name: str) -> None:  # noqa: ARG002
        """Hear that a function is about to be compiled."""
        self.count += 1
        _send(self._target, "told", (COMPILING, float(self.count)))

    def ends(self) -> None:
        """Hear that no function is being compiled any more."""


def _send(target: BinaryIO, kind: str, content: Any) -> None:
    try:
        message = pickle.dumps((kind, content))
    except Exception as error:  # an error of a library that does not travel
        message = pickle.dumps(("raised", RuntimeError(f"{type(content).__name__}: {content} ({error})")))
    target.write(message)
    target.flush()
