"""Temporary folders: of names that nobody can guess, and gone whatever ends the work in them."""

from __future__ import annotations

import signal
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

# A terminal that is closed, and what `kill` and a machine that shuts down send.
_ENDS = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]


@contextmanager
def temporary_folder(beside: Path | None = None) -> Iterator[Path]:
    """A folder for the time of a block, in a folder or among the temporary files of the system.

    Only the user can enter it. Where the process is asked to end (SIGTERM, SIGHUP) and nobody else sees to that, it
    ends by SystemExit within the block, so that the folder goes first. Raises OSError where none can be made.
    """
    with _orderly_end(), tempfile.TemporaryDirectory(dir=beside, prefix=".orbiframe-") as folder:
        yield Path(folder)


@contextmanager
def _orderly_end() -> Iterator[None]:
    free = threading.current_thread() is threading.main_thread()
    mine = [end for end in _ENDS if free and signal.getsignal(end) is signal.SIG_DFL]
    for end in mine:
        signal.signal(end, _leave)
    try:
        yield
    finally:
        for end in mine:
            signal.signal(end, signal.SIG_DFL)


def _leave(number: int, _frame: FrameType | None) -> None:
    raise SystemExit(128 + number)
