"""Orders for sparse factors: they are orders, they keep factors sparse, and the solutions are right."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_parametrizers.elimination import Elimination, dissection_order, elimination_order, factorised
from reference_meshes import dataset, grid, icosphere
from scipy.sparse import eye_array

from orbiframe import MapError


def ends(mesh):
    return mesh.tail[mesh.representative], mesh.head[mesh.representative]


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 400), st.integers(0, 1200), st.booleans(), st.integers(0, 2**32 - 1))
def test_orders_are_permutations(count, edges, flat, seed):
    rng = np.random.default_rng(seed)
    positions = rng.integers(4, size=(count, 3)).astype(float) if flat else rng.normal(size=(count, 3))
    tail, head = rng.integers(count, size=(2, edges))
    for order in (dissection_order(positions, tail, head), elimination_order(positions, tail, head)):
        assert np.array_equal(np.sort(order), np.arange(count))


@pytest.mark.parametrize("find", [dissection_order, elimination_order])
def test_factors_of_a_large_grid_stay_sparse(find):
    """A 100 x 100 torus: a band of width 100 would fill 2 million entries; n log2 n is 133 thousand."""
    mesh = grid(100, 100)
    tail, head = ends(mesh)
    order = find(mesh.vertices, tail, head)
    factors = factor(mesh, Elimination(order, np.argsort(order)))
    assert factors.nnz < 8 * 10_000 * np.log2(10_000)
    everyday = factor(mesh, Elimination(np.arange(10_000), np.arange(10_000)))
    assert factors.nnz < everyday.nnz / 3


def test_a_sphere_of_regular_numbering_is_ordered_quickly_and_well():
    mesh = icosphere(40)
    assert factor(mesh, Elimination.of(mesh)).nnz < 8 * len(mesh.vertices) * np.log2(len(mesh.vertices))


def factor(mesh, elimination):
    tail, head = ends(mesh)
    diagonal = 1.0 + np.bincount(mesh.tail, minlength=len(mesh.vertices))
    return factorised(elimination.matrix(tail, head, np.full(len(tail), -1.0), diagonal)).L


@pytest.mark.parametrize("columns", [(), (2,)])
def test_the_solver_solves(columns):
    mesh = dataset("plate_genus2_coarse")
    rng = np.random.default_rng(0)
    tail, head = ends(mesh)
    entries = -rng.uniform(0.1, 1, len(tail))
    dense = np.zeros((len(mesh.vertices),) * 2)
    dense[tail, head] = dense[head, tail] = entries
    diagonal = 0.1 - dense.sum(axis=1)
    right = rng.normal(size=(len(dense), *columns))
    solution = Elimination.of(mesh).solver(tail, head, entries, diagonal)(right)
    assert np.allclose(solution, np.linalg.solve(dense + np.diag(diagonal), right), rtol=0, atol=1e-11)


def test_the_matrix_is_hermitian():
    mesh = grid(5, 6)
    rng = np.random.default_rng(1)
    tail, head = ends(mesh)
    entries = rng.normal(size=len(tail)) + 1j * rng.normal(size=len(tail))
    elimination = Elimination.of(mesh)
    matrix = elimination.matrix(tail, head, entries, np.arange(30.0)).toarray()
    assert np.array_equal(matrix, matrix.conj().T)
    back = matrix[np.ix_(elimination.place, elimination.place)]
    assert np.array_equal(back[tail, head], entries)
    assert np.array_equal(np.diag(back), np.arange(30.0))


def test_a_singular_matrix_is_named():
    with pytest.raises(MapError, match="the equations of the map are singular"):
        factorised((0 * eye_array(4, format="csc")).tocsc())
