"""How far a surface is from its mesh: angles between facets and normals."""

from __future__ import annotations

import numpy as np
import pytest

from orbiframe.fitting.accuracy import _tilt


def tilted(degrees: float, size: float) -> np.ndarray:
    angle = np.radians(degrees)
    return size * np.array([np.sin(angle), 0.0, np.cos(angle)])


@pytest.mark.parametrize("size", [0.1, 1.0, 30.0])
def test_the_tilt_is_the_root_mean_square_by_area_whatever_the_signs_and_lengths(size: float) -> None:
    facets = np.stack([tilted(10, 2 * size), tilted(-20, size), tilted(0, size)])
    normals = np.array([[0, 0, 1.0], [0, 0, -3.0], [0, 0, 0.5]])
    assert _tilt(normals, facets) == pytest.approx(np.sqrt((2 * 100 + 400) / 4), rel=1e-9)
