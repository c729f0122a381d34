"""Sliding fits: shapes that are known, invariance, and what the fit must not do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import reference_surfaces as surfaces
from fitted import REGISTRY, grid
from orbiframe_bases.gaussian import Gaussian
from orbiframe_bases.powell_sabin import PowellSabin2, PowellSabin6
from orbiframe_fitters import few_samples, slide_step
from orbiframe_fitters.least_squares import LeastSquares
from orbiframe_fitters.slide import Slide
from orbiframe_fitters.slide_step import SlideStep
from orbiframe_fitters.sliding import Sliding
from orbiframe_fitters.sliding_data import Feet, Schedule, linearised, normals_of

from orbiframe import Samples, UsageError
from orbiframe.functions import coordinate_samples
from orbiframe.meshes import bisected, triangulated

BIG, SMALL = 3.0, 1.0


def torus_points(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    ring = BIG + SMALL * np.cos(v)
    return np.stack([ring * np.cos(u), ring * np.sin(u), SMALL * np.sin(v)], axis=1)


def off_torus(x: np.ndarray) -> np.ndarray:
    return np.abs(np.hypot(np.hypot(x[:, 0], x[:, 1]) - BIG, x[:, 2]) - SMALL)


@pytest.fixture(scope="module")
def mapped():
    """A map that is not conformal: the even grid of angles, on a mesh of 24 by 12 quads."""
    mesh = bisected(triangulated(grid(24, 12, torus_points)), 0.5, True).polyhedron
    return REGISTRY.load("parametrizer", "harmonic")(mesh, REGISTRY.geometry(0), None)


@pytest.fixture(scope="module")
def exact(mapped):
    """Samples that lie on the torus, and whose parameters do not fit to their places: 0.1 off along the surface."""
    samples = coordinate_samples(mapped)
    ring = np.hypot(samples.values[:, 0], samples.values[:, 1])
    u, v = np.arctan2(samples.values[:, 1], samples.values[:, 0]), np.arctan2(samples.values[:, 2], ring - BIG)
    rng = np.random.default_rng(4)
    values = torus_points(u + 0.03 * rng.normal(size=len(u)), v + 0.1 * rng.normal(size=len(v)))
    return replace(samples, values=values)


@pytest.mark.parametrize("make", [Gaussian, PowellSabin2, PowellSabin6])
def test_wrong_parameters_do_not_matter(make, mapped, exact) -> None:
    basis = make(mapped.orbifold, mapped, size=300)
    linear, slid = (fitter().fit(basis, exact) for fitter in (LeastSquares, Sliding))
    before, after = (off_torus(basis.values(exact.points, c)) for c in (linear, slid))
    assert np.sqrt(np.mean(after**2)) < 0.3 * np.sqrt(np.mean(before**2))


def test_points_of_a_smooth_surface_alone(mapped) -> None:
    """288 vertices, and fairness between them: nearer than the facets by two orders."""
    from orbiframe.functions import vertex_samples

    coarse = triangulated(grid(24, 12, torus_points))
    refinement = bisected(coarse, 0.5, True)
    samples = vertex_samples(mapped, refinement)
    assert (samples.weights > 0).sum() == 288
    basis = PowellSabin6(mapped.orbifold, mapped, size=600)
    everywhere = coordinate_samples(mapped)
    facets = np.sqrt(np.mean(off_torus(everywhere.values) ** 2))
    error = off_torus(basis.values(everywhere.points, Sliding().fit(basis, samples)))
    assert np.sqrt(np.mean(error**2)) < 0.02 * facets


def test_moving_the_data_moves_the_surface(mapped, exact) -> None:
    """Rotated, shifted, scaled and mirrored samples give a surface that is so too."""
    basis = PowellSabin2(mapped.orbifold, mapped, size=150)
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    changed = replace(exact, values=2.5 * exact.values @ turn.T + [1.0, -2.0, 0.5], weights=6.25 * exact.weights)
    changed = replace(changed, stretch=exact.stretch / 6.25)
    places = exact.points
    expected = 2.5 * basis.values(places, Sliding().fit(basis, exact)) @ turn.T + [1.0, -2.0, 0.5]
    np.testing.assert_allclose(basis.values(places, Sliding().fit(basis, changed)), expected, atol=1e-6)


def test_two_coordinates_are_fitted_by_least_squares(mapped, exact) -> None:
    basis = PowellSabin2(mapped.orbifold, mapped, size=150)
    flat = replace(exact, values=exact.values[:, :2])
    np.testing.assert_array_equal(Sliding().fit(basis, flat), LeastSquares().fit(basis, flat))


def test_no_step_leads_away(mapped, exact) -> None:
    """The distance of the data to the surface falls from step to step."""
    basis = PowellSabin2(mapped.orbifold, mapped, size=200)
    first = LeastSquares().fit(basis, exact)
    slide = Slide(basis, exact, (Schedule(1e-4, 1e-2, 1e-3),))
    found = []
    for steps in range(4):
        coefficients = slide.from_start(first, steps)
        feet = slide._slid(
            slide._slid([slide._feet(p.points, p.values, coefficients) for p in slide.data], coefficients), coefficients
        )
        found.append(slide._distance(feet))
    assert (np.diff(found) <= 1e-12).all()
    assert found[-1] < 0.5 * found[0]


def test_curvature_and_normals_of_a_torus() -> None:
    """The larger principal curvature of the torus is 1 / r, in any frame."""
    u, v = np.random.default_rng(1).uniform(0, 2 * np.pi, size=(2, 40))
    ring = BIG + SMALL * np.cos(v)
    zero = np.zeros_like(u)
    along = np.stack([-ring * np.sin(u), ring * np.cos(u), zero], axis=1)
    across = SMALL * np.stack([-np.sin(v) * np.cos(u), -np.sin(v) * np.sin(u), np.cos(v)], axis=1)
    inward = np.stack([-ring * np.cos(u), -ring * np.sin(u), zero], axis=1)
    mixed = SMALL * np.stack([np.sin(v) * np.sin(u), -np.sin(v) * np.cos(u), zero], axis=1)
    back = -SMALL * np.stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)], axis=1)
    normal, curvature = normals_of(np.stack([torus_points(u, v), along, across, inward, mixed, back]))
    np.testing.assert_allclose(curvature, 1 / SMALL, rtol=1e-9)
    np.testing.assert_allclose(np.abs(np.einsum("ni,ni->n", normal, back)), SMALL, rtol=1e-9)


def test_the_pull_along_the_surface_is_that_of_the_squared_distance() -> None:
    """Outside of a circle of radius rho, the squared distance grows along it by d / (d + rho) of that of a point

    (Pottmann, Leopoldseder and Hofer, 2002): here a cylinder of radius 2 seen from distance 0.5.
    """

    from orbiframe import Points

    jets = np.zeros((6, 1, 3))
    jets[0], jets[1], jets[2], jets[3] = [2, 0, 0], [0, 2, 0], [0, 0, 1], [-2, 0, 0]
    gap = np.array([[0.5, 0.0, 0.0]])
    points = Points(np.zeros(1, int), np.eye(3)[:1])
    datum = Samples(points, jets[0] + gap, np.ones(1), np.ones(1))
    form, wanted = linearised(Feet(points, [], jets, gap), datum, Schedule(0, 0, 0))
    np.testing.assert_allclose(form, [[1, 0, 0, 0.5 / 2.5, 0, 0.5 / 2.5]], atol=1e-12)
    np.testing.assert_allclose(wanted, [[0.5, 0, 0]], atol=1e-12)


def test_points_on_both_sides_of_a_smooth_surface_hardly_stop_it_from_sliding() -> None:
    """Of the curvature a tenth counts, so that the form along the surface is that of a tenth of the distance."""
    from orbiframe import Points

    jets = np.zeros((6, 1, 3))
    jets[0], jets[1], jets[2], jets[3] = [2, 0, 0], [0, 2, 0], [0, 0, 1], [-2, 0, 0]
    points = Points(np.zeros(1, int), np.eye(3)[:1])
    found = []
    for gap, bent in ((0.5, 0.1), (0.05, 1.0)):
        feet = Feet(points, [], jets, np.array([[gap, 0.0, 0.0]]))
        datum = Samples(points, jets[0] + feet.gap, np.ones(1), np.ones(1))
        found.append(linearised(feet, datum, Schedule(0, 0, 0, bent))[0])
    np.testing.assert_allclose(found[0], found[1], atol=1e-15)
    assert found[0][0, 3] == pytest.approx(0.05 / 2.05)


def test_more_fairness_needs_no_new_sums(mapped, exact, monkeypatch) -> None:
    """A step that would pinch something off is tried with more fairness, and data and energy are summed up once."""
    basis = PowellSabin6(mapped.orbifold, mapped, size=150)
    samples = replace(exact, order=3)
    counts = {"sums": 0, "solutions": 0}
    stiffness, change = Slide._stiffness, SlideStep.change

    def counted(self, *given):
        counts["sums"] += 1
        return stiffness(self, *given)

    def changed(self, fairing):
        counts["solutions"] += 1
        return change(self, fairing)

    pinched = iter([True, True, True])
    monkeypatch.setattr(Slide, "_stiffness", counted)
    monkeypatch.setattr(SlideStep, "change", changed)
    monkeypatch.setattr(Slide, "_pinched", lambda *_: next(pinched, False))
    Slide(basis, samples, (Schedule(1e-4, 1e-3, 0.0),)).from_start(LeastSquares().fit(basis, samples), 1)
    assert counts["solutions"] == counts["sums"] + 3


@pytest.mark.parametrize("options", [{"fairing": -1.0}, {"steps": -1}])
def test_options_out_of_range(options) -> None:
    with pytest.raises(UsageError, match=next(iter(options))):
        Sliding(**options)


def test_no_step_is_the_linear_fit() -> None:
    triangulation = surfaces.triangulated("octagon")
    basis = Gaussian(triangulation.orbifold, triangulation, size=40, width=1.3)
    rng = np.random.default_rng(11)
    points = surfaces.random_points(basis.orbifold, 600, rng)
    data = Samples(points, rng.normal(size=(600, 3)), np.ones(600), np.ones(600))
    np.testing.assert_array_equal(Sliding(steps=0).fit(basis, data), LeastSquares().fit(basis, data))


@pytest.mark.parametrize("make", [Gaussian, PowellSabin6])
def test_steps_of_many_functions_lead_where_those_of_few_do(make, mapped, exact, monkeypatch) -> None:
    """Equations solved by conjugate gradients to a few digits, and factored: nearly the same surface."""

    basis = make(mapped.orbifold, mapped, size=200)
    direct = basis.values(exact.points, Sliding().fit(basis, exact))
    monkeypatch.setattr(slide_step, "_DIRECT", 0)
    iterated = basis.values(exact.points, Sliding().fit(basis, exact))
    assert np.abs(iterated - direct).max() < 0.05 * np.abs(direct - exact.values).max()


def test_a_smooth_surface_is_not_pinched_in_one_step(mapped) -> None:
    """Shrunk about one function to a third of a length at some place is too much; for facets it is not."""
    from orbiframe.functions import vertex_samples
    from orbiframe.meshes import Bisection

    basis = Gaussian(mapped.orbifold, mapped, size=200)
    mesh = mapped.polyhedron
    whole = Bisection(mesh, mesh, np.full(mesh.face_count, -1), np.arange(mesh.face_count))
    smooth = vertex_samples(mapped, whole)
    schedule = (Schedule(1e-6, 1e-4, 0.0),)
    coefficients = LeastSquares().fit(basis, smooth)
    slide = Slide(basis, smooth, schedule)
    assert slide.energy is not None
    assert slide.energy.order == 3
    assert slide._pinched(coefficients, 0.5 * coefficients)  # a quarter of the area
    assert not slide._pinched(coefficients, 0.65 * coefficients)
    middle = basis.values(basis.centres, coefficients)
    near = 0.9 * np.exp(-((middle - middle[0]) ** 2).sum(axis=1) / 4)
    thinner = coefficients + near[:, None] * (middle[0] - coefficients)
    assert slide._pinched(coefficients, thinner)
    assert not Slide(basis, coordinate_samples(mapped), schedule)._pinched(coefficients, 0.1 * coefficients)


def test_many_samples_count_though_few_slide(monkeypatch, mapped) -> None:
    """Noise is averaged over all of them: the fit is as near to the torus as with all in every step."""
    monkeypatch.setattr(few_samples, "_CHEAP", 0)
    noisy = noisy_torus(mapped)
    basis = Gaussian(mapped.orbifold, mapped, size=60)
    few = few_samples.few_samples(basis, noisy).data
    assert len(few.weights) <= 24 * 60 < len(noisy.weights) / 3
    here = off_torus(basis.values(noisy.points, Sliding().fit(basis, noisy)))
    monkeypatch.setattr(few_samples, "_CHEAP", 1 << 30)
    there = off_torus(basis.values(noisy.points, Sliding().fit(basis, noisy)))
    monkeypatch.setattr(few_samples, "_CHEAP", 0)
    monkeypatch.setattr(Slide, "with_all", lambda _self, coefficients, *_: coefficients)
    alone = off_torus(basis.values(noisy.points, Sliding().fit(basis, noisy)))
    assert np.linalg.norm(here) < 1.05 * np.linalg.norm(there)
    assert np.linalg.norm(alone) > 1.3 * np.linalg.norm(there)


def test_few_samples_stand_for_all(monkeypatch, mapped) -> None:
    """The weights and areas of the samples at which each function is the largest are kept, brute force says which."""
    monkeypatch.setattr(few_samples, "_CHEAP", 0)
    rng = np.random.default_rng(2)
    noisy = noisy_torus(mapped)
    noisy = replace(noisy, weights=noisy.weights * rng.integers(0, 2, len(noisy.weights)), area=noisy.weights)
    basis = Gaussian(mapped.orbifold, mapped, size=40)
    few = few_samples.few_samples(basis, noisy).data
    for samples, total in ((noisy, {}), (few, {})):
        largest = basis.design_matrix(samples.points).toarray().argmax(axis=1)
        total["weights"] = np.bincount(largest, weights=samples.weights, minlength=40)
        total["shares"] = np.bincount(largest, weights=samples.shares, minlength=40)
        total["most"] = np.bincount(2 * largest + (samples.weights > 0)).max()
        if samples is noisy:
            wanted = total
    assert total["most"] == 24 < wanted["most"]
    np.testing.assert_allclose(total["weights"], wanted["weights"], rtol=1e-12)
    np.testing.assert_allclose(total["shares"], wanted["shares"], rtol=1e-12)


def test_along_creases_all_samples_count(monkeypatch, mapped) -> None:
    monkeypatch.setattr(few_samples, "_CHEAP", 0)
    noisy = noisy_torus(mapped)
    creased = replace(noisy, still=np.zeros(len(noisy.weights), dtype=np.bool_))
    assert few_samples.few_samples(Gaussian(mapped.orbifold, mapped, size=40), creased).data is creased


def test_held_samples_all_remain(monkeypatch, mapped) -> None:
    monkeypatch.setattr(few_samples, "_CHEAP", 0)
    noisy = noisy_torus(mapped)
    held = np.arange(len(noisy.weights)) % 100 < 9
    basis = Gaussian(mapped.orbifold, mapped, size=40)
    few = few_samples.few_samples(basis, replace(noisy, held=held)).data
    assert few.held.sum() == held.sum()
    assert len(few.weights) <= 24 * 40 + held.sum()
    np.testing.assert_allclose(np.sort(few.weights[few.held]), np.sort(noisy.weights[held]), rtol=1e-12)


def noisy_torus(mapped) -> Samples:
    """Points of the torus, each moved by a fiftieth of its smaller radius, at places drawn at random."""
    rng = np.random.default_rng(1)
    every = coordinate_samples(mapped)
    chosen = rng.integers(len(every.weights), size=6000)
    samples = every.take(chosen)
    ring = np.hypot(samples.values[:, 0], samples.values[:, 1])
    u, v = np.arctan2(samples.values[:, 1], samples.values[:, 0]), np.arctan2(samples.values[:, 2], ring - BIG)
    values = torus_points(u, v) + 0.02 * SMALL * rng.normal(size=(6000, 3))
    return replace(samples, values=values, weights=np.full(6000, every.weights.sum() / 6000))
