"""A compiled function: numba's dispatcher, with machine code of our own keeping and one version for each type."""

from __future__ import annotations

from typing import Any

from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher
from numba.core.sigutils import normalize_signature
from numba.core.types.misc import unliteral

from orbiframe.compiled import compilation
from orbiframe.compiled.kept_code import KeptCode


class CompiledFunction(CPUDispatcher):  # type: ignore[misc]
    """A function that is compiled for the types of its arguments when they are first met.

    Whoever calls it from compiled code gets one version for each type, whereas numba makes another one for each number
    that stands in a call; and a version without the wrapper that takes Python's objects. That is made, anew, when
    Python calls the function with the same types.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._cache = KeptCode(self)
        self._bare: set[tuple[Any, ...]] = set()
        self.wrapped = True

    def compile(self, signature: Any) -> Any:
        """The code for a signature: that of before, or kept code, or new code."""
        # Under the lock, since another thread may just be making a version without a wrapper.
        with global_compiler_lock, compilation.ended():
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
