"""Smoothing and robust fits: slopes, data that are met, normals of surfaces, outliers, and standard errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fitted import REGISTRY, config, mesh_of
from orbiframe_fitters.robust import Robust
from orbiframe_fitters.smoothing import Smoothing

from orbiframe import fit
from orbiframe.errors import FitError, UsageError
from orbiframe.functions.samples import Samples
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.field import _samples as field_samples, fit_field
from orbiframe.surfaces.surface_integrals import integration

BEYOND = 1.96  # standard deviations that hold 95 % of normal numbers


@pytest.fixture(scope="module")
def torus():
    return fit(mesh_of("round torus"), config(500, "basis.name=ps6"), REGISTRY).surface


def scattered(surface, count: int, seed: int = 0) -> Points:
    rng = np.random.default_rng(seed)
    face = rng.integers(surface.refinement.coarse.face_count, size=count)
    return surface.points(face, rng.dirichlet([1, 1, 1], size=count))


def smooth(x: np.ndarray) -> np.ndarray:
    return np.asarray(np.sin(x[:, 0]) + 0.3 * x[:, 2] ** 2)


def slope(x: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(x[:, 0]), 0 * x[:, 0], 0.6 * x[:, 2]], axis=1)


def error(field, there: Points) -> float:
    wanted = smooth(field.surface.evaluate(there))
    return float(np.sqrt(np.mean((field.evaluate(there)[:, 0] - wanted) ** 2)))


# ---- data that are met ----------------------------------------------------------------------------------------------


def test_interpolation_meets_values_and_slopes_and_is_the_better_for_slopes(torus):
    points, there = scattered(torus, 60), scattered(torus, 500, seed=1)
    x = torus.evaluate(points)
    plain = torus.fit_field(points, smooth(x), fitter=Smoothing(interpolate=True))
    hermite = torus.fit_field(points, smooth(x), gradients=slope(x), fitter=Smoothing(interpolate=True))
    for field in (plain, hermite):
        np.testing.assert_allclose(field.evaluate(points)[:, 0], smooth(x), atol=1e-9)
    assert (plain.freedom, hermite.freedom) == (60, 180)
    found = hermite.scale * torus.basis.jets(points, hermite.coefficients, 1)[1:, :, 0]
    np.testing.assert_allclose(found, np.einsum("nki,ni->kn", torus.jet(points).first, slope(x)), atol=1e-9)
    assert error(hermite, there) < 0.5 * error(plain, there)


def test_interpolation_has_the_least_energy(torus):
    """Any other function that meets the data has more: the derivative of the energy along those is 0."""
    points = scattered(torus, 20)
    values = np.cos(np.arange(20.0))
    field = torus.fit_field(points, values, fitter=Smoothing(interpolate=True))
    over = integration(torus, torus.basis)
    jets = torus.basis.jet_matrices(over.points, 3)
    root = np.sqrt(over.area * over.stretch**3)
    rows = [jets[6] + jets[8], jets[9] + jets[11]]
    rng = np.random.default_rng(0)
    design = torus.basis.design_matrix(points).toarray()
    other = rng.normal(size=torus.basis.size)
    other -= np.linalg.lstsq(design, design @ other, rcond=None)[0]
    ours, move = ([root * (row @ c) for row in rows] for c in (field.coefficients[:, 0], other))
    inner = sum(float(a @ b) for a, b in zip(ours, move, strict=True))
    sizes = [np.sqrt(sum(float(a @ a) for a in parts)) for parts in (ours, move)]
    assert abs(inner) < 1e-6 * sizes[0] * sizes[1]


@pytest.mark.long
def test_left_out_by_blocks_is_what_a_fit_without_the_datum_misses(torus):
    """The value and the slope of a datum go together; met exactly, or nearly."""
    points = scattered(torus, 40)
    x = torus.evaluate(points)
    slopes = slope(x)
    slopes[::3] = np.nan
    noise = np.random.default_rng(2).normal(size=40)
    for fitter, weigh in ((Smoothing(interpolate=True), 1.0), (Smoothing(fairing=1e-3), 40 / 39)):
        whole = fit_field(torus, points, noise, fitter=fitter, gradients=slopes)
        for k in (0, 7):
            rest = np.delete(np.arange(40), k)
            fewer = Smoothing(interpolate=True) if fitter.interpolate else Smoothing(fairing=1e-3 * weigh)
            some = Points(points.patch[rest], points.x[rest])
            less = fit_field(torus, some, noise[rest], fitter=fewer, gradients=slopes[rest])
            there = Points(points.patch[[k]], points.x[[k]])
            wanted = noise[k] - less.evaluate(there)[0, 0]
            assert whole.left_out[k, 0] == pytest.approx(wanted, rel=1e-4)


def test_fixed_data_are_met_and_the_others_smoothed(torus):
    points = scattered(torus, 200)
    rng = np.random.default_rng(0)
    values = smooth(torus.evaluate(points)) + 0.2 * rng.normal(size=200)
    fixed = np.arange(200) < 5
    field = torus.fit_field(points, values, fixed=fixed)
    missed = np.abs(field.evaluate(points)[:, 0] - values)
    assert missed[fixed].max() < 1e-9
    assert np.median(missed[~fixed]) > 0.05
    held = Points(points.patch[:5], points.x[:5])
    assert field.standard_error(held).max() < 1e-6 * field.standard_error(scattered(torus, 50, seed=4)).min()
    assert np.isnan(field.left_out[fixed]).all()
    assert np.isfinite(field.error).all()


def test_data_that_contradict_each_other_are_named(torus):
    points = scattered(torus, 30)
    twice = Points(points.patch[[*range(30), 3]], points.x[[*range(30), 3]])
    values = np.append(np.sin(np.arange(30.0)), 5.0)
    with pytest.raises(FitError, match=r"31 conditions have the rank 30.*the value of sample (3|30) is missed"):
        torus.fit_field(twice, values, fitter=Smoothing(interpolate=True))
    values[30] = values[3]
    same = torus.fit_field(twice, values, fitter=Smoothing(interpolate=True))
    np.testing.assert_allclose(same.evaluate(twice)[:, 0], values, atol=1e-7)
    many = scattered(torus, torus.basis.size + 50)
    with pytest.raises(FitError, match="contradict the others"):
        torus.fit_field(many, np.random.default_rng(0).normal(size=len(many.patch)), fitter=Smoothing(interpolate=True))


# ---- surfaces -------------------------------------------------------------------------------------------------------


def surface_samples(torus, count: int) -> Samples:
    """The torus itself at Gauss points, and so many fixed places, moved outwards, with tilted normals."""
    over = integration(torus, torus.basis)
    fixed = scattered(torus, count, seed=7)
    jets = torus.basis.jets(fixed, torus.coefficients, 1)
    normal = np.cross(jets[1], jets[2])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    tilted = normal + 0.1 * jets[1] / np.linalg.norm(jets[1], axis=1)[:, None]
    tilted /= np.linalg.norm(tilted, axis=1)[:, None]
    n = len(over.area)
    return Samples(
        Points(np.concatenate([over.points.patch, fixed.patch]), np.concatenate([over.points.x, fixed.x])),
        np.concatenate([torus.basis.values(over.points, torus.coefficients), jets[0] + 0.02 * normal]),
        np.concatenate([over.area, np.full(count, over.area.mean())]),
        np.concatenate([over.stretch, np.ones(count)]),
        np.concatenate([over.area, np.zeros(count)]),
        order=3,
        normals=np.concatenate([np.full((n, 3), np.nan), tilted]),
        fixed=np.arange(n + count) >= n,
    )


def test_a_surface_goes_through_fixed_points_with_fixed_normals(torus):
    samples = surface_samples(torus, 6)
    coefficients = Smoothing(fairing=1e-6).fit(torus.basis, samples)
    held = np.flatnonzero(samples.fixed)
    there = Points(samples.points.patch[held], samples.points.x[held])
    jets = torus.basis.jets(there, coefficients, 1)
    np.testing.assert_allclose(jets[0], samples.values[held], atol=1e-9)
    normal = np.cross(jets[1], jets[2])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    np.testing.assert_allclose(normal, samples.normals[held], atol=1e-8)
    away = scattered(torus, 300, seed=9)
    moved = torus.basis.values(away, coefficients - torus.coefficients)
    assert np.median(np.linalg.norm(moved, axis=1)) < 0.01
    free = Smoothing(fairing=1e-6).fit(torus.basis, replace(samples, normals=None))
    assert np.abs(free - coefficients).max() > 1e-4


def test_normals_that_contradict_each_other_are_named(torus):
    samples = surface_samples(torus, 3)
    twice = np.append(np.arange(len(samples.weights)), len(samples.weights) - 1)
    normals = samples.normals[twice]
    normals[-1] = np.roll(normals[-1], 1)
    doubled = replace(samples.take(twice), normals=normals)
    with pytest.raises(FitError, match=r"normals of 4 fixed samples.*cannot be met"):
        Smoothing(fairing=1e-6).fit(torus.basis, doubled)


# ---- outliers -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("loss", ["tukey", "huber"])
def test_outliers_are_named_and_do_not_pull(torus, loss):
    """A tenth of the data is far off: the fit is nearly that of the good ones, and the scale is that of their noise."""
    points, there = scattered(torus, 400), scattered(torus, 500, seed=1)
    rng = np.random.default_rng(0)
    good = smooth(torus.evaluate(points)) + 0.05 * rng.normal(size=400)
    bad = np.sort(rng.choice(400, 40, replace=False))
    values = good.copy()
    values[bad] += rng.choice([-1, 1], 40) * rng.uniform(1, 5, 40)
    field = torus.fit_field(points, values, fitter=Robust(loss=loss))
    clean = torus.fit_field(points, good)
    pulled = torus.fit_field(points, values)
    assert set(bad) <= set(field.outliers)
    assert len(field.outliers) < 50
    assert error(field, there) < 2 * error(clean, there)
    assert error(field, there) < 0.3 * error(pulled, there)
    assert field.noise[0] == pytest.approx(0.05, rel=0.4)
    assert 0.04 < field.error[0] < 0.09


def test_a_robust_fit_meets_what_is_fixed(torus):
    points = scattered(torus, 120)
    values = smooth(torus.evaluate(points))
    values[[5, 80]] += 2
    fixed = np.arange(120) == 5
    field = torus.fit_field(points, values, fixed=fixed, fitter=Robust())
    missed = np.abs(field.evaluate(points)[:, 0] - values)
    assert missed[5] < 1e-9
    assert missed[80] > 1
    assert 80 in field.outliers
    assert 5 not in field.outliers


def test_without_outliers_robust_is_nearly_smoothing(torus):
    points = scattered(torus, 300)
    values = smooth(torus.evaluate(points)) + 0.05 * np.random.default_rng(1).normal(size=300)
    plain = torus.fit_field(points, values)
    robust = torus.fit_field(points, values, fitter=Robust(fairing=plain.fairing, loss="huber"))
    there = scattered(torus, 300, seed=1)
    assert np.abs(robust.evaluate(there) - plain.evaluate(there)).max() < 0.05
    assert len(robust.outliers) <= 6


def test_huber_is_the_fit_with_the_weights_that_it_gives(torus):
    """A fixed point of the iteration, and so a minimum: trust falls with the error as Huber's does."""
    values = np.random.default_rng(1).standard_t(2, size=(150, 1))
    samples = field_samples(torus, torus.basis, scattered(torus, 150), values)
    found = Robust(fairing=1e-2, loss="huber").fit_validated(torus.basis, samples)
    trust = np.nan_to_num(found.trust)
    again = Smoothing(fairing=1e-2).fit(torus.basis, replace(samples, weights=samples.weights * trust))
    area = samples.weights.sum() / (samples.weights * trust).sum()
    assert area > 1  # some data are believed less
    assert np.abs(torus.basis.design_matrix(samples.points) @ (again - found.coefficients)).max() < 1e-6
    assert 0 < trust[:150].min() < 0.5
    assert trust.max() == 1


# ---- standard errors ------------------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize("noise", [0.02, 0.2])
def test_bars_of_95_percent_hold_the_truth_at_so_many_places(torus, noise):
    there = scattered(torus, 500, seed=99)
    wanted = smooth(torus.evaluate(there))
    held = []
    for seed in range(8):
        points = scattered(torus, 300, seed)
        values = smooth(torus.evaluate(points)) + noise * np.random.default_rng(seed).normal(size=300)
        field = torus.fit_field(points, values)
        bars = BEYOND * field.standard_error(there)[:, 0]
        held.append(np.mean(np.abs(field.evaluate(there)[:, 0] - wanted) < bars))
        assert field.noise[0] == pytest.approx(noise, rel=0.25)
    assert 0.90 <= np.mean(held) <= 0.99


def test_bars_have_the_unit_of_the_values_and_grow_away_from_the_data(torus):
    points = scattered(torus, 120)
    x = torus.evaluate(points)
    half = x[:, 0] < 1.0
    some = Points(points.patch[half], points.x[half])
    values = smooth(x[half]) + 0.05 * np.random.default_rng(0).normal(size=half.sum())
    field = torus.fit_field(some, values)
    tens = torus.fit_field(some, 10 * values + 7)
    there = scattered(torus, 300, seed=3)
    bars = field.standard_error(there)[:, 0]
    np.testing.assert_allclose(tens.standard_error(there)[:, 0], 10 * bars, rtol=1e-6)
    far = torus.evaluate(there)[:, 0] > 2
    assert bars[far].min() > 2 * np.median(bars[torus.evaluate(there)[:, 0] < 0])


# ---- what is refused ------------------------------------------------------------------------------------------------


def test_what_does_not_fit_is_said(torus):
    points = scattered(torus, 4)
    with pytest.raises(UsageError, match="must be huber or tukey"):
        Robust(loss="tuckey")
    with pytest.raises(FitError, match="gradients have the shape"):
        torus.fit_field(points, np.zeros(4), gradients=np.zeros((4, 2)))
    with pytest.raises(FitError, match="fixed has the shape"):
        torus.fit_field(points, np.zeros(4), fixed=[0, 1])
    plain = REGISTRY.load("fitter", "least-squares")()
    with pytest.raises(FitError, match="fixed samples also for"):
        torus.fit_field(points, np.zeros(4), fixed=np.ones(4, dtype=bool), fitter=plain)
    field = torus.fit_field(scattered(torus, 900), np.zeros(900), fitter=plain)
    with pytest.raises(FitError, match="tells no standard errors"):
        field.standard_error(points)
