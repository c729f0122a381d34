"""Orders for sparse factors: they are orders, they keep factors sparse, and the solutions are right."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_parametrizers import elimination as module
from orbiframe_parametrizers.elimination import Elimination, Successive, elimination_order, factorised
from reference_meshes import dataset, grid, icosphere
from scipy.sparse import eye_array

from orbiframe import MapError


def ends(mesh):
    return mesh.tail[mesh.representative], mesh.head[mesh.representative]


@pytest.fixture(params=["with METIS", "without METIS"])
def order_of(request, monkeypatch):
    """The order of a mesh, also where METIS is not installed."""
    if request.param == "with METIS":
        pytest.importorskip("pymetis")
    else:
        monkeypatch.setitem(sys.modules, "pymetis", None)
    return lambda mesh: elimination_order(len(mesh.vertices), *ends(mesh))


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 400), st.integers(0, 1200), st.integers(0, 2**32 - 1), st.booleans())
def test_orders_are_permutations(count, edges, seed, metis):
    """Whatever the edges: none, several between two vertices, and from a vertex to itself."""
    tail, head = np.random.default_rng(seed).integers(count, size=(2, edges))
    with pytest.MonkeyPatch.context() as patch:
        if not metis:
            patch.setitem(sys.modules, "pymetis", None)
        assert np.array_equal(np.sort(elimination_order(count, tail, head)), np.arange(count))


def test_factors_of_a_large_grid_stay_sparse(order_of):
    """A 100 x 100 torus: a band of width 100 would fill 2 million entries; n log2 n is 133 thousand."""
    mesh = grid(100, 100)
    order = order_of(mesh)
    factors = factor(mesh, Elimination(order, np.argsort(order)))
    assert factors.nnz < 4 * 10_000 * np.log2(10_000)
    everyday = factor(mesh, Elimination(np.arange(10_000), np.arange(10_000)))
    assert factors.nnz < everyday.nnz / 3


def test_a_sphere_of_regular_numbering_is_ordered_quickly_and_well(order_of):
    mesh = icosphere(40)
    order = order_of(mesh)
    bound = 4 * len(mesh.vertices) * np.log2(len(mesh.vertices))
    assert factor(mesh, Elimination(order, np.argsort(order))).nnz < bound


def test_the_order_of_a_mesh_is_found_once():
    mesh = grid(5, 6)
    assert Elimination.of(mesh) is Elimination.of(mesh)
    assert Elimination.of(mesh) is Elimination.of(grid(5, 6)), "the same faces"
    assert Elimination.of(mesh) is not Elimination.of(grid(6, 5))


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


def definite(mesh, rng):
    """Entries (E,) and diagonal (V,) of a positive definite matrix on the edges."""
    tail, head = ends(mesh)
    entries = -rng.uniform(0.1, 1, len(tail))
    sums = np.bincount(np.append(tail, head), weights=np.append(entries, entries), minlength=len(mesh.vertices))
    return entries, 0.1 - sums


def test_successive_solutions_are_right_and_use_one_factorisation(monkeypatch):
    mesh, rng = grid(30, 30), np.random.default_rng(3)
    calls = []
    monkeypatch.setattr(module, "factorised", lambda matrix: calls.append(matrix) or factorised(matrix))
    systems, (entries, diagonal) = Successive(), definite(mesh, rng)
    for _ in range(3):
        right = rng.normal(size=len(diagonal))
        matrix = Elimination(np.arange(900), np.arange(900)).matrix(*ends(mesh), entries, diagonal)
        found = systems.solution(mesh, ends(mesh), entries, diagonal, right)
        assert np.linalg.norm(matrix @ found - right) < 1e-4 * np.linalg.norm(right)
        entries, diagonal = entries * 1.2, diagonal * rng.uniform(1.2, 1.5, len(diagonal))
    assert len(calls) == 1


def test_a_matrix_far_from_the_last_one_is_factored(monkeypatch):
    mesh, rng = grid(30, 30), np.random.default_rng(4)
    calls = []
    monkeypatch.setattr(module, "factorised", lambda matrix: calls.append(matrix) or factorised(matrix))
    systems, (entries, diagonal) = Successive(), definite(mesh, rng)
    systems.solution(mesh, ends(mesh), entries, diagonal, diagonal)
    scale = 10.0 ** rng.uniform(-4, 4, len(entries))
    sums = np.bincount(np.append(*ends(mesh)), weights=np.tile(entries * scale, 2), minlength=900)
    far = entries * scale, 1e-6 - sums
    right = rng.normal(size=900)
    found = systems.solution(mesh, ends(mesh), *far, right)
    matrix = Elimination(np.arange(900), np.arange(900)).matrix(*ends(mesh), *far)
    assert len(calls) == 2
    assert np.linalg.norm(matrix @ found - right) < 1e-6 * np.linalg.norm(right)


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
