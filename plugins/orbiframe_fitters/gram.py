"""Gram: the sums over samples of weight times row times row, several kinds of weights at a time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array

from orbiframe.compiled import compiled
from orbiframe.workers import in_threads, thread_count

Floats = NDArray[np.float64]

_DENSE = 1e8  # numbers of which a dense matrix may have at most so many


class Gram:
    """The matrices A^T W_k A for sparse rows A and k weights of each row, dense up to a size, beyond it sparse.

    most: up to how many numbers they are dense. upper: their upper triangles then, (size, size, kinds), else None.
    """

    def __init__(self, size: int, kinds: int = 1, most: float | None = None) -> None:
        self.size = size
        self.upper = (
            np.zeros((size, size, kinds)) if size * size * kinds <= (_DENSE if most is None else most) else None
        )
        self._sparse = [csr_array((size, size)) for _ in range(0 if self.upper is not None else kinds)]

    def add(self, rows: csr_array, weights: Floats) -> None:
        """Add rows (n, size) with weights (n,) or (n, kinds)."""
        weights = np.ascontiguousarray(weights.reshape(len(weights), -1))
        if self.upper is not None:
            rows.sort_indices()
            self._add_dense(rows, weights, self.upper)
            return
        turned = rows.T.tocsr()
        for kind, weight in enumerate(weights.T):
            self._sparse[kind] = csr_array(self._sparse[kind] + turned @ (diags_array(weight) @ rows))

    @staticmethod
    def _add_dense(rows: csr_array, weights: Floats, dense: Floats) -> None:
        """Each thread has some lines of the matrices, so that every sum has its order, whatever their number is."""
        add, count = _add_six if weights.shape[1] == 6 else _add, thread_count()
        for _ in in_threads(
            lambda part: add(rows.indptr, rows.indices, rows.data, weights, dense, part, count), range(count)
        ):
            pass

    def matrices(self) -> list[Floats] | list[csr_array]:
        """The symmetric matrices, one of each kind."""
        if self.upper is None:
            return self._sparse
        found = [np.empty((self.size, self.size)) for _ in range(self.upper.shape[2])]
        for _ in in_threads(lambda kind: _mirror(self.upper, kind, found[kind]), range(len(found))):
            pass
        return found


@compiled(arrays=False)
def _add(start, column, value, weight, gram, part, parts):  # type: ignore[no-untyped-def]
    """Add the upper triangles of A^T W A to dense matrices, for a sparse matrix A by rows and weights W of its rows.

    Only to lines part, part + parts, part + 2 parts, ...
    """
    kinds = weight.shape[1]
    for i in range(len(start) - 1):
        first = weight[i, 0]
        if kinds == 1 and first == 0:
            continue
        for j in range(start[i], start[i + 1]):
            if column[j] % parts != part:
                continue
            line = gram[column[j]]
            for k in range(j, start[i + 1]):
                product = value[j] * value[k]
                place = line[column[k]]
                if kinds == 1:
                    place[0] += first * product
                else:
                    for kind in range(kinds):
                        place[kind] += weight[i, kind] * product


@compiled(arrays=False)
def _add_six(start, column, value, weight, gram, part, parts):  # type: ignore[no-untyped-def]
    """The same for six weights, which are kept at hand: the hot loop of fits that slide."""
    for i in range(len(start) - 1):
        w0, w1, w2, w3, w4, w5 = weight[i]
        for j in range(start[i], start[i + 1]):
            if column[j] % parts != part:
                continue
            line = gram[column[j]]
            for k in range(j, start[i + 1]):
                product = value[j] * value[k]
                place = line[column[k]]
                place[0] += w0 * product
                place[1] += w1 * product
                place[2] += w2 * product
                place[3] += w3 * product
                place[4] += w4 * product
                place[5] += w5 * product


@compiled(arrays=False)
def _mirror(upper, kind, full):  # type: ignore[no-untyped-def]
    """The symmetric matrix of one kind from its upper triangle."""
    for i in range(len(full)):
        for j in range(i, len(full)):
            full[i, j] = full[j, i] = upper[i, j, kind]
