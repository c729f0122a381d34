"""The status line: one line of a terminal that is written over again and again."""

from __future__ import annotations

import shutil
import threading
import time
from contextlib import suppress
from typing import Any, TextIO


class StatusLine:
    """A text in the last line of a terminal, with a remark behind it."""

    def __init__(self, stream: TextIO) -> None:
        self._stream, self._text, self._remark, self._width = stream, "", "", 0
        self._writing = threading.RLock()
        self.began = self.written = 0.0

    @property
    def text(self) -> str:
        """What the line shows, without the remark; shown from `began` on, and `written` last then (monotonic times)."""
        return self._text

    def show(self, text: str, *, since: float | None = None) -> None:
        """Write another text, without a remark; since: the monotonic time at which began what it tells, if not now."""
        self._text, self._remark, self.began = text, "", time.monotonic() if since is None else since
        self._write()

    def wipe(self) -> None:
        """Make room for a line of another kind, if a text is shown."""
        if self._text:
            self.show("")

    def remark(self, remark: str) -> None:
        """Write another remark behind the text."""
        self._remark = remark
        self._write()

    def leave(self, text: str) -> None:
        """Write a last text, and go to the next line."""
        self.show(text)
        self._text, self._width = "", 0
        self._print("\n")

    def _write(self) -> None:
        room = shutil.get_terminal_size().columns - 1
        with self._writing:
            line = " ".join(filter(None, [self._text, self._remark]))[:room]
            self._print(f"\r{line:<{min(self._width, room)}}" + ("" if line else "\r"))
            self._width, self.written = len(line), time.monotonic()

    def _print(self, text: str) -> None:
        with suppress(OSError, ValueError):  # a terminal that has gone costs no result
            print(text, end="", file=self._stream, flush=True)

    def above(self, stream: TextIO) -> TextIO:
        """Another stream to the same terminal, which wipes this line before it writes."""
        return _Above(stream, self, self._writing)  # type: ignore[return-value]


class _Above:
    """A text stream in all but its writing."""

    def __init__(self, stream: TextIO, line: StatusLine, writing: threading.RLock) -> None:
        self._stream, self._line, self._writing = stream, line, writing

    def write(self, text: str) -> int:
        with self._writing:
            self._line.wipe()
            return self._stream.write(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


# By the identity of the stream, which the line keeps alive.
_lines: dict[int, StatusLine] = {}


def status_line(stream: TextIO | None) -> StatusLine | None:
    """The status line of a stream, the same for all who write there; None where it is no terminal or notebook."""
    if stream is None or not (stream.isatty() or _in_notebook(stream)):
        return None
    return _lines.setdefault(id(stream), StatusLine(stream))


def _in_notebook(stream: TextIO) -> bool:
    """Whether a stream is shown under a cell of Jupyter, where a line can be written over as on a terminal."""
    return type(stream).__module__.startswith("ipykernel.")
