"""Steps of Newton's that mean nothing are cut short."""

from __future__ import annotations

import numpy as np
import pytest
import reference_surfaces as surfaces

from orbiframe.functions.feet import moved


@pytest.mark.parametrize("name", ["octagon", "klein_bottle", "sphere"])
def test_long_steps_are_cut_and_those_that_are_no_numbers_are_none(name):
    triangulation = surfaces.triangulated(name, 2)
    orbifold = triangulation.orbifold
    points = triangulation.locate(np.arange(4), np.full((4, 3), 1 / 3))
    step = np.array([[1e200, 0.0], [0.0, -1e9], [np.nan, 1.0], [0.0, 0.0]])
    there = moved(orbifold, points, step)
    assert np.isfinite(there.x).all()
    assert np.abs(there.x).max() < 1e3
    np.testing.assert_allclose(orbifold.geometry.distance(there.x[2:], points.x[2:]), 0, atol=1e-9)
