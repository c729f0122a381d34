"""Kept code: machine code of one function in files, one for each combination of argument types."""

from __future__ import annotations

import hashlib
import inspect
import pickle
from pathlib import Path
from typing import Any

from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from orbiframe.compiled import compilation
from orbiframe.compiled.code_folders import code_folders, read_code, write_code
from orbiframe.compiled.fingerprint import describe_machine, describe_types, fingerprint

_DIGEST = hashlib.sha256().digest_size


class KeptCode:
    """What numba asks for code that was compiled before, and gives what it has compiled.

    A file begins with a number made of its own content and of everything that the code depends on. So code is used only
    where all of that is as it was: a file of another time, of another helper, or cut short is as good as none, and is
    written over. Files are put in their place whole, so that several processes never meet half of one.
    """

    def __init__(self, function: Any) -> None:
        self._function, self._source = function, Path(inspect.getfile(function.py_func))

    @property
    def cache_path(self) -> str:
        """The folder that is tried first."""
        return str(code_folders(self._source)[0].path)

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The code for a signature, or None; then it will be compiled."""
        context.refresh()
        name, key = self._name_and_key(signature, context.codegen())
        for content in read_code(self._source, name):
            if content[:_DIGEST] == _digest(key, content[_DIGEST:]):
                return CompileResult._rebuild(context, *pickle.loads(content[_DIGEST:]))
        compilation.begins(self._function.py_func.__qualname__)
        return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep the code for a signature, where it does not hold addresses of this process."""
        if result.library.has_dynamic_globals or any(not part.can_cache for part in result.lifted):
            return
        name, key = self._name_and_key(signature, result.codegen)
        payload = dumps(result._reduce())
        write_code(self._source, name, _digest(key, payload) + payload)

    def enable(self) -> None:
        """Asked for by numba; always so."""

    def disable(self) -> None:
        """Asked for by numba; never so."""

    def flush(self) -> None:
        """Asked for by numba; files that are out of date are written over in any case."""

    def _name_and_key(self, signature: Any, codegen: Any) -> tuple[str, bytes]:
        """The file for a signature on this machine, and all that its code depends on."""
        function = self._function.py_func
        kind = [describe_types(signature), describe_machine(codegen.magic_tuple()), str(self._function.wrapped)]
        short = hashlib.sha256("\n".join([function.__module__, *kind]).encode()).hexdigest()[:16]
        plain = "".join(letter for letter in function.__qualname__ if letter.isalnum() or letter in "_.")
        return f"{plain}-{short}.nbc", fingerprint(self._function) + "\n".join(kind).encode()


def _digest(key: bytes, payload: bytes) -> bytes:
    return hashlib.sha256(hashlib.sha256(key).digest() + payload).digest()
