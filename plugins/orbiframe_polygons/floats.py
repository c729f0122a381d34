"""Floats: decimal numbers from text, in bulk."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def parsed(text: bytes) -> Floats | None:
    """The numbers of a text, correctly rounded whatever the locale; None where a word is no number.

    Two numbers that are written without a blank between them ("1-2") count as two: compare with the number of words.
    """
    if not text.strip():
        return np.empty(0)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, dtype=np.float64, sep=" ")
        except (ValueError, DeprecationWarning):
            return None
