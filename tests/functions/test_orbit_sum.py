"""Orbit sums against brute force over the group, theta functions, mpmath and differences along geodesics."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
import reference_surfaces as surfaces
from hypothesis import given, settings, strategies as st
from third_derivatives import error_of_third_derivatives

from orbiframe.errors import FitError
from orbiframe.functions.lifted_centres import LiftedCentres
from orbiframe.functions.orbit_sum import Pairs, in_blocks
from orbiframe.functions.orbit_sum_basis import OrbitSumBasis
from orbiframe.orbifolds.atlas import Points
from orbiframe.orbifolds.orbifold import Orbifold

NAMES = list(surfaces.ALL)


class Polynomial(OrbitSumBasis):
    """The profile (1 - t)^6, which has five continuous derivatives."""

    smoothness = 5

    def profile(self, t):
        u = np.maximum(1 - t, 0)
        return u**6, -6 * u**5, 30 * u**4, -120 * u**3


class Exponential(OrbitSumBasis):
    """The profile exp(-80 t), as good as zero where it is cut off."""

    smoothness = math.inf

    def profile(self, t):
        f = np.where(t < 1, np.exp(-80 * t), 0)
        return f, -80 * f, 6400 * f, -512000 * f


def blocks_as_dense(pairs: list[Pairs], shape: tuple[int, int]) -> np.ndarray:
    """The sum of 2 - versine / (1 + versine) over all pairs of a point and a centre."""
    dense = np.zeros(shape)
    for block in pairs:
        row = np.repeat(block.rows, np.diff(block.start))
        np.add.at(dense, (row, block.column), 2 - block.versine / (1 + block.versine))
    return dense


def brute_force(orbifold: Orbifold, centres: Points, support: np.ndarray, points: Points) -> np.ndarray:
    """The same sum over all elements of the group far beyond the reach, for an orbifold with one patch."""
    geometry = orbifold.geometry
    radius = geometry.distance(geometry.origin, np.concatenate([centres.x, points.x])).max()
    half = np.sqrt(support.max() / 2)
    reach = {1: np.arcsin, 0: np.asarray, -1: np.arcsinh}[geometry.curvature](half)
    group = orbifold.lifts(0, 2 * radius + 2 * reach)[1]
    images = np.einsum("gij,mj->gmi", group, centres.x)
    c = geometry.versine(points.x[:, None, None], geometry.settle(images)[None])
    return np.where(c < support, 2 - c / (1 + c), 0).sum(axis=1)


@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 10**6), name=st.sampled_from(NAMES), narrow=st.floats(-8, 0))
def test_pairs_are_those_of_brute_force(seed: int, name: str, narrow: float) -> None:
    """Supports from 1 down to 10^(2 narrow), points in clusters about the narrow ones."""
    orbifold, rng = surfaces.ALL[name](), np.random.default_rng(seed)
    geometry = orbifold.geometry
    centres = surfaces.random_points(orbifold, 12, rng)
    support = 10.0 ** rng.uniform(2 * narrow, 0, 12)
    spread = surfaces.random_points(orbifold, 60, rng)
    step = np.sqrt(support[rng.integers(12, size=80)]) * rng.normal(size=80)
    about = centres.x[rng.integers(12, size=80)]
    near = geometry.exp(about, step[:, None] * geometry.frame(about)[:, :, 0])
    points = Points(np.zeros(140, dtype=int), np.concatenate([spread.x, near]))
    found = blocks_as_dense(
        list(in_blocks(LiftedCentres(orbifold, centres, support), points, lambda pairs: pairs)), (140, 12)
    )
    np.testing.assert_allclose(found, brute_force(orbifold, centres, support, points), atol=1e-9)


def test_each_row_lists_its_centres_in_order_and_the_same_twice() -> None:
    orbifold, rng = surfaces.octagon(), np.random.default_rng(3)
    centres, points = (surfaces.random_points(orbifold, n, rng) for n in (30, 500))
    first, again = (
        list(in_blocks(LiftedCentres(orbifold, centres, np.full(30, 1.5)), points, lambda pairs: pairs, slopes=True))
        for _ in range(2)
    )
    for a, b in zip(first, again, strict=True):
        assert all((np.diff(a.column[i:j]) >= 0).all() for i, j in zip(a.start, a.start[1:], strict=False))
        for name in ("rows", "start", "column", "versine", "slope"):
            np.testing.assert_array_equal(getattr(a, name), getattr(b, name))


@pytest.mark.parametrize("name", ["torus", "octagon", "projective_plane"])
def test_work_grows_like_the_number_of_pairs(name: str) -> None:
    orbifold, rng = surfaces.ALL[name](), np.random.default_rng(3)
    centres, points = (surfaces.random_points(orbifold, n, rng) for n in (1000, 20000))
    blocks = list(
        in_blocks(
            LiftedCentres(orbifold, centres, np.full(1000, 4 * orbifold.area / 1000)), points, lambda pairs: pairs
        )
    )
    pairs = sum(len(block.column) for block in blocks)
    assert pairs > 15 * 20000
    assert sum(block.tests for block in blocks) < 6 * pairs


@pytest.mark.parametrize("distance", [1e-12, 1e-6, 0.1, 3.0])
def test_hyperbolic_versines_keep_all_digits(distance: float) -> None:
    orbifold = surfaces.octagon()
    geometry = orbifold.geometry
    x = geometry.from_polar(1.3, 0.4)
    y = geometry.exp(x, distance * geometry.frame(x)[:, 1])
    one = Points(np.zeros(1, dtype=int), y[None])
    block = next(
        in_blocks(
            LiftedCentres(orbifold, one, np.array([50.0])), Points(one.patch, x[None]), lambda pairs: pairs, slopes=True
        )
    )
    with mpmath.workdps(50):
        (a1, a2), (b1, b2) = ([mpmath.mpf(v) for v in p[1:]] for p in (x, y))
        a0, b0 = (mpmath.sqrt(1 + p**2 + q**2) for p, q in ((a1, a2), (b1, b2)))
        exact = a0 * b0 - a1 * b1 - a2 * b2 - 1
    error = np.abs(block.versine / float(exact) - 1)
    this = error.argmin()
    assert error[this] < 1e-13
    # The derivative of cosh d - 1 towards the point is -sinh d along the second vector of the frame.
    np.testing.assert_allclose(block.slope[this], [0, -np.sinh(distance)], rtol=1e-3, atol=2e-4 * distance)


def test_flat_orbit_sums_are_theta_functions() -> None:
    """The sum of exp(-(x - n)^2 / s^2) over the integers is sqrt(pi) s theta_3(pi x, exp(-(pi s)^2))."""
    orbifold, s = surfaces.torus(), np.sqrt(0.2)
    centres = Points(np.zeros(2, dtype=int), np.array([[1, 0, 0], [1, 0.3, -0.2]]))
    x = np.array([[1, 0.1, 0.45], [1, -0.3, 0.2]])
    values = Exponential(orbifold, centres, np.full(2, 40 * s**2)).design_matrix(Points(np.zeros(2, dtype=int), x))

    def theta(t: float) -> float:
        return float(mpmath.jtheta(3, mpmath.pi * t, mpmath.exp(-((mpmath.pi * s) ** 2))))

    sums = np.array([[theta(p[1] - m[1]) * theta(p[2] - m[2]) for m in centres.x] for p in x])
    np.testing.assert_allclose(values.toarray(), sums / sums.sum(axis=1, keepdims=True), rtol=1e-13)


def some_basis(name: str) -> tuple[OrbitSumBasis, Points]:
    orbifold, rng = surfaces.ALL[name](), np.random.default_rng(7)
    centres, points = (surfaces.random_points(orbifold, n, rng) for n in (25, 40))
    return Polynomial(orbifold, centres, rng.uniform(3, 6, 25) * orbifold.area / 25), points


@pytest.mark.parametrize("name", NAMES)
def test_jets_are_differences_along_geodesics(name: str) -> None:
    basis, points = some_basis(name)
    geometry, h = basis.orbifold.geometry, 1e-3
    value, d1, d2, d11, d12, d22 = (m.toarray() for m in basis.jet_matrices(points, 2))
    frame = geometry.frame(points.x)

    def along(a: float, b: float) -> np.ndarray:
        moved = geometry.exp(points.x, a * frame[:, :, 0] + b * frame[:, :, 1])
        return basis.design_matrix(Points(points.patch, moved)).toarray()

    def second(a: float, b: float) -> np.ndarray:
        near = along(a * h, b * h) + along(-a * h, -b * h) - 2 * value
        far = along(2 * a * h, 2 * b * h) + along(-2 * a * h, -2 * b * h) - 2 * value
        return (16 * near - far) / (12 * h * h)

    def first(a: float, b: float) -> np.ndarray:
        near, far = (along(k * a * h, k * b * h) - along(-k * a * h, -k * b * h) for k in (1, 2))
        return (8 * near - far) / (12 * h)

    size1, size2 = np.abs(d1).max(), np.abs(d11).max()
    np.testing.assert_allclose(first(1, 0), d1, atol=1e-6 * size1)
    np.testing.assert_allclose(first(0, 1), d2, atol=1e-6 * size1)
    np.testing.assert_allclose(second(1, 0), d11, atol=1e-5 * size2)
    np.testing.assert_allclose(second(0, 1), d22, atol=1e-5 * size2)
    np.testing.assert_allclose((second(1, 1) - second(1, -1)) / 4, d12, atol=1e-5 * size2)


@pytest.mark.parametrize("name", NAMES)
def test_third_derivatives_are_differences_of_the_hessian(name: str) -> None:
    basis, points = some_basis(name)
    assert error_of_third_derivatives(basis, points, 1e-3).max() < 1e-5


def test_third_derivatives_of_theta_functions() -> None:
    """d^3/dx^3, d^3/dx^2 dy, ... of products of theta functions over their sum, by mpmath."""
    orbifold, s = surfaces.torus(), np.sqrt(0.2)
    centres = Points(np.zeros(2, dtype=int), np.array([[1, 0, 0], [1, 0.3, -0.2]]))
    x, y = 0.1, 0.45
    basis = Exponential(orbifold, centres, np.full(2, 40 * s**2))
    found = basis.jet_matrices(Points(np.zeros(1, dtype=int), np.array([[1, x, y]])), 3)

    def theta(t: mpmath.mpf) -> mpmath.mpf:
        return mpmath.jtheta(3, mpmath.pi * t, mpmath.exp(-((mpmath.pi * s) ** 2)))

    def share(a: mpmath.mpf, b: mpmath.mpf) -> mpmath.mpf:
        sums = [theta(a - m[1]) * theta(b - m[2]) for m in centres.x]
        return sums[0] / sum(sums)

    with mpmath.workdps(30):
        exact = [float(mpmath.diff(share, (x, y), order)) for order in ((3, 0), (2, 1), (1, 2), (2, 1), (1, 2), (0, 3))]
    np.testing.assert_allclose([m.toarray()[0, 0] for m in found[6:]], exact, rtol=1e-8, atol=1e-8)


def test_a_profile_without_a_third_derivative_has_jets_of_order_two() -> None:
    class Short(Polynomial):
        def profile(self, t):
            return super().profile(t)[:3]

    full, points = some_basis("octagon")
    short = Short(full.orbifold, full.centres, full.support)
    for a, b in zip(short.jet_matrices(points, 2), full.jet_matrices(points, 2), strict=True):
        np.testing.assert_array_equal(a.toarray(), b.toarray())
    with pytest.raises(FitError, match="Short"):
        short.jet_matrices(points, 3)


@pytest.mark.parametrize("name", NAMES)
def test_functions_add_up_to_one_and_their_derivatives_to_nothing(name: str) -> None:
    basis, points = some_basis(name)
    total, *rest = (m.sum(axis=1) for m in basis.jet_matrices(points, 3))
    np.testing.assert_allclose(total, 1, atol=1e-14)
    assert max(np.abs(part).max() for part in rest) < 1e-10


@pytest.mark.parametrize("name", NAMES)
def test_patches_do_not_matter(name: str) -> None:
    """The same centres and points, some of them in the frame of another patch."""
    basis, points = some_basis(name)
    geometry = basis.orbifold.geometry
    change = geometry.translation(0.4, 0.7) @ geometry.reflection(1.0)
    two = surfaces.in_two_patches(basis.orbifold, change)

    def split(p: Points) -> Points:
        patch = np.arange(len(p.patch)) % 2
        moved = geometry.act(geometry.inverse(change), p.x)
        return Points(patch, np.where(patch[:, None] == 1, moved, p.x))

    other = Polynomial(two, split(basis.centres), basis.support).design_matrix(split(points))
    np.testing.assert_allclose(other.toarray(), basis.design_matrix(points).toarray(), atol=1e-12)


@pytest.mark.parametrize("name", ["projective_plane", "torus", "klein_bottle", "octagon"])
def test_functions_are_invariant_under_the_group(name: str) -> None:
    basis, points = some_basis(name)
    geometry, group = basis.orbifold.geometry, basis.orbifold.atlas.isometry
    here = basis.design_matrix(points).toarray()
    for g in group[1:]:
        moved = Points(points.patch, geometry.settle(geometry.act(g, points.x)))
        np.testing.assert_allclose(basis.design_matrix(moved).toarray(), here, atol=1e-12)


def test_an_uncovered_point_is_named() -> None:
    centres = Points(np.zeros(1, dtype=int), np.array([[1.0, 0, 0]]))
    basis = Polynomial(surfaces.torus(), centres, np.array([0.01]))
    with pytest.raises(FitError, match="point 1 "):
        basis.design_matrix(Points(np.zeros(2, dtype=int), np.array([[1, 0.01, 0], [1, 0.5, 0.5]])))


def test_no_points_give_an_empty_matrix() -> None:
    basis, _ = some_basis("torus")
    assert basis.design_matrix(Points(np.zeros(0, dtype=int), np.zeros((0, 3)))).shape == (0, 25)
