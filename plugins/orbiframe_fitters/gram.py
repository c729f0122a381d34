"""Gram matrices of sparse rows, compiled."""

from __future__ import annotations

from orbiframe.compiled import compiled


@compiled
def add_gram(start, column, value, weight, gram):  # type: ignore[no-untyped-def]
    """Add A^T W A to the upper triangle of a dense matrix, for a sparse matrix A by rows and weights W of its rows."""
    for i in range(len(start) - 1):
        for j in range(start[i], start[i + 1]):
            scaled = weight[i] * value[j]
            for k in range(start[i], start[i + 1]):
                if column[k] >= column[j]:
                    gram[column[j], column[k]] += scaled * value[k]
