"""METIS and SuperLU: a solver of sparse Hermitian positive definite equations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, diags_array

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
