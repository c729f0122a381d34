"""Gram: the sums over samples of weight times row times row, several kinds of weights at a time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array

from orbiframe.compiled import compiled

Floats = NDArray[np.float64]

_DENSE = 1e8  # numbers of which a dense matrix may have at most so many


class Gram:
    """The matrices A^T W_k A for sparse rows A and k weights of each row, dense up to a size, beyond it sparse.

    most: up to how many numbers they are dense.
    """

    def __init__(self, size: int, kinds: int = 1, most: float | None = None) -> None:
        self.size = size
        self._dense = (
            np.zeros((size, size, kinds)) if size * size * kinds <= (_DENSE if most is None else most) else None
        )
        self._sparse = [csr_array((size, size)) for _ in range(0 if self._dense is not None else kinds)]

    def add(self, rows: csr_array, weights: Floats) -> None:
        """Add rows (n, size) with weights (n,) or (n, kinds)."""
        weights = np.ascontiguousarray(weights.reshape(len(weights), -1))
        if self._dense is not None:
            rows.sort_indices()
            _add(rows.indptr, rows.indices, rows.data, weights, self._dense)
            return
        turned = rows.T.tocsr()
        for kind, weight in enumerate(weights.T):
            self._sparse[kind] = csr_array(self._sparse[kind] + turned @ (diags_array(weight) @ rows))

    def matrices(self) -> list[Floats] | list[csr_array]:
        """The symmetric matrices, one of each kind."""
        if self._dense is None:
            return self._sparse
        upper = [np.triu(matrix) for matrix in np.moveaxis(self._dense, 2, 0)]
        return [matrix + np.triu(matrix, 1).T for matrix in upper]


@compiled
def _add(start, column, value, weight, gram):  # type: ignore[no-untyped-def]
    """Add the upper triangles of A^T W A to dense matrices, for a sparse matrix A by rows and weights W of its rows."""
    kinds = weight.shape[1]
    for i in range(len(start) - 1):
        first = weight[i, 0]
        if kinds == 1 and first == 0:
            continue
        for j in range(start[i], start[i + 1]):
            line = gram[column[j]]
            for k in range(j, start[i + 1]):
                product = value[j] * value[k]
                place = line[column[k]]
                if kinds == 1:
                    place[0] += first * product
                else:
                    for kind in range(kinds):
                        place[kind] += weight[i, kind] * product
