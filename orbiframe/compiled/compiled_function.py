"""A compiled function: runs kept machine code, and calls numba only where there is none yet."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import update_wrapper
from threading import RLock
from typing import Any

from orbiframe.compiled.kept_code import KeptCode
from orbiframe.compiled.kinds import described, kind_of

_making = RLock()


class CompiledFunction:
    """A function whose machine code is made for the kinds of its arguments when they are first met, and kept.

    Kept code is loaded without numba, whose import and whose own preparations take longer than a small fit.
    """

    __name__: str
    __qualname__: str

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        update_wrapper(self, function)
        self.py_func, self.options = function, options
        self._signature, self._entries = inspect.signature(function), dict[object, Callable[..., Any]]()
        self._count, self._kept = len(self._signature.parameters), KeptCode(self)
        self._loading = RLock()
        self._dispatcher: Any = None

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Run the machine code for arguments of these kinds."""
        if named or len(arguments) != self._count:
            arguments = self._bound(arguments, named)
        kinds = tuple(map(kind_of, arguments))
        entry = self._entries.get(kinds)
        if entry is None:
            entry = self._entries[kinds] = self._entry(arguments)
        return entry(*arguments)

    def __reduce__(self) -> str:
        return self.__qualname__

    @property
    def dispatcher(self) -> Any:
        """What compiles the function, and what compiled functions call."""
        from orbiframe.compiled.dispatcher import Dispatcher

        with _making:
            if self._dispatcher is None:
                # Known before it looks around, as functions may call each other.
                self._dispatcher = Dispatcher(self)
                self._dispatcher.look_around()
            return self._dispatcher

    def _bound(self, arguments: tuple[Any, ...], named: dict[str, Any]) -> tuple[Any, ...]:
        """All arguments in their order, those with defaults too."""
        bound = self._signature.bind(*arguments, **named)
        bound.apply_defaults()
        return bound.args

    def _entry(self, arguments: tuple[Any, ...]) -> Callable[..., Any]:
        """The code for arguments like these: met before in other words, kept, or new."""
        kinds = described(arguments)
        if kinds is None:
            found: Callable[..., Any] = self.dispatcher
            return found
        with self._loading:
            if kinds not in self._entries:
                self._entries[kinds] = self._kept.entry(kinds) or self.dispatcher.entry(arguments)
            return self._entries[kinds]
