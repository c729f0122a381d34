"""Pardiso: a solver of sparse Hermitian positive definite equations, where pypardiso is installed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pypardiso import PyPardisoSolver
from pypardiso.pardiso_wrapper import PyPardisoError
from scipy.sparse import block_array, csc_array, csr_array, triu

from orbiframe import MapError

Numbers = NDArray[Any]
Solution = Callable[[Numbers], Numbers]


def pardiso(matrix: csc_array[Any]) -> Solution:
    """Intel's Pardiso (Schenk and Gärtner, 2004), by pypardiso; a Hermitian system as a real one of twice the size.

    Raises MapError for a singular matrix.
    """
    count, complex_ = matrix.shape[0], matrix.dtype.kind == "c"
    upper = csr_array(triu(_real(matrix) if complex_ else matrix, format="csr"))
    solver = PyPardisoSolver(mtype=2)
    try:
        _require_diagonal(upper)
        solver.factorize(upper)
    except (PyPardisoError, ValueError) as error:
        raise MapError(f"singular equations of the map, Pardiso says: {error}; take solver.name = 'auto'") from error

    def solution(right: Numbers) -> Numbers:
        if not complex_:
            return np.asarray(solver.solve(upper, np.asfortranarray(right))).reshape(right.shape)
        both = np.asfortranarray(np.concatenate([right.real, right.imag]))
        found = np.asarray(solver.solve(upper, both)).reshape(both.shape)
        return np.asarray(found[:count] + 1j * found[count:])

    return solution


def _real(matrix: csc_array[Any]) -> csc_array[Any]:
    """The real symmetric matrix of twice the size that does to real and imaginary parts what a Hermitian one does."""
    return csc_array(block_array([[matrix.real, -matrix.imag], [matrix.imag, matrix.real]]))


def _require_diagonal(upper: csr_array[Any]) -> None:
    if not (upper.diagonal() > 0).all():
        raise ValueError("a number on its diagonal is not positive")
