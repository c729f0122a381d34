"""Clough-Tocher splines: dimension, smoothness, reproduction, the function 1, eigenvalues and orders."""

from __future__ import annotations

import element_checks
import numpy as np
import pytest
import spline_checks
from orbiframe_bases.clough_tocher import CloughTocher

from orbiframe.splines.element_basis import _fans
from orbiframe.testing import contract_tests

NAMES = list(spline_checks.MAKERS)

test_contract = contract_tests("basis", CloughTocher, params={"size": 120})


def splines(name: str) -> CloughTocher:
    domain = spline_checks.domain(name)
    return CloughTocher(domain.orbifold, domain)


@pytest.mark.parametrize("name", NAMES)
def test_three_unknowns_a_vertex_and_one_an_edge(name: str) -> None:
    basis = splines(name)
    assert basis.size == 3 * basis.domain.vertex_count + basis.domain.edge_count
    assert np.linalg.matrix_rank(basis.matrix.toarray()) == basis.size


@pytest.mark.parametrize("name", NAMES)
def test_first_derivatives_are_continuous_and_second_are_not(name: str) -> None:
    basis = splines(name)
    coefficients = spline_checks.random_coefficients(basis)
    assert max(spline_checks.jumps(basis, coefficients, k) for k in (0, 1)) < 1e-12
    assert spline_checks.jumps(basis, coefficients, 2, "inner") > 0.1
    assert spline_checks.jumps(basis, coefficients, 2, "macro") > 0.1


@pytest.mark.parametrize("name", NAMES)
def test_jumps_show_a_slope_that_one_side_does_not_know_of(name: str) -> None:
    """One coefficient beside an edge is changed: the values stay continuous, the slopes do not."""
    basis = splines(name)
    spoilt = basis.matrix.tolil()
    spoilt[4] *= 1.01
    basis.matrix = spoilt.tocsr()
    coefficients = spline_checks.random_coefficients(basis)
    assert spline_checks.jumps(basis, coefficients, 1) > 1e-6


def test_all_cubics_on_the_sphere_and_on_single_triangles() -> None:
    assert element_checks.residual_on_the_sphere(splines("sphere"), 3) < 1e-12
    for name in ("torus", "Bolza", "Klein bottle"):
        assert element_checks.residual_on_one_triangle(splines(name)) < 1e-12


@pytest.mark.parametrize("name", ["sphere", "Bolza", "three crosscaps"])
def test_the_divisor_has_the_data_of_one(name: str) -> None:
    """It is positive and, on finer triangles, nearer to 1 with order four."""
    coarse = spline_checks.domain(name)
    errors = []
    for domain in (coarse.refined(), coarse.refined().refined()):
        plain = CloughTocher(domain.orbifold, domain)
        weights, plain.weights = plain.weights, None
        assert weights is not None
        assert (plain.net(weights[:, None]) > 0).all()
        values = plain.values(element_checks.spread_points(domain, 10), weights[:, None])
        errors.append(np.abs(values - 1).max())
    assert errors[1] < 1e-2
    assert 3 < np.log2(errors[0] / errors[1]) < 5


def test_first_eigenvalue_of_the_bolza_surface() -> None:
    """Relative error 2.5e-4 with 762 functions, one sixteenth with the next refinement and more."""
    domain = element_checks.bolza(2)
    basis = CloughTocher(domain.orbifold, domain)
    assert basis.size == 762
    assert element_checks.first_eigenvalue(basis) / element_checks.BOLZA - 1 == pytest.approx(2.495e-4, rel=0.01)
    assert element_checks.condition(basis) < 50


@pytest.mark.parametrize("name", ["sphere", "torus", "Bolza"])
def test_order_of_convergence(name: str) -> None:
    domain = spline_checks.domain(name)
    wanted, errors = element_checks.bumps(domain), []
    domain = domain.refined()
    for _ in range(2):
        domain = domain.refined()
        basis = CloughTocher(domain.orbifold, domain)
        errors.append(element_checks.error_of_fit(basis, domain, wanted, 15))
    assert 3.2 < np.log2(errors[0] / errors[1]) < 4.8


@pytest.mark.parametrize("name", NAMES)
def test_its_micro_triangles_are_known_for_a_fan(name: str) -> None:
    """Three numbers a triangle then stand for the split, and points find their micro triangles by them."""
    basis = splines(name)
    fans = _fans(basis.domain, basis.micro_triangles)
    assert fans.shape == (basis.domain.face_count, 3)
    middle = np.einsum("fi,fij->fj", 1 / fans, basis.domain.corners)
    np.testing.assert_allclose(middle, basis.micro_triangles[:, 0, 2], atol=1e-13)
    turned = basis.micro_triangles[:, [1, 2, 0]]
    assert _fans(basis.domain, turned).shape == (basis.domain.face_count, 0)
