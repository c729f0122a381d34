"""Kept code: machine code of one function in files, one for each combination of argument types."""

from __future__ import annotations

import hashlib
import inspect
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from orbiframe.compiled.code_folders import code_folders, read_code, write_code
from orbiframe.compiled.fingerprint import describe_machine, fingerprint
from orbiframe.compiled.machine_code import can_load, loaded, processor

_DIGEST = hashlib.sha256().digest_size


class Kept(NamedTuple):
    """A version of a function: linked, as numba takes it up, and machine, its machine code alone; b"" for none."""

    linked: bytes
    machine: bytes


class KeptCode:
    """The versions of a function that are kept.

    A file begins with a number made of its own content and of everything that the code depends on. So code is used only
    where all of that is as it was: a file of another time, of another helper, or cut short is as good as none, and is
    written over. Files are put in their place whole, so that several processes never meet half of one.
    """

    def __init__(self, function: Any) -> None:
        self._function, self._source = function, Path(inspect.getfile(function.py_func))

    @property
    def folder(self) -> str:
        """The folder that is tried first."""
        return str(code_folders(self._source)[0].path)

    def entry(self, kinds: str) -> Callable[..., Any] | None:
        """The version for Python for these kinds of arguments, without numba; None where that cannot be."""
        found = self.read(kinds, True) if can_load() else None
        return loaded(pickle.loads(found.machine)) if found and found.machine else None

    def read(self, kinds: str, wrapped: bool) -> Kept | None:
        """The version for these kinds of arguments, with a wrapper for Python or without."""
        name, key = self._name_and_key(kinds, wrapped)
        for content in read_code(self._source, name):
            if content[:_DIGEST] == _digest(key, content[_DIGEST:]):
                return Kept(*pickle.loads(content[_DIGEST:]))
        return None

    def write(self, kinds: str, wrapped: bool, linked: bytes, machine: bytes) -> None:
        """Keep a version."""
        name, key = self._name_and_key(kinds, wrapped)
        payload = pickle.dumps((linked, machine))
        write_code(self._source, name, _digest(key, payload) + payload)

    def _name_and_key(self, kinds: str, wrapped: bool) -> tuple[str, bytes]:
        """The file for a version on this machine, and all that its code depends on."""
        function = self._function.py_func
        parts = [kinds, describe_machine(processor()), str(wrapped)]
        short = hashlib.sha256("\n".join([function.__module__, *parts]).encode()).hexdigest()[:16]
        plain = "".join(letter for letter in function.__qualname__ if letter.isalnum() or letter in "_.")
        return f"{plain}-{short}.nbc", fingerprint(self._function) + "\n".join(parts).encode()


def _digest(key: bytes, payload: bytes) -> bytes:
    return hashlib.sha256(hashlib.sha256(key).digest() + payload).digest()
