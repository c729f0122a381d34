"""The integral of the Gaussian curvature of a fitted surface is 2 pi chi: derivatives, frames and cover at once."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import fitted_linearly

pytestmark = pytest.mark.long

# Dataset: Euler characteristic, and the Gauss points along a direction that reach 1e-6 with 60 functions.
CASES = {
    "cube.off": (2, 4),
    "sphere.off": (2, 4),
    "torus.off": (0, 6),
    "plate_genus2.off": (-2, 8),
    "plate_genus5.off": (-8, 10),
}


@pytest.mark.parametrize("name", CASES)
def test_at_the_default_order(name: str) -> None:
    chi, _ = CASES[name]
    assert fitted_linearly(name, 150).surface.total_curvature() == pytest.approx(2 * np.pi * chi, abs=2e-3)


@pytest.mark.parametrize("name", CASES)
def test_with_enough_points(name: str) -> None:
    chi, order = CASES[name]
    assert fitted_linearly(name, 60).surface.total_curvature(order) == pytest.approx(2 * np.pi * chi, abs=1e-6)
