"""Equations on a round torus in space: solutions made up in closed form, and the orders that the degrees promise."""

from __future__ import annotations

import numpy as np
import pytest
from round_surfaces import SMALL, forms, torus

from orbiframe.errors import FitError
from orbiframe.surfaces.equations import biharmonic, heat, poisson
from orbiframe.surfaces.gram_schmidt import orthonormal


def angles(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.arctan2(x[:, 1], x[:, 0]), np.arctan2(x[:, 2], np.hypot(x[:, 0], x[:, 1]) - 1)


def solution(x: np.ndarray) -> np.ndarray:
    u, v = angles(x)
    return np.cos(v) + np.sin(2 * u) * np.sin(v)


def source(x: np.ndarray) -> np.ndarray:
    """Minus the Laplacian (1 / (r^2 R)) d/dv (R d/dv) + (1 / R^2) d^2/du^2 of the solution, R = 1 + r cos v."""
    u, v = angles(x)
    ring, slope = 1 + SMALL * np.cos(v), -np.sin(v) + np.sin(2 * u) * np.cos(v)
    bend = -np.cos(v) - np.sin(2 * u) * np.sin(v)
    return -(bend / SMALL**2 - np.sin(v) / (SMALL * ring) * slope - 4 * np.sin(2 * u) * np.sin(v) / ring**2)


def error_of_poisson(basis: str, size: int) -> float:
    """In the mean square, relative."""
    there = forms(basis, size)
    x, weights = torus().evaluate(there.points), there.weights
    wanted = solution(x) - weights @ solution(x) / there.area
    found = there.basis.values(there.points, poisson(there, source(x))[:, None])[:, 0]
    return float(np.sqrt(weights @ (found - wanted) ** 2 / (weights @ wanted**2)))


@pytest.mark.long
def test_poisson_with_the_order_that_the_degree_promises():
    """Quadratics: a third order, an eighth of the error for four times the functions."""
    coarse, fine = (error_of_poisson("ps2", size) for size in (400, 1600))
    assert fine < 1e-3
    assert np.log2(coarse / fine) == pytest.approx(3, abs=0.3)


@pytest.mark.long
def test_poisson_to_five_digits():
    assert error_of_poisson("ps6", 1200) < 1e-4


@pytest.mark.long
def test_the_biharmonic_equation_with_the_order_of_the_degree():
    """Quadratics: a third order."""
    errors = [error_of_biharmonic(size) for size in (400, 1600)]
    assert errors[1] < 1e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(3, abs=0.4)


def error_of_biharmonic(size: int) -> float:
    """The Laplacian of the solution is that of `solution`, so the solution is that of Poisson's equation for it."""
    there, exact = forms("ps2", size), forms("ps6", 1200)
    x, weights = torus().evaluate(there.points), there.weights
    # Two steps of 1200 functions of degree 6, right to five digits, with the first one in closed form.
    fine = torus().evaluate(exact.points)
    wanted = poisson(exact, solution(fine) - exact.weights @ solution(fine) / exact.area)
    values = exact.basis.values(there.points, wanted[:, None])[:, 0]
    found = there.basis.values(there.points, biharmonic(there, source(x))[:, None])[:, 0]
    return float(np.sqrt(weights @ (found - values) ** 2 / (weights @ values**2)))


def test_a_source_without_balance_has_no_solution():
    there = forms("ps2", 400)
    with pytest.raises(FitError, match="subtract its mean, 1"):
        poisson(there, np.ones(len(there.weights)))
    with pytest.raises(FitError, match="finite values"):
        poisson(there, np.ones(3))


def test_heat_keeps_its_amount_and_falls_as_an_eigenfunction_does():
    """The first eigenvalue 1.028956 of this torus, by Fourier series in `test_surface_forms`."""
    import scipy.linalg

    there = forms("ps2", 400)
    values, vectors = scipy.linalg.eigh(there.stiffness.toarray(), there.mass.toarray(), subset_by_index=[0, 1])
    assert values[1] == pytest.approx(1.028956, rel=1e-3)
    start = vectors[:, 1] + 2 * orthonormal(there).project(np.ones(len(there.weights)))
    found = heat(there, start, 0.5)
    np.testing.assert_allclose(there.integrals @ found, there.integrals @ start, rtol=1e-9)
    left = vectors[:, 1] @ (there.mass @ found)
    assert left == pytest.approx(np.exp(-0.5 * values[1]), rel=1e-4)
    with pytest.raises(FitError, match="positive time"):
        heat(there, start, 0.0)
