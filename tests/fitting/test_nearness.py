"""The surface of a fit by steps is never worse than the linear fit that it began with."""

from __future__ import annotations

import numpy as np
import pytest
from orbiframe_fitters.slide import Slide
from orbiframe_fitters.sliding import Sliding
from reference_meshes import grid

from orbiframe import fit

FACETS, SMOOTH = {"means": "facets"}, {"means": "smooth", "lift": False}


@pytest.fixture
def spoilt(monkeypatch):
    """Steps that lead away: a mutant of the fitter."""
    slid = Slide.from_start

    def away(self, coefficients, steps):
        noise = np.random.default_rng(0).normal(scale=0.3, size=coefficients.shape)
        return slid(self, coefficients, steps) + noise

    monkeypatch.setattr(Slide, "from_start", away)


@pytest.mark.parametrize("data", [FACETS, SMOOTH])
def test_a_surface_that_steps_made_worse_is_not_taken(data, spoilt) -> None:
    """It is the linear fit to the last bit, and the report says so."""
    mesh = grid(12, 6)
    linear = fit(mesh, size=60, data=data, fitter={"name": "least-squares"}, progress=False)
    found = fit(mesh, size=60, data=data, progress=False)
    np.testing.assert_array_equal(found.surface.coefficients, linear.surface.coefficients)
    assert any("sliding left" in note for note in found.report["notes"])
    assert not any("sliding left" in note for note in linear.report["notes"])


@pytest.mark.parametrize("data", [FACETS, SMOOTH])
def test_a_surface_that_steps_made_better_is_taken(data) -> None:
    found = fit(grid(12, 6), size=60, data=data, progress=False)
    started = Sliding().fit_started(found.surface.basis, found.samples)
    np.testing.assert_allclose(found.surface.coefficients, started.coefficients, atol=1e-9)
    assert np.abs(started.start - started.coefficients).max() > 1e-4
    assert not any("sliding left" in note for note in found.report["notes"])
