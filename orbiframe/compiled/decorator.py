"""The decorator of compiled functions."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from typing import Any

from orbiframe.compiled.compiled_function import CompiledFunction


def compiled(
    function: Callable[..., Any] | None = None,
    *,
    arrays: bool = True,
    may_divide_by_zero: bool = False,
    inline: bool = False,
) -> Any:
    """Compile a function to machine code when it is first called, and keep the code for the next process.

    The kept code is used again only while nothing has changed that it was made of: the function, all compiled functions
    that it calls, all constants that these name. While it runs other threads run too. Code needs no array assigned to a
    slice or row, no sort and no concatenation: each costs seconds at the first run, and a loop costs nothing.

    arrays: False for a function that makes no array; it need not count who refers to those that it is given, which
    takes longer than little work with them. may_divide_by_zero: division by zero gives inf or nan as in numpy;
    otherwise it is an error, at the price of a test in every division. inline: put the function into its callers.
    """
    if function is None:
        return partial(compiled, arrays=arrays, may_divide_by_zero=may_divide_by_zero, inline=inline)
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return function
    # All said outright, as what is not said would be taken from whichever function is the first to call this one.
    options = {
        "nopython": True,
        "boundscheck": None,
        "_nrt": arrays,
        "error_model": "numpy" if may_divide_by_zero else "python",
        "inline": "always" if inline else "never",
        "fastmath": False,
        "forceinline": False,
        "nogil": True,
        "no_cfunc_wrapper": True,
    }
    return CompiledFunction(function, options)
