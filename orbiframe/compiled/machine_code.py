"""Machine code: kept code put into memory and called, by llvmlite and the parts of numba that are written in C.

numba itself, which takes ten times as long to be imported as all code of a fit to be loaded, is left out.
"""

from __future__ import annotations

import builtins
import ctypes
import os
import pickle
import sys
from collections.abc import Callable
from functools import cache
from importlib.machinery import PathFinder
from importlib.metadata import version
from importlib.util import find_spec, module_from_spec
from threading import Lock
from typing import Any, NamedTuple

import llvmlite.binding as llvm

# Versions of numba whose machine code was tried without it; code of others is loaded by numba.
_TRIED = ("0.68.",)
# Functions of C that numba calls by their own names, for numbers of 64 bits and, with an f, of 32.
_MATHEMATICS = (
    *("pow", "sin", "cos", "sqrt", "exp", "log", "log10", "fabs", "floor", "ceil", "trunc", "tan", "sinh", "cosh"),
    *("tanh", "asin", "acos", "atan", "atan2", "asinh", "acosh", "atanh", "expm1", "log1p", "fmod", "round"),
)

_loading = Lock()


class MachineCode(NamedTuple):
    """The machine code of a function.

    code: an object file; wrapper: the name of the function in it that takes Python's objects; environments: names of
    pointers in it, each to objects of Python that it needs.
    """

    code: bytes
    wrapper: str
    name: str
    environments: tuple[tuple[str, tuple[Any, ...]], ...]


@cache
def can_load() -> bool:
    """Whether machine code can do without numba."""
    return version("numba").startswith(_TRIED)


@cache
def processor() -> tuple[str, str, str]:
    """The processor, as far as machine code depends on it."""
    return llvm.get_process_triple(), llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


def loaded(code: MachineCode) -> Callable[..., Any]:
    """The function, to be called from Python. Each has memory and names of its own."""
    with _loading:
        dynamic, engine = _prepared(), _engine()
        engine.add_object_file(llvm.ObjectFileRef.from_data(code.code))
        engine.finalize_object()
        environments = [_environment(dynamic, engine, *each) for each in code.environments]
    address, alive = engine.get_function_address(code.wrapper), (engine, *environments)
    found: Callable[..., Any] = dynamic.make_function(
        sys.modules[__name__], code.name, code.name, address, environments[0], alive
    )
    return found


def _engine() -> Any:
    target = llvm.Target.from_default_triple().create_target_machine()
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), target)


def _environment(dynamic: Any, engine: Any, name: str, objects: tuple[Any, ...]) -> Any:
    """Objects of Python that machine code needs, where it looks for them."""
    found = dynamic.Environment({})
    found.consts[:] = objects
    (ctypes.c_void_p * 1).from_address(engine.get_global_value_address(name))[0] = id(found)
    return found


@cache
def _prepared() -> Any:
    """What machine code calls, entered where it is looked for; gives back the part that makes functions."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    dynamic, helpers = _part("numba._dynfunc"), _part("numba._helperlib").c_helpers
    memory = _part("numba.core.runtime._nrt_python").c_helpers
    errors = [each for each in vars(builtins).values() if isinstance(each, type) and issubclass(each, BaseException)]
    symbols = {
        "_Py_NoneStruct": id(None),
        **{f"PyExc_{error.__name__}": id(error) for error in errors},
        **{f"numba_{name}": address for name, address in {**helpers, **dynamic.c_helpers}.items()},
        **{name if name.startswith("_") else f"NRT_{name}": address for name, address in memory.items()},
        **{name: helpers[name] for plain in _MATHEMATICS for name in (plain, f"{plain}f")},
        "numba_unpickle": ctypes.cast(_unpickled, ctypes.c_void_p).value,
    }
    for name, address in symbols.items():
        llvm.add_symbol(name, address)
    return dynamic


def _part(name: str) -> Any:
    """A module of numba in C; numba, if it is imported later, goes on with the same."""
    if name not in sys.modules:
        whole = find_spec("numba")
        assert whole is not None
        folders = [os.path.join(place, *name.split(".")[1:-1]) for place in whole.submodule_search_locations or ()]
        spec = PathFinder.find_spec(name, folders)
        if spec is None or spec.loader is None:
            raise ImportError(f"numba {version('numba')} has no part {name}")
        sys.modules[name] = module_from_spec(spec)
        spec.loader.exec_module(sys.modules[name])
    return sys.modules[name]


_objects: dict[tuple[int, bytes], Any] = {}


@ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p)
def _unpickled(place: int, size: int, digest: int) -> Any:
    """An object of Python that lies in machine code as a pickle, known by its digest; numba's own imports numba."""
    key = place, ctypes.string_at(digest, 20)
    if key not in _objects:
        _objects[key] = pickle.loads(ctypes.string_at(place, size))
    return _objects[key]
