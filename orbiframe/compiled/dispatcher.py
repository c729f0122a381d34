"""Dispatcher: numba's own, with machine code of our own keeping and one version for each type.

Nothing imports this module, and with it numba, before something has to be compiled.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import CellType, CodeType, FunctionType
from typing import Any

from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher
from numba.core.sigutils import normalize_signature
from numba.core.types.misc import unliteral

from orbiframe.compiled import compilation
from orbiframe.compiled.compiled_function import CompiledFunction
from orbiframe.compiled.versions import Versions


class Dispatcher(CPUDispatcher):  # type: ignore[misc]
    """A function that is compiled for the types of its arguments when they are first met.

    Whoever calls it from compiled code gets one version for each type, whereas numba makes another one for each number
    that stands in a call; and a version without the wrapper that takes Python's objects. That is made, anew, when
    Python calls the function with the same types.
    """

    def __init__(self, function: CompiledFunction) -> None:
        super().__init__(_for_numba(function.py_func), targetoptions=dict(function.options))
        self._source = function
        self._cache = Versions(self, function)
        self._bare: set[tuple[Any, ...]] = set()
        self.wrapped = True

    def look_around(self) -> None:
        """Enter what the function names, as it is now, into its globals."""
        _let_call(self.py_func, self._source.py_func)

    def entry(self, arguments: tuple[Any, ...]) -> Any:
        """The version for arguments like these, to be called from Python; compiled, if need be."""
        return self.compile(tuple(self.typeof_pyval(argument) for argument in arguments))

    def compile(self, signature: Any) -> Any:
        """The code for a signature: that of before, or kept code, or new code."""
        # Under the lock, since another thread may just be making a version without a wrapper.
        with global_compiler_lock, compilation.ended():
            self.look_around()
            kinds = tuple(normalize_signature(signature)[0])
            if self.wrapped and kinds in self._bare:
                self._bare.remove(kinds)
                del self.overloads[kinds]
            return super().compile(signature)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """What the compiler asks for where compiled code calls this function."""
        args = tuple(unliteral(arg) for arg in args)
        kws = {name: unliteral(arg) for name, arg in kws.items()}
        self._wrap(False)
        try:
            return super().get_call_template(args, kws)
        finally:
            self._wrap(True)

    def add_overload(self, result: Any) -> None:
        """Enter a version; one without a wrapper stays unknown to the part that looks for versions from Python."""
        if self.wrapped:
            super().add_overload(result)
        else:
            self.overloads[tuple(result.signature.args)] = result
            self._bare.add(tuple(result.signature.args))

    def _wrap(self, wrapped: bool) -> None:
        self.wrapped = wrapped
        self.targetoptions["no_cpython_wrapper"] = not wrapped


def _for_numba(function: Callable[..., Any]) -> FunctionType:
    """The function with globals of its own, where compiled functions will be replaced by numba's."""
    assert isinstance(function, FunctionType)
    closure = tuple(CellType(_of_numba(cell.cell_contents)) for cell in function.__closure__ or ())
    found = FunctionType(function.__code__, {}, function.__name__, function.__defaults__, closure)
    found.__module__, found.__qualname__ = function.__module__, function.__qualname__
    found.__doc__, found.__kwdefaults__ = function.__doc__, function.__kwdefaults__
    return found


def _let_call(copy: FunctionType, function: Callable[..., Any]) -> None:
    """Enter what a function names, as it is now, into the globals of its copy."""
    assert isinstance(function, FunctionType)
    named = function.__globals__
    copy.__globals__.update({"__builtins__": named["__builtins__"], "__name__": named["__name__"]})
    copy.__globals__.update({name: _of_numba(named[name]) for name in _names(function.__code__) if name in named})


def _of_numba(value: Any) -> Any:
    return value.dispatcher if isinstance(value, CompiledFunction) else value


def _names(code: CodeType) -> Iterator[str]:
    """The globals that a function and those within it name."""
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)
