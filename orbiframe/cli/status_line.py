"""The status line: one line of a terminal that is written over again and again."""

from __future__ import annotations

import shutil
import time
from contextlib import suppress
from typing import TextIO


class StatusLine:
    """A text in the last line of a terminal, with a remark behind it."""

    def __init__(self, stream: TextIO) -> None:
        self._stream, self._text, self._remark, self._width = stream, "", "", 0
        self.began = self.written = 0.0

    @property
    def text(self) -> str:
        """What the line shows, without the remark; shown from `began` on, and `written` last then (monotonic times)."""
        return self._text

    def show(self, text: str) -> None:
        """Write another text, without a remark."""
        self._text, self._remark, self.began = text, "", time.monotonic()
        self._write()

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
        line = " ".join(filter(None, [self._text, self._remark]))[:room]
        self._print(f"\r{line:<{min(self._width, room)}}" + ("" if line else "\r"))
        self._width, self.written = len(line), time.monotonic()

    def _print(self, text: str) -> None:
        with suppress(OSError, ValueError):  # a terminal that has gone costs no result
            print(text, end="", file=self._stream, flush=True)
