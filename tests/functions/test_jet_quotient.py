"""Jets of quotients against derivatives of the quotient by mpmath."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from orbiframe.functions.jet_quotient import divide_jets

# The entries of a jet by how often they are differentiated along the two directions.
KINDS = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (2, 1), (1, 2), (0, 3)]
POINTS = [(0.3, -0.2), (1.1, 0.7)]


def first(s: mpmath.mpf, t: mpmath.mpf) -> mpmath.mpf:
    return mpmath.sin(s + 2 * t) * s


def second(s: mpmath.mpf, t: mpmath.mpf) -> mpmath.mpf:
    return mpmath.exp(s * t) - t


def below(s: mpmath.mpf, t: mpmath.mpf) -> mpmath.mpf:
    return 2 + mpmath.cos(s - t) * t


def jet(f, point: tuple[float, float], count: int) -> list[float]:
    with mpmath.workdps(40):
        return [float(f(*point) if kind == (0, 0) else mpmath.diff(f, point, kind)) for kind in KINDS[:count]]


@pytest.mark.parametrize("count", [1, 3, 6, 12])
def test_quotients_of_functions_of_two_variables(count: int) -> None:
    """Two functions at the first point, one at the second."""
    tops = [(first, POINTS[0]), (second, POINTS[0]), (first, POINTS[1])]
    jets = np.array([jet(f, point, count) for f, point in tops]).T
    total = np.array([jet(below, point, count) for point in POINTS]).T
    wanted = np.array([jet(lambda s, t, f=f: f(s, t) / below(s, t), point, count) for f, point in tops]).T
    np.testing.assert_allclose(divide_jets(jets, total, np.array([2, 1])), wanted, rtol=1e-11, atol=1e-13)


def test_a_function_over_itself_is_one() -> None:
    total = np.random.default_rng(0).normal(size=(12, 5)) + 3
    found = divide_jets(total.copy(), total, np.ones(5, dtype=np.intp))
    np.testing.assert_allclose(found[0], 1)
    np.testing.assert_allclose(found[1:], 0, atol=1e-12)
