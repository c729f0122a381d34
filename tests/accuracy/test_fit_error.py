"""How near the surface comes to the mesh with a given number of functions."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import fitted

pytestmark = pytest.mark.long


def test_the_plate_with_a_thousand_functions() -> None:
    report = fitted("plate_genus2.off", 1000).report
    assert report["fit"]["rms"] <= 2e-3
    assert report["fit"]["max"] <= 3e-2
    assert report["map"]["angle_distortion"]["p95"] < 1.3


@pytest.mark.parametrize(("name", "rms"), [("torus.off", 1.5e-3), ("three_crosscaps.off", 2e-3), ("cube.off", 4e-3)])
def test_four_hundred_functions(name: str, rms: float) -> None:
    assert fitted(name, 400).report["fit"]["rms"] <= rms


def test_more_functions_come_nearer() -> None:
    errors = [fitted("plate_genus2.off", size).report["fit"]["rms"] for size in (60, 240, 1000)]
    assert (np.diff(np.log(errors)) < -0.5).all()
