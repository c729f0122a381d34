"""Feet on a torus of revolution against the closed form, and on others by comparison."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import fitted

from orbiframe.functions.feet import _Search, around, foot_points, foot_step, moved
from orbiframe.orbifolds.atlas import Points


def places(result, count: int, seed: int = 0) -> Points:
    rng = np.random.default_rng(seed)
    face = rng.integers(result.surface.refinement.coarse.face_count, size=count)
    return result.surface.points(face, rng.dirichlet(np.ones(3), count))


@pytest.mark.parametrize("name", ["round torus", "round sphere", "double torus", "Klein bottle"])
def test_the_foot_of_a_point_above_the_surface_is_the_point_below_it(name: str) -> None:
    surface = fitted(name).surface
    feet = places(fitted(name), 200)
    jets = surface.basis.jets(feet, surface.coefficients, 2)
    normal = np.cross(jets[1], jets[2])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    height = 1e-3
    step = np.random.default_rng(1).normal(size=(200, 2))
    step *= 5e-3 / np.linalg.norm(step[:, :1] * jets[1] + step[:, 1:] * jets[2], axis=1)[:, None]
    start = moved(surface.orbifold, feet, step)
    found, distance = foot_points(surface.basis, surface.coefficients, start, jets[0] + height * normal, 0.05, 8)
    assert (distance <= height * (1 + 1e-5)).all()
    same = distance > height * (1 - 1e-5)
    assert same.mean() > 0.95, "elsewhere the surface bends so much that another point is nearer"
    there = surface.basis.values(found, surface.coefficients)
    np.testing.assert_allclose(there[same], jets[0][same], atol=1e-5)


def test_a_step_is_newtons_on_a_circle() -> None:
    """A cylinder of radius r about a line: at the angle a from the foot, seen from distance d, the step is known.

    The half squared distance of (r cos a, r sin a) to (r + d, 0) has the derivatives (r + d) r sin a, (r + d) r cos a.
    """
    r, d, a = 0.7, 0.2, 0.3
    position = np.array([[r * np.cos(a), r * np.sin(a), 0.0]])
    around_it = np.array([[-r * np.sin(a), r * np.cos(a), 0.0]])
    jets = np.stack([position, around_it, [[0.0, 0.0, 1.0]], -position, [[0.0] * 3], [[0.0] * 3]])
    step = foot_step(jets, np.array([[r + d, 0.0, 0.5]]), 10.0)
    np.testing.assert_allclose(step, [[-np.tan(a), 0.5]], rtol=1e-12)
    plain = foot_step(jets, np.array([[r + d, 0.0, 0.5]]), 10.0, bent=False)
    np.testing.assert_allclose(plain, [[-(r + d) * np.sin(a) / r, 0.5]], rtol=1e-12)
    short = foot_step(jets, np.array([[r + d, 0.0, 0.5]]), 0.1)
    assert np.linalg.norm(short * [[r, 1.0]]) == pytest.approx(0.1)


def test_steps_round_about_are_as_long_in_space_as_they_should_be() -> None:
    jets = np.random.default_rng(3).normal(size=(6, 30, 3))
    steps = around(jets, 0.2)
    away = steps[..., :1] * jets[1] + steps[..., 1:] * jets[2]
    np.testing.assert_allclose(np.linalg.norm(away, axis=2), 0.2, rtol=1e-9)
    np.testing.assert_allclose(away.sum(axis=0), 0, atol=1e-12)


def test_a_target_never_gets_farther() -> None:
    surface = fitted("double torus").surface
    start = places(fitted("double torus"), 300)
    targets = np.random.default_rng(5).uniform(-0.5, 0.5, size=(300, 3))
    before = np.linalg.norm(surface.basis.values(start, surface.coefficients) - targets, axis=1)
    found, distance = foot_points(surface.basis, surface.coefficients, start, targets, 0.05)
    assert (distance <= before).all()
    there = np.linalg.norm(surface.basis.values(found, surface.coefficients) - targets, axis=1)
    np.testing.assert_allclose(there, distance, rtol=1e-9)


def test_moved_points_stay_points_of_the_same_surface() -> None:
    """Far walks, patch by patch: there and back again."""
    surface = fitted("double torus").surface
    start = places(fitted("double torus"), 50)
    geometry, step = surface.orbifold.geometry, np.full((50, 2), 0.4)
    there = moved(surface.orbifold, start, step)
    assert (there.patch != start.patch).any()
    x = geometry.exp(start.x, np.einsum("nij,nj->ni", geometry.frame(start.x), step))
    expected = surface.basis.values(Points(start.patch, geometry.settle(x)), surface.coefficients)
    np.testing.assert_allclose(surface.basis.values(there, surface.coefficients), expected, atol=1e-10)


def test_only_those_that_come_nearer_round_about_begin_anew() -> None:
    """From the foot on a sphere no place about it is nearer to a point outside; from the point opposite all are."""
    surface = fitted("round sphere").surface
    feet = places(fitted("round sphere"), 40)
    values = surface.basis.values(feet, surface.coefficients)
    centre = surface.basis.values(places(fitted("round sphere"), 2000, seed=1), surface.coefficients).mean(axis=0)
    outside = centre + 1.5 * (values - centre)
    search = _Search(surface.basis, surface.coefficients, feet, outside, 0.05)
    search.descend(np.arange(40), 8)
    assert search.elsewhere(np.arange(0, 40, 2)).tolist() == []
    beyond = _Search(surface.basis, surface.coefficients, feet, centre - 1.5 * (values - centre), 0.05)
    assert beyond.elsewhere(np.arange(0, 40, 2)).tolist() == list(range(0, 40, 2))
