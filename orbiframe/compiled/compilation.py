"""Compilation: whoever waits for it can learn which function is being compiled."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

_listeners: list[Callable[[str], None]] = []


@contextmanager
def heard(listener: Callable[[str], None]) -> Iterator[None]:
    """Meanwhile the listener is told the name of every function that is about to be compiled."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


def begins(name: str) -> None:
    """Tell all listeners."""
    for listener in _listeners:
        listener(name)
