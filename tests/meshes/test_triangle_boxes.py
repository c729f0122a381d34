"""Triangle boxes: turned along their points, whatever those are, beside numpy's eigenvectors."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from orbiframe.meshes.triangle_boxes import TriangleBoxes, _turned


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 3), st.floats(1e-150, 1e150))
def test_axes_are_orthonormal_and_hold_the_points(seed, flat, size):
    """Of points in space, in a plane, on a line and in one place; low and high are the range along the axes."""
    rng = np.random.default_rng(seed)
    points = rng.integers(-3, 4, (5, 12, 3)) * np.where(np.arange(3) < 3 - flat, size, 0.0)
    axes, low, high = _turned(points)
    np.testing.assert_allclose(axes @ np.swapaxes(axes, 1, 2), np.tile(np.eye(3), (5, 1, 1)), atol=1e-14)
    along = points @ np.swapaxes(axes, 1, 2)
    np.testing.assert_allclose(low, along.min(axis=1), atol=1e-14 * size * 9)
    np.testing.assert_allclose(high, along.max(axis=1), atol=1e-14 * size * 9)


def test_axes_are_those_of_the_spread():
    """The second moments have nothing aside in the axes, and numpy's eigenvalues on the diagonal."""
    points = np.random.default_rng(0).standard_normal((40, 30, 3)) * [1.0, 0.3, 0.05]
    axes, _, _ = _turned(points)
    away = points - points.mean(axis=1, keepdims=True)
    moments = np.swapaxes(away, 1, 2) @ away
    seen = axes @ moments @ np.swapaxes(axes, 1, 2)
    spread = np.einsum("nii->ni", seen)
    np.testing.assert_allclose(seen - spread[:, :, None] * np.eye(3), 0, atol=1e-6 * spread.max())
    np.testing.assert_allclose(np.sort(spread, axis=1), np.linalg.eigvalsh(moments), rtol=1e-9)


@pytest.mark.parametrize("count", [1, 3, 4, 5, 100])
def test_every_triangle_is_in_one_leaf(count):
    corners = np.random.default_rng(1).standard_normal((count, 3, 3))
    assert sorted(TriangleBoxes.of(corners).order.tolist()) == list(range(count))
