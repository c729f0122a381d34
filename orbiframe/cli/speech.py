"""Speech: what the commands say on the standard streams, which never costs what they have made."""

from __future__ import annotations

import json
import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TextIO

from orbiframe.cli.status_line import status_line
from orbiframe.components.shown_text import shown

_for_programs = False
_writing = threading.Lock()


def say(text: str) -> None:
    """Write a line on the standard error stream, in one line; where it is full or closed nothing is said."""
    if _for_programs:
        say_event("says", text=shown(text))
    else:
        _write(f"orbiframe: {shown(text)}")


def say_event(event: str, **content: object) -> None:
    """Write a line of JSON on the standard error stream, for programs."""
    _write(json.dumps({"event": event, **content}))


@contextmanager
def said_to_programs(wanted: bool) -> Iterator[None]:
    """Within, if wanted, everything on the standard error stream is a line of JSON."""
    global _for_programs
    before, _for_programs = _for_programs, wanted
    try:
        yield
    finally:
        _for_programs = before


def _write(line: str) -> None:
    if sys.stderr is not None:
        with suppress(OSError, ValueError), _writing:
            if below := status_line(sys.stderr):
                below.wipe()
            print(line, file=sys.stderr, flush=True)


@contextmanager
def any_letter() -> Iterator[None]:
    """Within, letters that the standard streams cannot encode are escaped instead of being an error."""
    streams = [stream for stream in (sys.stdout, sys.stderr) if hasattr(stream, "reconfigure")]
    before = [stream.errors for stream in streams]
    _set_errors(streams, ["backslashreplace"] * len(streams))
    try:
        yield
    finally:
        _set_errors(streams, before)


def _set_errors(streams: list[TextIO], errors: list[str | None]) -> None:
    for stream, name in zip(streams, errors, strict=True):
        with suppress(OSError, ValueError):  # what is still to be written may have nowhere to go
            stream.reconfigure(errors=name)  # type: ignore[attr-defined]


def fill_closed_streams() -> None:
    """Open the null device in place of closed standard streams, so that no file that is opened takes their numbers."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)


def silence(stream: TextIO | None) -> None:
    """Let what is left in a stream that nobody takes go nowhere."""
    with suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())  # type: ignore[union-attr]
