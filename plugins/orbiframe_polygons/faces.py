"""Faces: lists of corners of any length, side by side in one array, and what must hold for them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Place = Callable[[int], str]

EXACT = float(2**53)


def ragged(first: Ints, sizes: Ints) -> Ints:
    """The positions first[i], first[i] + 1, …, first[i] + sizes[i] - 1 of all i, one after the other."""
    if len(sizes) and (sizes == sizes[0]).all():
        return (first[:, None] + np.arange(sizes[0])).ravel()
    offsets = np.cumsum(sizes) - sizes
    return np.repeat(first - offsets, sizes) + np.arange(int(sizes.sum()))


def offsets_of(sizes: Ints) -> Ints:
    """Where each list starts if lists of these sizes stand one after the other, (n + 1,)."""
    return np.concatenate([[0], np.cumsum(sizes)]).astype(np.intp)


def whole(values: Floats | Ints, place: Place) -> Ints:
    """Numbers as integers. Raises FormatError with the place of the first that is none."""
    if values.dtype.kind in "iu":
        return values.astype(np.intp)
    with np.errstate(invalid="ignore"):
        integers = values.astype(np.intp)
    wrong = (integers != values) | (np.abs(values) > EXACT)
    if wrong.any():
        bad = int(wrong.argmax())
        raise FormatError(f"{place(bad)}: found {values[bad]:g}, but a whole number is required")
    return integers


def require_sizes(sizes: Ints, place: Place) -> None:
    """Raise FormatError unless every face has three corners or more."""
    bad = np.flatnonzero(sizes < 3)
    if len(bad):
        raise FormatError(
            f"{place(int(bad[0]))}: face {bad[0]} has {sizes[bad[0]]} corners, but at least 3 are required; drop it"
        )


def corners(values: Floats | Ints, sizes: Ints, count: int, place: Place, *, noun: str = "vertex") -> Ints:
    """The corners of faces of the given sizes as indices.

    Raises FormatError with the face unless every corner is a whole number from 0 to count - 1; noun: what they index.
    """

    def face(corner: int) -> int:
        return int(np.searchsorted(np.cumsum(sizes), corner, side="right"))

    tail = whole(values, lambda corner: place(face(corner)))
    if tail.min(initial=0) < 0 or tail.max(initial=-1) >= count:
        bad = np.flatnonzero((tail < 0) | (tail >= count))
        wrong = face(int(bad[0]))
        raise FormatError(
            f"{place(wrong)}: face {wrong} names {noun} {tail[bad[0]]} (the first is 0), but the file has only {count}"
        )
    return tail


def require_finite(values: NDArray[np.floating], place: Place) -> None:
    """Raise FormatError with the row unless a table (n, k) holds finite numbers only."""
    if not np.isfinite(values).all():
        bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
        numbers = ", ".join(f"{x:g}" for x in values[bad[0]].tolist())
        raise FormatError(f"{place(int(bad[0]))}: found {numbers} in row {bad[0]}, but only finite numbers are allowed")


def colours(values: Floats) -> Floats:
    """Colours from 0 to 1, whether the file counts to 1 or to 255."""
    return values / 255 if (values > 1).any() else values


def require_colours(values: Floats | None, path: Path) -> None:
    """Raise FormatError unless all components of all colours lie between 0 and 1."""
    if values is not None and ((values < 0) | (values > 1)).any():
        raise FormatError(f"{path}: a colour has a component below 0 or too large; components count to 1 or to 255")
