"""Places in triangles: numbers of triangles and barycentric coordinates, as users give them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.errors import GeometryError

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_ROUNDING = 1e-9


def require_places(face: ArrayLike, barycentric: ArrayLike, count: int) -> tuple[Ints, Floats]:
    """Triangles (n,) of `count` and barycentric coordinates (n, 3) in them, as arrays of numbers.

    Raises GeometryError, naming the first place that is wrong, for other shapes, numbers of triangles that are not
    whole or not there, and coordinates that are negative, not finite or of another sum than 1.
    """
    faces, weights = np.asarray(face), np.asarray(barycentric, dtype=np.float64)
    if faces.ndim != 1 or weights.shape != (*faces.shape, 3):
        raise GeometryError(
            f"triangles of the shape {faces.shape} and barycentric coordinates of the shape {weights.shape}; they must "
            "be (n,) and (n, 3)"
        )
    if faces.size and faces.dtype.kind not in "iu":
        raise GeometryError(f"triangles are numbers of {faces.dtype}; they must be whole, from 0 on")
    for number in np.flatnonzero((faces < 0) | (faces >= count))[:1]:
        raise GeometryError(f"place {number} lies in triangle {faces[number]}; the triangles are 0 to {count - 1}")
    sums = weights.sum(axis=1)
    for number in np.flatnonzero(~((np.abs(sums - 1) <= _ROUNDING) & (weights >= -_ROUNDING).all(axis=1)))[:1]:
        raise GeometryError(
            f"place {number} has the barycentric coordinates {weights[number].tolist()}; they must not be negative, "
            f"and their sum, which is {sums[number]:.6g}, must be 1"
        )
    return faces.astype(np.intp), weights
