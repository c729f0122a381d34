"""Room: how much may come out of a file of a given size, counted before it is made."""

from __future__ import annotations

from pathlib import Path

from orbiframe import FormatError

# A file may grow so far: for each of its bytes so many numbers or steps, and some more.
GROWTH, ROOM = 64, 2**20


class Budget:
    """A number of steps or numbers that is used up; whoever asks for more is refused."""

    def __init__(self, path: Path, what: str) -> None:
        self._path = path
        self._what = what
        self._all = self._left = ROOM + GROWTH * path.stat().st_size

    def spend(self, count: int) -> None:
        """Take so many. Raises FormatError where they are no longer there."""
        self._left -= count
        if self._left < 0:
            raise FormatError(
                f"{self._path}: {self._what} too often: more than {self._all}, which a file of this size may have"
            )
