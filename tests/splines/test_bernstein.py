"""Bernstein polynomials, blossoms and changes of triangle, against sums over permutations and exact fractions."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from math import factorial

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from orbiframe.splines.bernstein import (
    bernstein_gradients,
    bernstein_hessians,
    bernstein_values,
    blossom,
    coefficient_count,
    degree_of,
    exponent_number,
    exponents,
    multinomials,
    polar,
    symmetric_power,
)

DEGREES = range(8)


@pytest.mark.parametrize("degree", DEGREES)
def test_exponents_stand_where_their_numbers_say(degree: int) -> None:
    found = exponents(degree)
    assert len(found) == coefficient_count(degree) == len({tuple(a) for a in found})
    assert (found.sum(axis=1) == degree).all()
    assert [exponent_number(a[1], a[2]) for a in found] == list(range(len(found)))
    assert degree_of(len(found)) == degree


def exact(degree: int, point: tuple[int, int, int], derivative: tuple[int, ...] = ()) -> list[Fraction]:
    """Bernstein polynomials or derivatives at a point with whole coordinates, from the formula."""
    values = []
    for a in exponents(degree):
        powers, factor = list(a), Fraction(factorial(degree))
        for i in a:
            factor /= factorial(int(i))
        for i in derivative:
            factor *= int(powers[i])
            powers[i] -= 1
        zero = factor == 0
        values.append(
            Fraction(0)
            if zero
            else factor * Fraction(np.prod([int(x) ** int(p) for x, p in zip(point, powers, strict=True)]).item())
        )
    return values


@pytest.mark.parametrize("degree", DEGREES)
def test_values_and_derivatives_are_those_of_the_formula(degree: int) -> None:
    point = (2, -3, 5)
    np.testing.assert_allclose(bernstein_values(degree, np.array(point)), [float(x) for x in exact(degree, point)])
    slopes, bends = bernstein_gradients(degree, np.array(point)), bernstein_hessians(degree, np.array(point))
    for i in range(3):
        np.testing.assert_allclose(slopes[i], [float(x) for x in exact(degree, point, (i,))])
        for j in range(3):
            np.testing.assert_allclose(bends[i, j], [float(x) for x in exact(degree, point, (i, j))])


@pytest.mark.parametrize("degree", DEGREES)
def test_they_add_up_to_the_power_of_the_sum(degree: int) -> None:
    assert multinomials(degree).sum() == pytest.approx(3.0**degree)
    assert bernstein_values(degree, np.array([0.2, 0.5, -1.3])).sum() == pytest.approx((-0.6) ** degree)


@settings(max_examples=20, deadline=None)
@given(st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_blossoms_by_polarization(degree: int, seed: int) -> None:
    """B(u_1, ..., u_d) = 1/d! sum over sets S of (-1)^(d - |S|) F(sum of u_i over S)."""
    rng = np.random.default_rng(seed)
    form, arguments = rng.normal(size=(coefficient_count(degree), 2)), list(rng.normal(size=(degree, 3)))
    total = np.zeros(2)
    for size in range(1, degree + 1):
        for chosen in combinations(range(degree), size):
            at = sum(arguments[i] for i in chosen)
            total += (-1) ** (degree - size) * bernstein_values(degree, at) @ form
    np.testing.assert_allclose(blossom(form, arguments), total / factorial(degree), atol=1e-11)


def test_coefficients_are_blossoms_at_the_corners() -> None:
    degree = 4
    form = np.random.default_rng(0).normal(size=(coefficient_count(degree), 1))
    for n, a in enumerate(exponents(degree)):
        corners = list(np.repeat(np.eye(3), a, axis=0))
        assert blossom(form, corners)[0] == form[n, 0]


def test_polar_takes_one_argument() -> None:
    rng = np.random.default_rng(1)
    form, u, x = rng.normal(size=(coefficient_count(5), 3)), rng.normal(size=3), rng.normal(size=3)
    left = bernstein_values(4, x) @ polar(form, u)
    slope = np.einsum("i,ia,aq->q", u, bernstein_gradients(5, x), form) / 5
    np.testing.assert_allclose(left, slope)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 6), st.integers(0, 2**32 - 1))
def test_a_polynomial_is_the_same_on_another_triangle(degree: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    form, matrix, x = rng.normal(size=coefficient_count(degree)), rng.normal(size=(4, 3, 3)), rng.normal(size=3)
    changed = symmetric_power(matrix, degree) @ form
    here = np.array([bernstein_values(degree, m @ x) @ form for m in matrix])
    np.testing.assert_allclose(changed @ bernstein_values(degree, x), here, atol=1e-10 * (1 + np.abs(here).max()))


def test_powers_of_products_are_products_of_powers() -> None:
    one, two = np.random.default_rng(2).normal(size=(2, 3, 3))
    together = symmetric_power(one @ two, 3)
    np.testing.assert_allclose(together, symmetric_power(two, 3) @ symmetric_power(one, 3))
