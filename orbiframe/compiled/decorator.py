"""The decorator of compiled functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit


def compiled(
    function: Callable[..., Any] | None = None,
    *,
    arrays: bool = True,
    may_divide_by_zero: bool = False,
    inline: bool = False,
) -> Any:
    """Compile a function to machine code when it is first called, and keep the code for the next process.

    arrays: False for a function that makes no array; it need not count who refers to those that it is given, which
    takes longer than little work with them. may_divide_by_zero: division by zero gives inf or nan as in numpy;
    otherwise it is an error, at the price of a test in every division. inline: put the function into its callers.
    """
    options: dict[str, Any] = {"cache": True}
    if not arrays:
        options["_nrt"] = False
    if may_divide_by_zero:
        options["error_model"] = "numpy"
    if inline:
        options["inline"] = "always"
    return njit(**options) if function is None else njit(**options)(function)
