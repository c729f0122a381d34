"""Versions: what numba asks for code that was compiled before, and gives what it has compiled."""

from __future__ import annotations

import pickle
from typing import Any

from numba.core.compiler import CompileResult
from numba.core.serialize import dumps
from numba.core.types.containers import BaseTuple

from orbiframe.compiled import compilation
from orbiframe.compiled.kept_code import KeptCode
from orbiframe.compiled.machine_code import MachineCode


class Versions:
    """The versions of one function, kept as numba links them, those for Python also as machine code alone."""

    def __init__(self, dispatcher: Any, function: Any) -> None:
        self._dispatcher, self._function, self._kept = dispatcher, function, KeptCode(function)

    @property
    def cache_path(self) -> str:
        """The folder that is tried first."""
        return self._kept.folder

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The code for a signature, or None; then it will be compiled."""
        context.refresh()
        found = self._kept.read(described_types(signature), self._dispatcher.wrapped)
        if found is not None:
            return CompileResult._rebuild(context, *pickle.loads(found.linked))
        compilation.begins(self._function.__qualname__)
        return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep the code for a signature, where it does not hold addresses of this process."""
        if result.library.has_dynamic_globals or any(not part.can_cache for part in result.lifted):
            return
        wrapped = self._dispatcher.wrapped
        linked = dumps(result._reduce())
        self._kept.write(described_types(signature), wrapped, linked, dumps(machine_code(result)) if wrapped else b"")

    def enable(self) -> None:
        """Asked for by numba; always so."""

    def disable(self) -> None:
        """Asked for by numba; never so."""

    def flush(self) -> None:
        """Asked for by numba; files that are out of date are written over in any case."""


def machine_code(result: Any) -> MachineCode:
    """The machine code of a version for Python, without what numba knows of it."""
    code = result.library.serialize_using_object_code()[2][0]
    own, others = result.environment, result._find_referenced_environments()
    environments = [own, *(other for other in others if other is not own)]
    return MachineCode(
        code,
        result.fndesc.llvm_cpython_wrapper_name,
        result.fndesc.qualname,
        tuple((each.env_name, tuple(each.consts)) for each in environments),
    )


def described_types(signature: Any) -> str:
    """The types of arguments as numba has them, in the words of `kinds.described`."""
    return ", ".join(_described(kind) for kind in getattr(signature, "args", signature))


def _described(kind: Any) -> str:
    if not isinstance(kind, BaseTuple):
        return str(kind)
    named = getattr(kind, "instance_class", None)
    fields = (named.__module__, named.__qualname__, named._fields) if named else ""
    return f"{fields}({', '.join(_described(part) for part in kind.types)})"
