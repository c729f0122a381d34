"""Fingerprints: what the machine code of a function is made of, as a number that changes with it."""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

# What numba is told in the environment or in a file of settings of its own, except where code is kept and who runs it.
_SETTINGS, _NO_MATTER = ".numba_config.yaml", ("NUMBA_CACHE_DIR=", "NUMBA_NUM_THREADS=")
_PLAIN = (bool, int, float, complex, str, bytes, type(None), type(...))


def fingerprint(function: Any) -> bytes:
    """A number for a compiled function, all compiled functions that it calls, and all constants that these name.

    It holds their instructions and options, not their text: a comment changes nothing, and a helper's helper in
    another file does. Raises TypeError where a function names something else, as code could then grow old unnoticed.
    """
    reached, digest = [function], hashlib.sha256()
    for each in reached:
        own, called = _own(each)
        reached += [callee for callee in called if callee not in reached]
        digest.update(own + repr([reached.index(callee) for callee in called]).encode())
    return digest.digest()


@cache
def _own(function: Any) -> tuple[bytes, tuple[Any, ...]]:
    """The fingerprint of one function without those that it calls, and these."""
    called: list[Any] = []
    plain = function.py_func
    parts = [plain.__module__, plain.__qualname__, repr(sorted(_options(function).items()))]
    parts += [_described(plain.__defaults__, called), _described(plain.__kwdefaults__, called)]
    parts += [_described(cell.cell_contents, called) for cell in plain.__closure__ or ()]
    parts += _code(plain.__code__, plain.__doc__, plain, called)
    return hashlib.sha256("\n".join(parts).encode()).digest(), tuple(called)


def _options(function: Any) -> dict[str, Any]:
    return dict(function.options)


def _code(code: CodeType, doc: str | None, function: FunctionType, called: list[Any]) -> Iterator[str]:
    """Instructions, constants and named globals; a docstring is none of these."""
    yield repr((code.co_code, code.co_varnames, code.co_freevars, code.co_cellvars, code.co_names, code.co_flags))
    yield repr(getattr(code, "co_exceptiontable", b""))
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _code(constant, None, function, called)
        elif doc is None or constant != doc:
            yield _described(constant, called)
    for name in code.co_names:
        if name in function.__globals__:
            try:
                yield f"{name} = {_described(function.__globals__[name], called, code.co_names)}"
            except TypeError as error:
                raise TypeError(f"the compiled function {function.__qualname__} names {name}: {error}") from None


def _described(value: Any, called: list[Any], names: tuple[str, ...] = ()) -> str:
    if hasattr(value, "py_func"):
        called.append(value)
        return "a compiled function"
    if isinstance(value, ModuleType):
        # Of a module only what is named with it, as in `np.inf`.
        members = [name for name in names if name in vars(value) and not isinstance(vars(value)[name], ModuleType)]
        return repr([value.__name__, *(f"{name} = {_described(vars(value)[name], called)}" for name in members)])
    if isinstance(value, np.ndarray | np.generic):
        return repr((value.dtype.str, value.shape, value.tobytes()))
    if isinstance(value, tuple | frozenset):
        parts = [_described(part, called) for part in value]
        return repr((type(value).__qualname__, parts if isinstance(value, tuple) else sorted(parts)))
    if isinstance(value, type):
        return repr((value.__module__, value.__qualname__, getattr(value, "_fields", None)))
    if isinstance(value, (np.dtype, *_PLAIN)):
        return f"{type(value).__name__} {value!r}"
    if isinstance(value, np.ufunc) or hasattr(value, "__qualname__"):
        return repr((getattr(value, "__module__", None), getattr(value, "__qualname__", repr(value))))
    raise TypeError(f"a {type(value).__name__} has no fingerprint; name a number, an array or a tuple of these")


@cache
def _versions() -> tuple[str, ...]:
    return str(sys.implementation.cache_tag), version("numba"), version("llvmlite"), np.__version__


def describe_machine(processor: tuple[str, ...]) -> str:
    """The processor, the versions and the settings that machine code depends on."""
    settings = sorted(f"{name}={value}" for name, value in os.environ.items() if name.startswith("NUMBA_"))
    settings = [setting for setting in settings if not setting.startswith(_NO_MATTER)]
    with suppress(OSError):
        settings.append(Path(_SETTINGS).read_text(encoding="utf-8"))
    return repr((processor, _versions(), settings))
