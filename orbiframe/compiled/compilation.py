"""Compilation: which functions are being compiled now, and who is told of it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol


class Listener(Protocol):
    """Whoever wants to know that functions are being compiled."""

    def begins(self, name: str) -> None:
        """A function is about to be compiled."""

    def ends(self) -> None:
        """No function is being compiled any more."""


# The functions that are being compiled: each is needed by the one before it.
underway: list[str] = []
_listeners: list[Listener] = []


@contextmanager
def heard(listener: Listener) -> Iterator[None]:
    """Meanwhile the listener is told."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


def begins(name: str) -> None:
    """A function is about to be compiled."""
    underway.append(name)
    for listener in _listeners:
        listener.begins(name)


@contextmanager
def ended() -> Iterator[None]:
    """Whatever begins to be compiled within has been compiled, or has failed, at the end."""
    depth = len(underway)
    try:
        yield
    finally:
        if len(underway) > depth:
            del underway[depth:]
            for listener in _listeners if depth == 0 else ():
                listener.ends()
