"""Kinds: what arguments have to share so that the same machine code serves them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

# Of the flags of an array: contiguous by rows, by columns, writeable.
_ROWS, _COLUMNS, _WRITEABLE = 0x1, 0x2, 0x400
_SEEN = _ROWS | _COLUMNS | _WRITEABLE
_WIDEST = 1 << 63
_PLAIN = {bool: "bool", int: "int64", float: "float64", complex: "complex128", type(None): "none"}


class _Wide(int):
    """The kind of numbers that 64 bits do not hold."""


def kind_of(value: Any) -> object:
    """The kind of an argument, quickly, since every call asks for it. Two kinds may be described alike."""
    form = type(value)
    if form is np.ndarray:
        return value.dtype, value.ndim, value.flags.num & _SEEN
    if isinstance(value, tuple):
        return (form, *map(kind_of, value))
    return _Wide if form is int and not -_WIDEST <= value < _WIDEST else form


def described(values: Sequence[Any]) -> str | None:
    """The kinds of arguments in words; None where only numba knows one."""
    words = [_described(value) for value in values]
    return None if None in words else ", ".join(word for word in words if word)


def _described(value: Any) -> str | None:
    form = type(value)
    if form is np.ndarray:
        return _described_array(value)
    if isinstance(value, tuple):
        inner = described(value)
        fields = (form.__module__, form.__qualname__, form._fields) if hasattr(form, "_fields") else ""
        return None if inner is None else f"{fields}({inner})"
    if isinstance(value, np.generic):
        return value.dtype.name if value.dtype.kind in "biufc" else None
    return None if kind_of(value) is _Wide else _PLAIN.get(form)


def _described_array(array: np.ndarray[Any, Any]) -> str | None:
    if array.dtype.kind not in "biufc" or not array.dtype.isnative:
        return None
    flags = array.flags.num
    name = "array" if flags & _WRITEABLE else "readonly array"
    layout = "C" if flags & _ROWS else "F" if flags & _COLUMNS else "A"
    return f"{name}({array.dtype.name}, {array.ndim}d, {layout})"
