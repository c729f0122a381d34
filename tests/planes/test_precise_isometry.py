"""PreciseIsometry matrices against the 3 x 3 matrices of the geometries, and far from the origin against mpmath."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from reference_meshes import geometry

from orbiframe.planes import PreciseIsometry

seeds = st.integers(0, 2**32 - 1)


def random_isometries(curvature: int, count: int, rng: np.random.Generator) -> np.ndarray:
    plane = geometry(curvature)
    moves = plane.translation(rng.uniform(0, 2, count), rng.uniform(0, 2 * np.pi, count))
    turned = moves @ plane.rotation(rng.uniform(0, 2 * np.pi, count))
    mirror = np.where(rng.random(count)[:, None, None] < 0.5, plane.reflection(0.3), np.eye(3))
    return turned @ mirror


@pytest.mark.parametrize("curvature", [1, 0, -1])
@given(seed=seeds)
@settings(max_examples=20, deadline=None)
def test_products_and_inverses_are_those_of_matrices(curvature, seed):
    rng = np.random.default_rng(seed)
    g, h = random_isometries(curvature, 5, rng), random_isometries(curvature, 5, rng)
    s, t = PreciseIsometry.of_matrix(curvature, g), PreciseIsometry.of_matrix(curvature, h)
    np.testing.assert_allclose(s.matrix, g, atol=1e-13)
    np.testing.assert_allclose((s @ t).matrix, g @ h, atol=1e-12)
    np.testing.assert_allclose(s.inverse.matrix, np.linalg.inv(g), atol=1e-12)
    np.testing.assert_allclose((s @ s.inverse).matrix, np.tile(np.eye(3), (5, 1, 1)), atol=1e-12)
    assert np.array_equal(s.reverses, geometry(curvature).parity(g) < 0)


@pytest.mark.parametrize("curvature", [1, 0, -1])
def test_directions_are_those_of_the_image_of_the_origin(curvature):
    angle = np.linspace(-3, 3, 7)
    move = geometry(curvature).translation(1.2, angle)
    np.testing.assert_allclose(PreciseIsometry.of_matrix(curvature, move).direction.astype(float), angle, atol=1e-14)
    np.testing.assert_allclose(
        PreciseIsometry.rotation(curvature, angle).matrix, geometry(curvature).rotation(angle), atol=1e-15
    )


@given(st.floats(1, 16), st.floats(0, 6))
@settings(max_examples=20, deadline=None)
def test_long_ways_there_and_back_keep_the_error_of_spin_matrices(distance, angle):
    """Two translations by d that almost cancel: the error is about eps e^d, that of 3 x 3 matrices eps e^(2d)."""
    eps = float(np.finfo(np.longdouble).eps)
    there = [np.sinh(distance) * np.cos(angle), np.sinh(distance) * np.sin(angle)]
    x = np.array([[np.cosh(distance), *there], [np.cosh(distance), there[0], there[1] * (1 + 1e-9) + 1e-9]])
    moves = PreciseIsometry.translation(-1, x)
    step = moves[np.array([0])].inverse @ moves[np.array([1])]
    exact = _step(x)
    found = complex(2 * step.a[0] * step.b[0])
    assert abs(found - exact) < 4 * eps * np.exp(distance)


def _step(x: np.ndarray) -> complex:
    """x1 + i x2 of the second point after the first is moved to the origin."""
    with mpmath.workdps(60):
        pair = []
        for row in x:
            z = mpmath.mpc(row[1], row[2])
            a = mpmath.sqrt((1 + mpmath.sqrt(1 + abs(z) ** 2)) / 2)
            pair.append((a, z / (2 * a)))
        (a, b), (c, d) = pair
        p, q = mpmath.conj(a) * c - b * mpmath.conj(d), mpmath.conj(a) * d - b * mpmath.conj(c)
        return complex(2 * p * q)
