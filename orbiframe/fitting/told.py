"""Told: whoever fits in Python hears within two seconds what goes on, unless he listens himself."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Literal

from orbiframe.compiled import compilation
from orbiframe.fitting.stages import Progress

# Seconds until the first word, and the longest time from one word to the next: each wait is longer than the one before.
_FIRST, _GROWTH, _LONGEST = 1.5, 1.25, 30.0


def _silent(_stage: str, _seconds: float | None) -> None: ...


@contextmanager
def told(progress: Progress | Literal[False] | None) -> Iterator[Progress]:
    """Who is told of the stages meanwhile: `progress` itself, nobody for False, the standard error stream for None.

    On that stream nothing is said of what is done within a second and a half. Then the stage is named that goes on, and
    again after longer and longer times; that functions are compiled is said at once.
    """
    if progress is not None:
        yield progress or _silent
        return
    patience = _Patience()
    with compilation.heard(patience):
        try:
            yield patience
        finally:
            patience.stop()


class _Patience:
    """Waits, and names the stage that goes on."""

    def __init__(self) -> None:
        self._stage, self._start, self._done = "", time.monotonic(), threading.Event()
        self._compiled = False
        threading.Thread(target=self._wait, daemon=True).start()

    def __call__(self, stage: str, seconds: float | None) -> None:
        self._stage = stage if seconds is None else self._stage

    def begins(self, _name: str) -> None:
        """Hear that a function is about to be compiled."""
        if not self._compiled:
            self._compiled = True
            _say("compiling, once on this machine …")

    def ends(self) -> None:
        """Hear that no function is being compiled any more."""

    def stop(self) -> None:
        """Say no more."""
        self._done.set()

    def _wait(self) -> None:
        wait = _FIRST
        while not self._done.wait(wait):
            doing = "compiling" if compilation.underway else f"at the stage '{self._stage}'"
            _say(f"fitting, {doing}, {time.monotonic() - self._start:.0f} s so far …")
            wait = min(wait * _GROWTH, _LONGEST)


def _say(text: str) -> None:
    if sys.stderr is not None:
        with suppress(OSError, ValueError):
            print(f"orbiframe: {text}", file=sys.stderr, flush=True)
