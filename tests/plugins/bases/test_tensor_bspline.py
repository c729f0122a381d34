"""Tensor products of periodic B-splines: knots, invariance, rank, derivatives, convergence."""

from __future__ import annotations

import numpy as np
import pytest
import reference_surfaces as surfaces
from hypothesis import given, settings, strategies as st
from orbiframe_bases.periodic_bsplines import PeriodicBSplines
from orbiframe_bases.tensor_bspline import TensorBSpline
from orbiframe_geometries.e2 import E2
from scipy.interpolate import BSpline

from orbiframe import GeometryError, Orbifold, Points, UsageError
from orbiframe.testing import contract_tests
from orbiframe.triangulations import GeodesicTriangulation

FLAT = ["torus", "klein_bottle"]


test_laws = contract_tests("basis", TensorBSpline, params={"size": 60, "degree": 3})
test_laws_of_quintics = contract_tests("basis", TensorBSpline, params={"size": 40, "degree": 5})


def tensor(name: str, **options: object) -> TensorBSpline:
    triangulation = surfaces.triangulated(name, 1)
    return TensorBSpline(triangulation.orbifold, triangulation, **{"size": 40, **options})


@settings(max_examples=20, deadline=None)
@given(st.lists(st.floats(0, 0.97), min_size=1, max_size=9), st.integers(1, 5), st.integers(0, 3))
def test_b_splines_are_those_of_scipy(knots: list[float], degree: int, order: int) -> None:
    """Sums over the period of the B-splines of scipy, with knots of any distance and derivatives up to order 3."""
    rounded = np.unique(np.round(knots, 2))
    splines = PeriodicBSplines(rounded, degree, 1.0)
    x = np.random.default_rng(0).uniform(-2, 3, 20)
    column, values = splines.values(x, order)
    for j in range(splines.size):
        found = np.where(column == j, values[order], 0).sum(axis=1)
        expected = np.zeros(20)
        for copy in range(-3 - degree, 4):
            place = np.arange(j, j + degree + 2)
            t = rounded[place % splines.size] + place // splines.size + copy
            function = BSpline.basis_element(t, extrapolate=False)
            here = function(x) if order == 0 else (function.derivative(order)(x) if order <= degree else 0 * x)
            expected += np.nan_to_num(here)
        np.testing.assert_allclose(found, expected, atol=1e-9 * max(np.abs(expected).max(), 1))


@pytest.mark.parametrize("degree", [1, 2, 3, 4])
@pytest.mark.parametrize("name", FLAT)
def test_functions_are_a_basis_with_sum_one(name: str, degree: int) -> None:
    """n1 n2 functions, linearly independent, not negative."""
    basis = tensor(name, degree=degree, counts=(5, 8))
    assert basis.size == 40
    points = surfaces.random_points(basis.orbifold, 400, np.random.default_rng(0))
    matrix = basis.design_matrix(points).toarray()
    assert matrix.min() >= 0
    np.testing.assert_allclose(matrix.sum(axis=1), 1, atol=1e-14)
    singular = np.linalg.svd(matrix, compute_uv=False)
    assert singular[-1] > 1e-5 * singular[0]
    assert (matrix > 0).sum(axis=1).max() == min(degree + 1, 5 * (1 + basis.lattice.glide)) * (degree + 1)


@pytest.mark.parametrize("name", FLAT)
def test_knots_may_be_given_and_a_double_knot_costs_a_derivative(name: str) -> None:
    u, v = [0.0, 0.1, 0.1, 0.45, 0.8], [0.0, 0.0, 0.2, 0.5, 0.8]
    basis = tensor(name, degree=3, knots_u=u, knots_v=v)
    assert (basis.size, basis.smoothness) == (25, 1)
    assert tensor(name, degree=3).smoothness == 2
    points = surfaces.random_points(basis.orbifold, 300, np.random.default_rng(0))
    matrix = basis.design_matrix(points).toarray()
    np.testing.assert_allclose(matrix.sum(axis=1), 1, atol=1e-14)
    assert np.linalg.matrix_rank(matrix) == 25
    assert [_jump_at_u(basis, 0.1, order) > 1e-3 for order in range(4)] == [False, False, True, True]
    assert [_jump_at_u(basis, 0.45, order) > 1e-3 for order in range(4)] == [False, False, False, True]


def _jump_at_u(basis: TensorBSpline, u: float, order: int) -> float:
    """How a derivative along u of random functions changes within 1e-9 of a knot, relative to its size."""
    rows = [0, 1, 3, 6]
    sides = [basis.lattice.basis @ [u + side * 1e-9, 0.3] - basis.lattice.shift[0] for side in (-1, 1)]
    x = np.array([[1.0, *(np.linalg.inv(basis.lattice.linear[0]) @ side)] for side in sides])
    jet = basis.jet_matrices(Points(np.zeros(2, dtype=np.intp), x), 3)[rows[order]].toarray()
    direction = basis.lattice.directions(np.zeros(1, dtype=np.intp))[0]
    assert abs(direction[0, 0]) > 0.5
    return float(np.abs(jet[0] - jet[1]).max() / np.abs(jet).max())


@pytest.mark.parametrize("name", FLAT)
def test_generators_leave_the_functions_as_they_are(name: str) -> None:
    basis = tensor(name, degree=3, counts=(4, 6), knots_v=[0.0, 0.1, 0.35, 0.65, 0.9])
    atlas = basis.orbifold.atlas
    points = surfaces.random_points(basis.orbifold, 50, np.random.default_rng(0))
    here = basis.design_matrix(points).toarray()
    for g in atlas.isometry[1:]:
        there = basis.design_matrix(Points(points.patch, points.x @ g.T)).toarray()
        np.testing.assert_allclose(there, here, atol=1e-13)


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_a_skew_torus_converges_with_the_order_degree_plus_one(degree: int) -> None:
    geometry = E2()
    steps = [geometry.translation(1.0, 0.0), geometry.translation(0.9, 1.0)]
    orbifold = Orbifold(surfaces.one_patch(geometry, steps, 1.0), 0, True, 0.9 * np.sin(1.0))
    lattice = np.array([[1.0, 0.9 * np.cos(1.0)], [0.0, 0.9 * np.sin(1.0)]])

    def wave(x: np.ndarray) -> np.ndarray:
        u, v = 2 * np.pi * np.linalg.solve(lattice, x[:, 1:].T)
        return np.exp(np.sin(u) * np.cos(v + 1))

    points = surfaces.random_points(orbifold, 4000, np.random.default_rng(0))
    errors = []
    for count in (8, 16):
        triangulation = surfaces.triangulated("torus", 1)
        basis = TensorBSpline(orbifold, triangulation, degree=degree, counts=(count, count))
        matrix = basis.design_matrix(points)
        normal = (matrix.T @ matrix).toarray()
        solution = np.linalg.lstsq(normal, matrix.T @ wave(points.x), rcond=1e-13)[0]
        errors.append(np.sqrt(np.mean((matrix @ solution - wave(points.x)) ** 2)))
    assert np.log2(errors[0] / errors[1]) > degree + 0.5


def test_third_derivatives_are_those_of_a_product_of_waves() -> None:
    """Interpolated by quintics; derivatives along the frame of a turned patch against closed forms."""
    triangulation = surfaces.in_two_frames(surfaces.triangulated("torus", 1))
    basis = TensorBSpline(triangulation.orbifold, triangulation, degree=7, counts=(24, 24))
    points = surfaces.random_points(basis.orbifold, 3000, np.random.default_rng(0))
    lattice = basis.lattice
    phase = 2 * np.pi * lattice.coordinates(points) @ [1, 2]
    slope = 2 * np.pi * np.einsum("nij,i->nj", lattice.directions(points.patch), [1, 2])
    jets = basis.jet_matrices(points, 3)
    coefficients = np.linalg.lstsq(jets[0].toarray(), np.sin(phase), rcond=None)[0]
    a, b = slope.T
    expected = {
        1: np.cos(phase) * a,
        4: -np.sin(phase) * a * b,
        7: -np.cos(phase) * a * a * b,
        11: -np.cos(phase) * b**3,
    }
    for row, value in expected.items():
        np.testing.assert_allclose(jets[row] @ coefficients, value, atol=2e-4 * np.abs(value).max())


def test_functions_are_shared_out_by_lengths_in_space() -> None:
    """A map stretched in space along one direction gets more functions there."""
    triangulation = surfaces.triangulated("torus", 3)
    mesh, x = triangulation.polyhedron, triangulation.points
    angle = 2 * np.pi * x[:, 1:]
    about = 4 * np.stack([np.cos(angle[:, 0]), np.sin(angle[:, 0])], axis=1)
    ring = np.concatenate([about * (1 + np.cos(angle[:, 1:]) / 4), np.sin(angle[:, 1:])], axis=1)
    stretched = type(triangulation)(
        triangulation.orbifold, mesh.with_vertices(ring), triangulation.patch, x, triangulation.transition
    )
    basis = TensorBSpline(stretched.orbifold, stretched, size=400)
    long = int(np.abs(basis.lattice.basis[0]).argmax())
    assert basis.counts[long] / basis.counts[1 - long] == pytest.approx(4, rel=0.2)
    assert basis.size == pytest.approx(400, rel=0.1)
    domain = GeodesicTriangulation.of_map(stretched)
    assert TensorBSpline(domain.orbifold, domain, size=400).counts == (20, 20)


def test_errors_say_what_to_do() -> None:
    with pytest.raises(GeometryError, match=r"ps2.*ps6"):
        tensor("octagon")
    with pytest.raises(UsageError, match="rise"):
        tensor("torus", knots_u=[0.3, 0.1])
    with pytest.raises(UsageError, match="2 times"):
        tensor("torus", degree=1, knots_v=[0.3, 0.3])
    with pytest.raises(UsageError, match="symmetric"):
        tensor("klein_bottle", knots_v=[0.0, 0.3])
    with pytest.raises(UsageError, match="at least 1"):
        tensor("torus", degree=0)
    with pytest.raises(UsageError, match="counts"):
        tensor("torus", counts=(0, 4))
