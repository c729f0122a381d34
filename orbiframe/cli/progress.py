"""Progress on the standard error stream: stages with their seconds, and that functions are being compiled."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

from orbiframe.cli.speech import say
from orbiframe.cli.status_line import StatusLine
from orbiframe.compiled import compilation

# Seconds after which something is said again.
_PATIENCE = 1.5


# By the identity of the stream, which the line keeps alive.
_lines: dict[int, StatusLine] = {}


def status_line(stream: TextIO | None) -> StatusLine | None:
    """The status line of a stream, the same for all who write there; None where it is no terminal."""
    if stream is None or not stream.isatty():
        return None
    return _lines.setdefault(id(stream), StatusLine(stream))


class Progress:
    """Shows each stage on a line of its own; silent unless the stream is a terminal.

    Called as `progress(stage, seconds)`, with None at the beginning of a stage and its seconds at the end.
    """

    def __init__(self, stream: TextIO | None = None, *, quiet: bool = False) -> None:
        self._line = None if quiet else status_line(sys.stderr if stream is None else stream)

    def __call__(self, stage: str, seconds: float | None) -> None:
        """Say that a stage begins, or how long it took."""
        if self._line and seconds is None:
            self._line.show(f"{stage} …")
        elif self._line:
            self._line.leave(f"{stage:<16}{seconds:7.2f} s")


class CompilationProgress:
    """Says that functions are being compiled: at once, and again while it goes on, with how many they are by then.

    On a terminal behind the text of the status line, elsewhere on lines of its own.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self.count = 0
        self._line, self._done = status_line(stream), threading.Event()

    def begins(self, name: str) -> None:  # noqa: ARG002
        """Hear that a function is about to be compiled."""
        self.count += 1
        if self.count == 1:
            self._say("compiling, once on this machine …")
            threading.Thread(target=self._go_on, daemon=True).start()
        elif self._line:
            self._say_more()

    def ends(self) -> None:
        """Hear that no function is being compiled any more."""
        if self._line:
            self._line.remark("")

    def stop(self) -> None:
        """Say no more."""
        self._done.set()

    def _go_on(self) -> None:
        while not self._done.wait(_PATIENCE):
            if compilation.underway:
                self._say_more()

    def _say_more(self) -> None:
        self._say(f"compiling, once on this machine: {self.count} functions so far …")

    def _say(self, text: str) -> None:
        if self._line:
            self._line.remark(text)
        else:
            say(text)


@contextmanager
def compilation_told(*, quiet: bool = False) -> Iterator[CompilationProgress]:
    """Meanwhile whoever reads the standard error stream learns that functions are being compiled."""
    progress = CompilationProgress(sys.stderr)
    if quiet:
        yield progress
        return
    with compilation.heard(progress):
        try:
            yield progress
        finally:
            progress.stop()
