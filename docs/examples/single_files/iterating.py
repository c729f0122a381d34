"""Iterating: a solver without factors, conjugate gradients scaled by the diagonal: little memory, much time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import cg

from orbiframe import MapError
from orbiframe.plugin import Component, hookimpl

Numbers = NDArray[Any]


@hookimpl
def orbiframe_components() -> list[Component]:
    """The solver of this file."""
    return [Component("solver", "iterating", "iterating:iterating", "conjugate gradients, without factors")]


def iterating(matrix: csc_array[Any]) -> Callable[[Numbers], Numbers]:
    """Conjugate gradients (Hestenes and Stiefel, 1952) until the residual is rounding.

    Raises MapError for a number on the diagonal that is not positive.
    """
    diagonal = matrix.diagonal().real
    if not (diagonal > 0).all():
        raise MapError("the equations of the map are singular; look for degenerate triangles with `orbiframe info`")
    scaling = diags_array(1 / diagonal)

    def column(right: Numbers) -> Numbers:
        found = cg(matrix, right, rtol=1e-14, maxiter=20 * len(right), M=scaling)[0]
        return np.asarray(found + cg(matrix, right - matrix @ found, rtol=1e-3, maxiter=20 * len(right), M=scaling)[0])

    def solution(right: Numbers) -> Numbers:
        columns = right.reshape(len(right), -1).T
        return np.stack([column(one) for one in columns], axis=1).reshape(right.shape)

    return solution
