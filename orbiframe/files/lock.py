"""File lock: one process at a time, let go by the system whatever ends the process."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

try:
    import fcntl
except ImportError:  # a system without them; then nobody waits
    fcntl = None  # type: ignore[assignment]


@contextmanager
def file_lock(path: Path, *, wait: bool = True) -> Iterator[bool]:
    """Hold the lock of a file, which is made if it is not there; what is yielded is whether it is held.

    wait: until nobody else holds it; otherwise a lock that another process holds yields False. A file system without
    locks yields True. Raises OSError where the file cannot be made.
    """
    number = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    try:
        yield _held(number, wait)
    finally:
        os.close(number)


def _held(number: int, wait: bool) -> bool:
    if fcntl is None:
        return True
    with suppress(OSError):
        fcntl.flock(number, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        return True
    try:  # held by another, or no locks here
        fcntl.flock(number, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return False
