"""Coupled equations: packed, sparse and dense ones are the same, and the solution is that of the whole."""

from __future__ import annotations

import numpy as np
import pytest
from orbiframe_fitters import coupled as module
from orbiframe_fitters.coupled import KIND, PackedBlocks, SparseBlocks, nearly_solved
from scipy.sparse import csr_array, random_array

from orbiframe import FitError

SIZE = 40


def system(seed: int = 0):
    """Six kinds of sums over samples, as a Gram matrix has them, with something stiff, and the whole matrix."""
    rng = np.random.default_rng(seed)
    rows = random_array((300, SIZE), density=0.1, rng=rng).toarray() + 0.0
    normals = rng.standard_normal((300, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    form = np.einsum("na,nb->nab", normals, normals) + 0.1 * np.eye(3)
    full = np.einsum("ni,nj,nab->ijab", rows, rows, form)
    stiff = np.diag(np.full(SIZE, 0.01)) - np.diag(np.full(SIZE - 1, 0.003), 1) - np.diag(np.full(SIZE - 1, 0.003), -1)
    kinds = np.stack([full[:, :, a, b] for a in range(3) for b in range(a, 3)], axis=2)
    upper = np.where(np.triu(np.ones((SIZE, SIZE), dtype=bool))[:, :, None], kinds, 0)
    whole = (full + stiff[:, :, None, None] * np.eye(3)).transpose(0, 2, 1, 3).reshape(3 * SIZE, 3 * SIZE)
    return upper, stiff, whole


def packed_and_sparse():
    upper, stiff, whole = system()
    sums = [upper[:, :, k] + np.triu(upper[:, :, k], 1).T for k in range(6)]
    sums = [csr_array(part + stiff if k in (0, 3, 5) else part) for k, part in enumerate(sums)]
    return [PackedBlocks.of(upper, stiff), SparseBlocks(sums)], whole


def test_both_ways_are_the_matrix():
    matrices, whole = packed_and_sparse()
    x = np.random.default_rng(1).standard_normal((SIZE, 3))
    blocks = whole.reshape(SIZE, 3, SIZE, 3)
    for matrix in matrices:
        np.testing.assert_allclose(matrix.image(x).ravel(), whole @ x.ravel(), rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(matrix.diagonal().ravel(), whole.diagonal(), rtol=1e-13)
        for a in range(3):
            block = matrix.block(a)
            dense = block if isinstance(block, np.ndarray) else block.toarray()
            np.testing.assert_allclose(dense, blocks[:, a, :, a], atol=1e-13)
    assert KIND[1] == (1, 3, 4)


def test_the_solution_is_that_of_the_whole():
    matrices, whole = packed_and_sparse()
    right = np.random.default_rng(2).standard_normal((SIZE, 3))
    wanted = np.linalg.solve(whole, right.ravel()).reshape(SIZE, 3)
    for matrix in matrices:
        found = nearly_solved(matrix, right)
        assert np.linalg.norm(found - wanted) < 1e-2 * np.linalg.norm(wanted)


def test_more_steps_make_the_solution_exact(monkeypatch):
    matrices, whole = packed_and_sparse()
    right = np.random.default_rng(3).standard_normal((SIZE, 3))
    monkeypatch.setattr(module, "_NEARLY", 1e-12)
    for matrix in matrices:
        found = nearly_solved(matrix, right)
        np.testing.assert_allclose(whole @ found.ravel(), right.ravel(), atol=1e-9)


def test_entries_that_are_zero_are_not_kept():
    upper, stiff, whole = system()
    matrix = PackedBlocks.of(upper, stiff)
    there = (np.abs(whole.reshape(SIZE, 3, SIZE, 3)) > 0).any(axis=(1, 3))
    assert len(matrix.column) == np.triu(there | np.eye(SIZE, dtype=bool)).sum() < SIZE * (SIZE + 1) / 2


def test_a_function_that_nothing_sees_is_an_error():
    upper, stiff, _ = system()
    upper[3], upper[:, 3], stiff[3], stiff[:, 3] = 0, 0, 0, 0
    with pytest.raises(FitError, match="function 3"):
        nearly_solved(PackedBlocks.of(upper, stiff), np.ones((SIZE, 3)))
