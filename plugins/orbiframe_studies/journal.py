"""Journal: what came of every fit, a line of JSON each, written when it ends; half a line is none."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from orbiframe import FormatError

Entry = dict[str, Any]
_NEEDED = {"key": str, "status": str, "timing": dict}


class Journal:
    """Entries by the keys of fits; in memory are only the places of their lines.

    A line that was cut off, or is none for another reason, counts as never written; its fit is done again. damaged:
    how many such lines there were.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.damaged = path, 0
        self._places: dict[str, tuple[int, int]] = {}
        self._unfinished: dict[str, str] = {}
        self._file = path.open("ab", buffering=0)
        self._read_places()
        self._reader = path.open("rb")

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()
        self._reader.close()

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __len__(self) -> int:
        return len(self._places)

    def __contains__(self, key: str) -> bool:
        return key in self._places

    def __getitem__(self, key: str) -> Entry:
        start, length = self._places[key]
        self._reader.seek(start)
        found: Entry = json.loads(self._reader.read(length))
        return found

    def get(self, key: str) -> Entry | None:
        """The entry of a key, None where there is none."""
        return self[key] if key in self._places else None

    def add(self, entry: Entry) -> None:
        """Write an entry; one of the same key is forgotten. Raises FormatError where there is no room."""
        line = json.dumps(entry, allow_nan=False).encode() + b"\n"
        start = self._file.seek(0, os.SEEK_END)
        try:
            written = self._file.write(line)
            reason = "" if written == len(line) else "there is no room for the whole line"
        except OSError as error:
            reason = error.strerror or str(error)
        if reason:
            with suppress(OSError):
                self._file.truncate(start)
            raise FormatError(
                f"{self.path} cannot be written: {reason}; make room, and run the study again: it goes on"
            )
        self._note(entry, start, len(line))

    def status(self, key: str) -> str:
        """The status of an entry."""
        return self._unfinished.get(key, "done")

    def _note(self, entry: Entry, start: int, length: int) -> None:
        self._places[entry["key"]] = (start, length)
        self._unfinished.pop(entry["key"], None)
        if entry["status"] != "done":
            self._unfinished[entry["key"]] = entry["status"]

    def forget(self, key: str) -> None:
        """Let a fit count as not done."""
        self._places.pop(key, None)
        self._unfinished.pop(key, None)

    def _read_places(self) -> None:
        start, line = 0, b"\n"
        with self.path.open("rb") as lines:
            for line in lines:
                entry = _entry(line)
                if entry is None:
                    self.damaged += 1
                else:
                    self._note(entry, start, len(line))
                start += len(line)
        if not line.endswith(b"\n"):  # so that the next line is whole
            self._file.write(b"\n")

    def keys(self) -> Iterator[str]:
        """The keys of all entries."""
        yield from self._places


def _entry(line: bytes) -> Entry | None:
    try:
        found = json.loads(line)
        whole = all(isinstance(found[name], kind) for name, kind in _NEEDED.items())
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
    return found if whole and found["status"] in ("done", "failed", "lost") else None
