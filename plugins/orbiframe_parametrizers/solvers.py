"""Solvers of sparse Hermitian positive definite equations: METIS with SuperLU, and Pardiso."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, diags_array, triu

from orbiframe import MapError
from orbiframe_parametrizers.elimination import dissection_order, factorised, minimum_degree_order

Numbers = NDArray[Any]
Solution = Callable[[Numbers], Numbers]


def metis(matrix: csc_array[Any]) -> Solution:
    """Nested dissection by METIS (Karypis and Kumar, 1998), factors by SuperLU (Li, 2005).

    Raises MapError for a singular matrix.
    """
    order = _order(matrix)
    place = np.argsort(order)
    factors = factorised(csc_array(matrix[order][:, order]))
    return lambda right: np.asarray(factors.solve(np.ascontiguousarray(right[order]))[place])


def _order(matrix: csc_array[Any]) -> NDArray[np.intp]:
    """An order in which the factors have few entries."""
    graph = csr_array((np.ones(matrix.nnz), matrix.indices, matrix.indptr), shape=matrix.shape)
    graph = csr_array(graph - diags_array(graph.diagonal()))
    graph.eliminate_zeros()
    try:
        return dissection_order(graph)
    except ImportError:
        return minimum_degree_order(graph)


def pardiso(matrix: csc_array[Any]) -> Solution:
    """Intel's Pardiso (Schenk and Gärtner, 2004), by pypardiso; a Hermitian system as a real one of twice the size.

    Raises MapError for a singular matrix.
    """
    from pypardiso import PyPardisoSolver
    from pypardiso.pardiso_wrapper import PyPardisoError

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
    from scipy.sparse import block_array

    return csc_array(block_array([[matrix.real, -matrix.imag], [matrix.imag, matrix.real]]))


def _require_diagonal(upper: csr_array[Any]) -> None:
    if not (upper.diagonal() > 0).all():
        raise ValueError("a number on its diagonal is not positive")
