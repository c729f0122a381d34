"""Complete quintic splines, against polynomials and against the order of their error."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from orbiframe_exact.complete_spline import abscissae, bisected, data, evaluate, holding, operator, sharing

UNEVEN = np.array([0, 0.125, 0.25, 0.5, 1])


@pytest.mark.parametrize("breaks", [np.array([0, 0.5, 1]), UNEVEN, np.linspace(0, 1, 9)])
def test_polynomials_of_degree_5_are_found_exactly(breaks):
    polynomial = np.polynomial.Polynomial([1, -2, 0.5, 3, -1, 2])
    at = abscissae(breaks)
    values, slopes = polynomial(at)[:, None], polynomial.deriv()(at)[:, None]
    a = operator(breaks)
    assert a.shape == (len(breaks) + 4, len(breaks) + 4)
    poles = np.linalg.solve(a, data(values, slopes))
    u = np.linspace(0, 1, 101)
    for order in range(4):
        assert np.abs(evaluate(breaks, poles, u, order)[:, 0] - polynomial.deriv(order)(u)).max() < 1e-10


def test_the_error_is_of_order_6():
    errors, u = [], np.linspace(0, 1, 1001)
    for count in (16, 32):
        breaks = np.linspace(0, 1, count + 1)
        at = abscissae(breaks)
        poles = np.linalg.solve(operator(breaks), data(np.sin(9 * at)[:, None], 9 * np.cos(9 * at)[:, None]))
        errors.append(np.abs(evaluate(breaks, poles, u)[:, 0] - np.sin(9 * u)).max())
    assert np.log2(errors[0] / errors[1]) > 5.5


@given(st.lists(st.integers(0, 30), min_size=1, max_size=12))
def test_neighbours_differ_by_a_factor_of_two_at_most(places):
    breaks = np.linspace(0, 1, 5)
    for place in places:
        wanted = np.zeros(len(breaks) - 1, dtype=bool)
        wanted[place % len(wanted)] = True
        finer = bisected(breaks, wanted)
        assert set(breaks) < set(finer)
        ratio = np.diff(finer)[1:] / np.diff(finer)[:-1]
        assert ratio.max() <= 2.01
        assert ratio.min() >= 1 / 2.01
        breaks = finer


def test_intervals_that_hold_parameters():
    assert holding(UNEVEN, np.array([0.0, 0.2, 1.0])).tolist() == [True, True, False, True]


def test_no_interval_holds_more_than_its_share_and_neighbours_differ_by_two_at_most():
    """Half of the weight within a millionth of the interval, and the rest all over."""
    rng = np.random.default_rng(2)
    at = np.concatenate([0.3 + 1e-6 * rng.random(500), rng.random(500)])
    weight = rng.random(1000)
    breaks = sharing(at, weight, 0.2, 40)
    held = np.histogram(at, breaks, weights=weight)[0]
    assert held.max() <= 0.2 * weight.sum()
    ratio = np.diff(breaks)[1:] / np.diff(breaks)[:-1]
    assert ratio.max() < 2.02
    assert ratio.min() > 0.49
    assert len(breaks) < 100
    assert len(sharing(np.full(5, 0.3), np.ones(5), 0.2, 7)) <= 2 * 7 + 10
