"""Argyris and Zenisek elements: dimension, smoothness, reproduction, constants, eigenvalues and orders."""

from __future__ import annotations

from math import comb

import element_checks
import numpy as np
import pytest
import spline_checks
from orbiframe_bases.argyris import Argyris, Zenisek

from orbiframe import UsageError
from orbiframe.splines import ElementBasis
from orbiframe.testing import contract_tests

NAMES = list(spline_checks.MAKERS)
FAMILIES = [(Argyris, 5), (Argyris, 6), (Argyris, 8), (Zenisek, 9), (Zenisek, 10)]

test_argyris = contract_tests("basis", Argyris, params={"size": 150})
test_argyris_5 = contract_tests("basis", Argyris, params={"size": 150, "degree": 5})
test_zenisek = contract_tests("basis", Zenisek, params={"size": 200})


def splines(name: str, family: type[Argyris | Zenisek], degree: int) -> ElementBasis:
    domain = spline_checks.domain(name)
    return family(domain.orbifold, domain, degree=degree)


@pytest.mark.parametrize(("family", "degree"), FAMILIES)
@pytest.mark.parametrize("name", NAMES)
def test_dimension_and_smoothness(name: str, family: type[Argyris | Zenisek], degree: int) -> None:
    """Derivatives up to the claimed order are continuous for random coefficients, the next one is not."""
    basis = splines(name, family, degree)
    v, e, f = basis.domain.vertex_count, basis.domain.edge_count, basis.domain.face_count
    if family is Argyris:
        assert basis.size == 6 * v + (2 * degree - 9) * e + comb(degree - 4, 2) * f
    else:
        assert basis.size == 15 * v + (3 * degree - 24) * e + comb(degree - 7, 2) * f
    coefficients = spline_checks.random_coefficients(basis)
    smooth = int(basis.smoothness)
    assert smooth == (1 if family is Argyris else 2)
    assert max(spline_checks.jumps(basis, coefficients, k) for k in range(smooth + 1)) < 1e-11
    assert spline_checks.jumps(basis, coefficients, smooth + 1) > 0.1


@pytest.mark.parametrize(("family", "degree"), [(Argyris, 5), (Zenisek, 9)])
@pytest.mark.parametrize("name", ["one-vertex torus", "Klein bottle", "Bolza"])
def test_the_functions_are_independent(name: str, family: type[Argyris | Zenisek], degree: int) -> None:
    matrix = splines(name, family, degree).matrix.toarray()
    assert np.linalg.matrix_rank(matrix / np.linalg.norm(matrix, axis=0)) == matrix.shape[1]


@pytest.mark.parametrize(("family", "degree"), [(Argyris, 5), (Argyris, 6), (Zenisek, 9)])
def test_all_polynomials_on_the_sphere_and_on_single_triangles(family: type[Argyris | Zenisek], degree: int) -> None:
    assert element_checks.residual_on_the_sphere(splines("sphere", family, degree), degree) < 1e-10
    for name in ("torus", "Bolza", "Klein bottle"):
        assert element_checks.residual_on_one_triangle(splines(name, family, degree)) < 1e-10


@pytest.mark.parametrize("name", NAMES)
def test_only_odd_degrees_need_a_divisor(name: str) -> None:
    assert splines(name, Argyris, 6).weights is None
    curved = spline_checks.domain(name).geometry.curvature != 0
    assert (splines(name, Argyris, 5).weights is not None) == curved


def test_jumps_show_a_derivative_that_one_side_does_not_know_of() -> None:
    basis = splines("Bolza", Zenisek, 9)
    second = np.flatnonzero(np.diff(basis.matrix.indptr) > 20)[0]
    basis.matrix.data[basis.matrix.indptr[second] : basis.matrix.indptr[second + 1]] *= 1 + 1e-3
    coefficients = spline_checks.random_coefficients(basis)
    assert max(spline_checks.jumps(basis, coefficients, k) for k in range(3)) > 1e-8


@pytest.mark.parametrize(
    ("family", "degree", "refinements", "size", "error", "condition"),
    [
        (Argyris, 5, 1, 276, 6.17e-5, 4e2),
        (Argyris, 6, 1, 532, 3.5e-5, 1.5e3),
        (Argyris, 8, 1, 1236, 2.8e-7, 6e4),
        (Zenisek, 9, 1, 802, 2.2e-8, 3e5),
    ],
)
def test_first_eigenvalue_of_the_bolza_surface(
    family: type[Argyris | Zenisek], degree: int, refinements: int, size: int, error: float, condition: float
) -> None:
    """Relative errors, and conditions of the mass matrices with ones on the diagonal."""
    domain = element_checks.bolza(refinements)
    basis = family(domain.orbifold, domain, degree=degree)
    assert basis.size == size
    found = element_checks.first_eigenvalue(basis) / element_checks.BOLZA - 1
    assert found == pytest.approx(error, rel=0.03)
    assert element_checks.condition(basis) < condition


@pytest.mark.parametrize(("family", "degree", "least"), [(Argyris, 5, 5.2), (Zenisek, 9, 7.5)])
@pytest.mark.parametrize("name", ["torus", "Bolza"])
def test_order_of_convergence(name: str, family: type[Argyris | Zenisek], degree: int, least: float) -> None:
    domain = spline_checks.domain(name)
    wanted, errors = element_checks.bumps(domain), []
    domain = domain if degree == 9 else domain.refined()
    for _ in range(2):
        basis = family(domain.orbifold, domain, degree=degree)
        errors.append(element_checks.error_of_fit(basis, domain, wanted, 90 if degree == 9 else 40))
        domain = domain.refined()
    assert np.log2(errors[0] / errors[1]) > least


@pytest.mark.parametrize(("family", "degree"), [(Argyris, 4), (Zenisek, 8)])
def test_degrees_that_are_too_low(family: type[Argyris | Zenisek], degree: int) -> None:
    with pytest.raises(UsageError, match=f"{degree}; it must be at least {degree + 1}"):
        splines("torus", family, degree)
