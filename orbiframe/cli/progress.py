"""Progress: the stage at work and the seconds of those that are done, on the standard error stream of a terminal."""

from __future__ import annotations

import sys
from contextlib import suppress
from typing import TextIO


class Progress:
    """Shows each stage on a line of its own; silent unless the stream is a terminal.

    Called as `progress(stage, seconds)`, with None at the beginning of a stage and its seconds at the end.
    """

    def __init__(self, stream: TextIO | None = None, *, quiet: bool = False) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._shown = not quiet and self._stream is not None and self._stream.isatty()

    def __call__(self, stage: str, seconds: float | None) -> None:
        """Say that a stage begins, or how long it took."""
        if self._shown:
            with suppress(OSError):
                text = f"{stage} …" if seconds is None else f"\r{stage:<16}{seconds:7.2f} s\n"
                print(text, end="", file=self._stream, flush=True)
