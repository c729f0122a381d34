"""Floats: decimal numbers from text, in bulk and correctly rounded."""

from __future__ import annotations

import re
import warnings

import numpy as np
from numpy.typing import NDArray

from orbiframe_polygons.powers import powers_of_ten

Bytes = NDArray[np.uint8]
Floats = NDArray[np.float64]

NUMBER = re.compile(rb"[+-]?(\d++(\.\d*+)?|\.\d++)([eE][+-]?\d++)?")
# From so many bytes on, compiled loops gain more time than the import of the compiler takes.
LARGE = 2**22


def parsed(data: Bytes, count: int) -> Floats | None:
    """The numbers of a text of so many words, whatever the locale; None where a word is no decimal number."""
    values = _compiled(data, count) if len(data) >= LARGE else _plain(data.tobytes())
    return values if values is not None and len(values) == count else None


def _plain(text: bytes) -> Floats | None:
    """Two numbers that are written without a blank between them ("1-2") count as two."""
    if not text.strip():
        return np.empty(0)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, dtype=np.float64, sep=" ")
        except (ValueError, DeprecationWarning):
            return None


def _compiled(data: Bytes, count: int) -> Floats | None:
    from orbiframe_polygons.compiled_numbers import parse_words

    values, hard = np.empty(count), np.empty((1000 + count // 50, 3), dtype=np.intp)
    _, left = parse_words(data, powers_of_ten(rounded_up=False), values, values.view(np.uint64), hard)
    if left > len(hard):
        return _plain(data.tobytes())
    for index, first, last in hard[:left].tolist():
        word = data[first:last].tobytes()
        if not NUMBER.fullmatch(word):
            return None
        values[index] = float(word)
    return values
