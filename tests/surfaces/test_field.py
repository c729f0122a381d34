"""Fields: against functions in closed form, against refits without a datum, and against the best choice of fairing."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import REGISTRY, fitted
from orbiframe_fitters.smoothing import Smoothing

from orbiframe.errors import FitError, UsageError
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.field import fit_field
from orbiframe.surfaces.nearest import nearest_points
from orbiframe.surfaces.surface_integrals import integration


def scattered(surface, count: int, seed: int = 0) -> Points:
    rng = np.random.default_rng(seed)
    face = rng.integers(surface.refinement.coarse.face_count, size=count)
    return surface.points(face, rng.dirichlet([1, 1, 1], size=count))


def smooth(x: np.ndarray) -> np.ndarray:
    return np.stack([np.sin(x[:, 0]) + 0.3 * x[:, 2] ** 2, np.exp(0.5 * x[:, 1])], axis=1)


@pytest.fixture(scope="module")
def torus():
    return fitted("round torus", 300).surface


def test_a_smooth_function_is_found_from_points_in_space(torus):
    """Scattered points; the error between them falls, and its estimate by cross-validation is of its size."""
    for count, bound in ((150, 0.2), (600, 0.02)):
        data = torus.evaluate(scattered(torus, count))
        field = torus.fit_field(data, smooth(data))
        there = scattered(torus, 500, seed=1)
        error = np.sqrt(np.mean((field.evaluate(there) - smooth(torus.evaluate(there))) ** 2, axis=0))
        assert (error < bound).all()
        assert (field.error < 8 * error).all()
        assert (field.error > error / 8).all()
        assert field.distance.max() < 1e-9


@pytest.mark.long
def test_left_out_is_what_a_fit_without_the_datum_misses(torus):
    points = scattered(torus, 60)
    values = np.random.default_rng(2).normal(size=(60, 1))
    whole = fit_field(torus, points, values, fitter=Smoothing(fairing=1e-3))
    for k in (0, 7, 31):
        rest = np.delete(np.arange(60), k)
        # The unit of weights is area per datum: one datum fewer weighs more.
        part = Smoothing(fairing=1e-3 * 60 / 59)
        less = fit_field(torus, Points(points.patch[rest], points.x[rest]), values[rest], fitter=part)
        there = Points(points.patch[[k]], points.x[[k]])
        assert whole.left_out[k, 0] == pytest.approx(values[k, 0] - less.evaluate(there)[0, 0], rel=1e-5)


@pytest.mark.long
@pytest.mark.parametrize("noise", [0.02, 0.2])
def test_cross_validation_is_near_the_best_choice(torus, noise):
    points, there = scattered(torus, 800), scattered(torus, 800, seed=5)
    rng = np.random.default_rng(3)
    values = smooth(torus.evaluate(points))[:, :1] + noise * rng.normal(size=(800, 1))
    wanted = smooth(torus.evaluate(there))[:, :1]

    def wrong(fairing: float | None) -> float:
        field = fit_field(torus, points, values, fitter=Smoothing(fairing=fairing))
        return float(np.sqrt(np.mean((field.evaluate(there) - wanted) ** 2)))

    best = min(wrong(10.0**power) for power in np.arange(-4, 4, 0.5))
    assert wrong(None) < 1.1 * best
    assert best < noise / 2


def test_few_data_are_joined_calmly(torus):
    """Twenty equal values give the constant, and twenty others stay within a few times their range."""
    points, there = scattered(torus, 20), scattered(torus, 1000, seed=1)
    constant = torus.fit_field(points, np.full(20, 1.0))
    assert np.abs(constant.evaluate(there) - 1).max() < 1e-9
    values = np.cos(np.arange(20.0))
    field = torus.fit_field(points, values)
    assert np.abs(field.evaluate(there)).max() < 4
    assert field.freedom <= 20


def test_nearest_points_of_a_round_torus(torus):
    """Targets on the normals: their feet are where they began, up to how round the surface is."""
    rng = np.random.default_rng(0)
    angle, around = rng.uniform(0, 2 * np.pi, (2, 200))
    out = np.stack([np.cos(angle) * np.cos(around), np.sin(angle) * np.cos(around), np.sin(around)], axis=1)
    middle = 3 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    height = rng.uniform(-0.5, 0.5, 200)
    feet, distance = nearest_points(torus, middle + (1 + height)[:, None] * out)
    np.testing.assert_allclose(distance, np.abs(height), atol=2e-3)
    np.testing.assert_allclose(torus.evaluate(feet), middle + out, atol=2e-2)


def test_integration_gives_the_area_of_the_torus(torus):
    over = integration(torus, torus.basis)
    assert over.area.sum() * torus.scale**2 == pytest.approx(4 * np.pi**2 * 3, rel=2e-3)
    assert over.area_on_x.sum() == pytest.approx(torus.orbifold.area, rel=1e-6)


def test_what_does_not_fit_is_said(torus):
    points = scattered(torus, 4)
    with pytest.raises(FitError, match="4 points have values of shape"):
        torus.fit_field(points, np.zeros(3))
    with pytest.raises(FitError, match="value of point 2"):
        torus.fit_field(points, [1, 2, np.nan, 3])
    with pytest.raises(FitError, match="point 1 is"):
        torus.fit_field([[0, 0, 0], [np.inf, 0, 0]], [1, 2])
    with pytest.raises(UsageError, match="fairing"):
        Smoothing(fairing=-1.0)


def test_any_fitter_will_do(torus):
    points = scattered(torus, 900)
    values = smooth(torus.evaluate(points))
    plain = fit_field(torus, points, values, fitter=REGISTRY.load("fitter", "least-squares")())
    assert plain.error is None
    assert np.abs(plain.evaluate(points) - values).max() < 0.1
