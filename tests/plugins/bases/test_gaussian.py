"""The Gaussian basis: profile, centres, widths, coverage."""

from __future__ import annotations

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
import reference_surfaces as surfaces
from orbiframe_bases.gaussian import Gaussian

from orbiframe import FitError, Points, Triangulation, UsageError

NAMES = list(surfaces.ALL)


def gaussian(triangulation: Triangulation, **options: float) -> Gaussian:
    return Gaussian(triangulation.orbifold, triangulation, **{"size": 40, **options})


def test_profile_is_the_gaussian_times_the_bump() -> None:
    """exp(-2 c / s^2) exp(1 - 1/(1 - c / c_max)) with c_max = (reach s)^2 / 2, and its derivatives, by mpmath."""
    basis = gaussian(surfaces.triangulated("torus"), reach=2.6)

    def exact(t: float) -> mpmath.mpf:
        return mpmath.exp(-(mpmath.mpf(2.6) ** 2) * t) * mpmath.exp(1 - 1 / (1 - t))

    t = np.array([0.0, 0.1, 0.4, 0.8, 0.99])
    with mpmath.workdps(40):
        expected = [[float(mpmath.diff(exact, v, order)) for v in t] for order in range(4)]
    np.testing.assert_allclose(basis.profile(t), expected, rtol=1e-12)


def test_profile_vanishes_smoothly_where_it_ends() -> None:
    basis = gaussian(surfaces.triangulated("torus"))
    assert basis.smoothness == math.inf
    at_the_end = basis.profile(np.array([1 - 2e-3, 1 - 1e-16, 1.0, 1.5, 1e300]))
    assert np.abs(at_the_end).max() < 1e-190
    assert np.isfinite(at_the_end).all()


@pytest.mark.parametrize("name", NAMES)
def test_supports_follow_the_area_that_a_function_answers_for(name: str) -> None:
    """The discs of versine c have area 2 pi c; with reach r and width w they cover the surface pi (r w)^2 times."""
    triangulation = surfaces.triangulated(name, 4)
    basis = gaussian(triangulation, size=100, width=1.0, reach=2.0)
    covered = 2 * np.pi * basis.support.sum() / triangulation.orbifold.area
    assert covered == pytest.approx(4 * np.pi, rel=0.15)


@pytest.mark.parametrize("size", [1, 7, 60])
@pytest.mark.parametrize("name", NAMES)
def test_every_point_of_every_triangle_is_covered(name: str, size: int) -> None:
    """Even by functions so narrow that only the guarantee keeps them together."""
    triangulation = surfaces.triangulated(name, 2)
    size = min(size, len(triangulation.points))
    basis = gaussian(triangulation, size=size, width=0.05)
    rng = np.random.default_rng(0)
    faces = rng.integers(triangulation.polyhedron.face_count, size=3000)
    points = triangulation.locate(faces, rng.dirichlet([0.5, 0.5, 0.5], 3000))
    values = basis.design_matrix(points)
    np.testing.assert_allclose(values.sum(axis=1), 1, atol=1e-13)


@pytest.mark.parametrize("name", NAMES)
def test_all_vertices_may_be_centres(name: str) -> None:
    triangulation = surfaces.triangulated(name, 2)
    size = len(triangulation.points)
    basis = gaussian(triangulation, size=size)
    np.testing.assert_array_equal(np.unique(basis.centres.x, axis=0), np.unique(triangulation.points, axis=0))
    with pytest.raises(FitError, match=f"{size}"):
        gaussian(triangulation, size=size + 1)


@pytest.mark.parametrize("name", NAMES)
def test_frames_do_not_matter(name: str) -> None:
    """The same map with its vertices in two frames; irregular, so that no two distances are equal."""
    one = shaken(surfaces.triangulated(name))
    mesh = one.polyhedron
    two = surfaces.in_two_frames(one)
    faces, corner = np.arange(mesh.face_count), np.tile([0.5, 0.3, 0.2], (mesh.face_count, 1))
    here, there = (gaussian(t).design_matrix(t.locate(faces, corner)).toarray() for t in (one, two))
    np.testing.assert_allclose(here, there, atol=1e-11)


def shaken(triangulation: Triangulation) -> Triangulation:
    """The same connectivity with vertices moved a little, in space and in X."""
    mesh, geometry, rng = triangulation.polyhedron, triangulation.orbifold.geometry, np.random.default_rng(4)
    tangent = rng.normal(scale=1e-3, size=(len(mesh.vertices), 2))
    step = np.einsum("nij,nj->ni", geometry.frame(triangulation.points), tangent)
    moved = mesh.with_vertices(mesh.vertices + rng.normal(scale=0.02, size=mesh.vertices.shape))
    return replace(triangulation, polyhedron=moved, points=geometry.exp(triangulation.points, step))


def test_functions_are_as_narrow_as_a_squeezed_part_of_the_map() -> None:
    """A torus whose map to X squeezes one half by a million: the functions there are as much narrower."""
    triangulation = surfaces.triangulated("torus", 4)
    basis = gaussian(squeezed(triangulation, 1e-6), size=200)
    assert basis.support.min() < 1e-6 * basis.support.max()
    points = Points(np.zeros(400, dtype=int), np.repeat(basis.centres.x, 2, axis=0))
    values = basis.design_matrix(points)
    np.testing.assert_allclose(values.sum(axis=1), 1, atol=1e-13)
    assert np.diff(values.indptr).max() < 150


def squeezed(triangulation: Triangulation, factor: float) -> Triangulation:
    """The map followed by one of the square to itself that contracts a disc about the middle."""
    plane = triangulation.points[:, 1:] - np.round(triangulation.points[:, 1:])
    radius = np.linalg.norm(plane, axis=1, keepdims=True)
    share = np.clip((radius - 0.1) / 0.35, 0, 1)
    moved = plane * factor ** (1 - share)
    shift = triangulation.points[:, 1:] - plane
    points = np.concatenate([np.ones_like(radius), moved + shift], axis=1)
    return replace(triangulation, points=points)


@pytest.mark.parametrize("option", ["size", "width", "reach"])
def test_options_out_of_range(option: str) -> None:
    with pytest.raises(UsageError, match=option):
        gaussian(surfaces.triangulated("torus"), **{option: 0})


def test_the_same_input_gives_the_same_basis() -> None:
    first, again = (gaussian(surfaces.triangulated("octagon")) for _ in range(2))
    np.testing.assert_array_equal(first.support, again.support)
    np.testing.assert_array_equal(first.centres.x, again.centres.x)
