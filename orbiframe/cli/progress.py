"""Progress: the stage at work and its time, on the standard error stream of a terminal."""

from __future__ import annotations

import sys
import time
from typing import TextIO


class Progress:
    """Shows each stage on a line of its own with the seconds it took; silent unless the stream is a terminal.

    Called as `progress(stage, fraction)`, fraction from 0 to 1 or None where it is unknown; `done()` ends the last.
    """

    def __init__(self, stream: TextIO | None = None, *, quiet: bool = False) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._shown = not quiet and self._stream.isatty()
        self._stage: str | None = None
        self._start = time.perf_counter()

    def __call__(self, stage: str, fraction: float | None = None) -> None:
        """Say that a stage is at work."""
        if stage != self._stage:
            self.done()
            self._stage, self._start = stage, time.perf_counter()
        self._write("" if fraction is None else f" {fraction:4.0%}")

    def done(self) -> None:
        """End the line of the last stage."""
        if self._stage is not None:
            self._write("", "\n")
            self._stage = None

    def _write(self, suffix: str, end: str = "") -> None:
        if self._shown:
            seconds = time.perf_counter() - self._start
            print(f"\r\033[K{self._stage:<24}{seconds:7.1f} s{suffix}", end=end, file=self._stream, flush=True)
