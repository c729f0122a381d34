"""One line: what an object of arrays is, without its numbers."""

from __future__ import annotations

from dataclasses import fields
from typing import Any


def one_line(thing: Any) -> str:
    """`<Name: field (shape), field Type, field value>` for a data type whose fields may be large arrays."""
    parts = [f"{field.name} {_short(getattr(thing, field.name))}" for field in fields(thing)]
    return f"<{type(thing).__name__}: {', '.join(parts)}>"


def _short(value: Any) -> str:
    if hasattr(value, "shape") and hasattr(value, "dtype"):
        return str(value.shape) if value.shape else f"{value:.6g}"
    if value is None or isinstance(value, bool | int | str):
        return repr(value)
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, tuple | list | dict):
        return f"{type(value).__name__} of {len(value)}"
    return type(value).__name__
