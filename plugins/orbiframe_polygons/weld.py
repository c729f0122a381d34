"""Weld: points with equal coordinates become one vertex."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes import clusters, first_of_each

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Points = NDArray[np.floating[Any]]

# From so many faces on, compiled loops gain more time than the import of the compiler takes.
LARGE = 2**17


def welded(corners: Points) -> tuple[Floats, Ints]:
    """The different corners of faces (n, m, 3) as (V, 3), in the order in which they first occur, and their numbers.

    corners: finite; the second result is (n · m,). Points are equal if all coordinates are, to the last bit; only 0
    and -0 are the same.
    """
    unique, place = (_hashed if len(corners) >= LARGE else _sorted)(corners)
    return unique.astype(np.float64), place


def _sorted(corners: Points) -> tuple[Points, Ints]:
    points = corners.reshape(-1, 3) + corners.dtype.type(0)
    label = clusters(points.astype(np.float64))
    return points[first_of_each(label)], label


def _hashed(corners: Points) -> tuple[Points, Ints]:
    from orbiframe_polygons.compiled_weld import number_points

    count = corners.size // 3
    unique, place = np.empty((count, 3), dtype=corners.dtype), np.empty(count, dtype=np.intp)
    code = np.dtype(f"u{corners.dtype.itemsize}")
    minus_zero = corners.dtype.type(-0.0).view(code)
    found = number_points(corners.view(code), minus_zero, unique.view(code), place)
    return unique[:found], place
