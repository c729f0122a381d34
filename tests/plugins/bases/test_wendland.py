"""Wendland's functions: their profiles, smoothness and third derivatives."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
import reference_surfaces as surfaces
from orbiframe_bases.wendland import Wendland
from third_derivatives import error_of_third_derivatives

from orbiframe import Points, UsageError
from orbiframe.testing import contract_tests

NAMES = list(surfaces.ALL)

test_two = contract_tests("basis", Wendland, params={"size": 30})
test_six = contract_tests("basis", Wendland, params={"size": 30, "derivatives": 6})


def wendland(name: str, **options: float) -> Wendland:
    triangulation = surfaces.triangulated(name, 3)
    return Wendland(triangulation.orbifold, triangulation, **{"size": 40, **options})


def by_integration(k: int) -> list[mpmath.mpf]:
    """The coefficients in r, from the constant on, of phi_{3,k}, scaled to 1 at r = 0.

    The operator (I f)(r), the integral of s f(s) from r to 1, k times on (1 - r)^(k + 2).
    """
    coefficients = [mpmath.mpf((-1) ** i) * mpmath.binomial(k + 2, i) for i in range(k + 3)]
    for _ in range(k):
        raised = [mpmath.mpf(0)] * 2 + [c / (i + 2) for i, c in enumerate(coefficients)]
        coefficients = [sum(raised) - raised[0], *(-c for c in raised[1:])]
    return [c / coefficients[0] for c in coefficients]


@pytest.mark.parametrize("derivatives", [2, 4, 6])
def test_profile_is_the_one_that_wendlands_operator_makes(derivatives: int) -> None:
    basis = wendland("torus", derivatives=derivatives)
    t = np.array([0.05, 0.3, 0.6, 0.95])
    with mpmath.workdps(40):
        polynomial = by_integration(derivatives // 2)

        def exact(v: mpmath.mpf) -> mpmath.mpf:
            return sum(c * mpmath.sqrt(v) ** i for i, c in enumerate(polynomial))

        expected = [[float(mpmath.diff(exact, v, order)) for v in t] for order in range(4)]
    np.testing.assert_allclose(basis.profile(t), expected, rtol=1e-11)
    assert not np.any(basis.profile(np.array([1.0, 1.5, 1e300])))


@pytest.mark.parametrize("derivatives", [2, 4, 6])
def test_values_at_a_centre_are_finite(derivatives: int) -> None:
    basis = wendland("octagon", derivatives=derivatives)
    jets = basis.jet_matrices(Points(basis.centres.patch[:3], basis.centres.x[:3]), 3)
    assert all(np.isfinite(m.data).all() for m in jets)


@pytest.mark.parametrize("name", NAMES)
def test_third_derivatives_are_differences_of_the_hessian(name: str) -> None:
    basis = wendland(name, derivatives=6)
    points = surfaces.random_points(basis.orbifold, 20, np.random.default_rng(3))
    assert error_of_third_derivatives(basis, points, 1e-3).max() < 1e-4


def test_the_next_derivative_is_not_continuous() -> None:
    """Across the centre of a C2 function its third derivative along a line changes its sign."""
    basis = wendland("torus", size=40, reach=2.0)
    centre = basis.centres.x[:1]
    jets = [
        basis.jet_matrices(Points(np.zeros(1, dtype=int), centre + np.array([0, e, 0])), 3)[6].toarray()[0, 0]
        for e in (1e-7, -1e-7)
    ]
    assert jets[0] - jets[1] > 0.5 * abs(jets[0])


@pytest.mark.parametrize("option", ["size", "reach", "derivatives"])
def test_options_out_of_range(option: str) -> None:
    with pytest.raises(UsageError, match=option):
        wendland("torus", **{option: 0})
