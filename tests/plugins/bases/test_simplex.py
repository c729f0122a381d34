"""Homogeneous simplex splines: the recursion, and the B-splines that they make on X/H."""

from __future__ import annotations

import numpy as np
import pytest
import spline_checks as checks
from orbiframe_bases.ear_clipping import clip_ears
from orbiframe_bases.simplex import Simplex
from orbiframe_bases.simplex_program import cloud_program, subset_program
from orbiframe_geometries.h2 import H2
from simplex_checks import jump, recursion, reproduction_error, simplex_splines

from orbiframe import FitError, Points, UsageError
from orbiframe.delaunay import delaunay, lloyd, uniform_points
from orbiframe.splines import bernstein_values
from orbiframe.testing import contract_tests
from orbiframe.triangulations import GeodesicTriangulation

NAMES = [name for name in checks.MAKERS if not name.startswith("one-vertex")]

test_laws_of_quadratics = contract_tests("basis", Simplex, params={"size": 80, "degree": 2})
test_laws_of_cubics = contract_tests("basis", Simplex, params={"size": 80, "degree": 3})


def values(knots: np.ndarray, columns: np.ndarray, entries: int = 1) -> np.ndarray:
    """The jets (n, entries) of one simplex spline at points with directions (n, 3, 3)."""
    program = subset_program(len(knots))
    rows, height = program.rows(knots[None])
    out = np.empty((len(columns), 1, entries))
    simplex_splines((program.start, program.child, program.orders, program.outputs), rows[0], height[0], columns, out)
    return out[:, 0]


def framed(x: np.ndarray) -> np.ndarray:
    """Points with two fixed directions, (n, 3, 3)."""
    return np.concatenate(
        [x[:, :, None], np.broadcast_to([[0.3, 0.1], [0.8, -0.5], [0.1, 0.9]], (len(x), 3, 2))], axis=2
    )


def cone(count: int, seed: int = 0) -> np.ndarray:
    """Vectors near (1, 0, 0), of different lengths."""
    rng = np.random.default_rng(seed)
    return np.concatenate([np.ones((count, 1)), rng.uniform(-1, 1, (count, 2))], axis=1) * rng.uniform(
        0.5, 2, (count, 1)
    )


# ---- the recursion --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [3, 4, 5, 6])
def test_the_program_is_the_definition(count: int) -> None:
    knots, x = cone(count), cone(12, 5)
    expected = [recursion(point, knots) for point in x]
    assert max(expected) > 0
    np.testing.assert_allclose(values(knots, framed(x))[:, 0], expected, rtol=1e-11, atol=1e-13)


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_shared_steps_of_clouds_are_the_definition(degree: int) -> None:
    rng = np.random.default_rng(2)
    clouds = np.array([[1, 0, 0], [1, 1, 0], [1, 0, 1]])[:, None] + 0.2 * rng.normal(size=(3, degree + 1, 3)) * [
        0,
        1,
        1,
    ]
    knots = clouds.reshape(-1, 3)
    program = cloud_program(degree)
    rows, height = program.rows(knots[None])
    x = np.concatenate([np.ones((6, 1)), rng.dirichlet(np.ones(3), 6)[:, :2]], axis=1)
    out = np.empty((6, len(program.outputs), 1))
    simplex_splines((program.start, program.child, program.orders, program.outputs), rows[0], height[0], framed(x), out)
    for o, state in enumerate(program.outputs):
        expected = [recursion(point, knots[list(program.states[state])]) for point in x]
        np.testing.assert_allclose(out[:, o, 0], expected, rtol=1e-9, atol=1e-12)


def test_the_steps_are_as_few_as_the_clouds_allow() -> None:
    """Sizes of the programs: degree 2 has 37 steps of which 19 are cones of three knots, degree 3 has 95 and 40."""
    for degree, steps, cones in ((1, 10, 7), (2, 37, 19), (3, 95, 40)):
        orders = cloud_program(degree).orders
        assert (len(orders), int((orders == 0).sum())) == (steps, cones)


def test_repeated_corners_make_bernstein_polynomials() -> None:
    corners = cone(3)
    x = np.random.default_rng(1).dirichlet(np.ones(3), 9) @ corners
    knots = np.repeat(corners, [3, 2, 1], axis=0)
    expected = bernstein_values(3, x @ np.linalg.inv(corners))[:, 1] / abs(np.linalg.det(corners))
    np.testing.assert_allclose(values(knots, framed(x))[:, 0], expected, rtol=1e-11)


def test_forty_orders_of_the_knots_give_one_value_and_signed_determinants_many() -> None:
    """The paper divides by the determinant; its sign makes the result depend on the order."""
    knots, rng = cone(5, 3), np.random.default_rng(0)
    x = knots.mean(axis=0)
    orders = [rng.permutation(5) for _ in range(40)]
    ours = [values(knots[order], framed(x[None]))[0, 0] for order in orders]
    assert np.ptp(ours) < 1e-12 * ours[0]
    assert ours[0] == pytest.approx(recursion(x, knots))
    signed = [recursion(x, knots[order], absolute=False) for order in orders]
    assert len(np.unique(np.round(signed, 9))) > 5


def test_isometries_that_reverse_orientation_change_nothing() -> None:
    knots, x = cone(6), cone(10, 4)
    mirror = H2().glide(0.7, 0.4)
    np.testing.assert_allclose(
        values(knots @ mirror.T, framed(x @ mirror.T))[:, 0], values(knots, framed(x))[:, 0], rtol=1e-11, atol=1e-14
    )


def test_knots_in_no_half_space_have_no_simplex_spline() -> None:
    """Four vectors with sum zero: two orders of the recursion disagree, so no function has such knots."""
    knots = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [-1, -1, -1]])
    x = np.array([0.3, 0.5, 0.4])
    assert abs(recursion(x, knots) - recursion(x, knots[::-1])) > 0.1
    octahedron = checks.sphere()
    with pytest.raises(FitError, match="size"):
        Simplex(octahedron.orbifold, octahedron, degree=3)


@pytest.mark.parametrize(("degree", "seed"), [(2, 25), (2, 36), (3, 9), (3, 13)])
def test_knots_need_no_half_space_about_their_mean(degree: int, seed: int) -> None:
    """Twelve sites on the sphere: some knots lie behind the mean of their spline, and all in some half-space."""
    octahedron = checks.sphere()
    domain = lloyd(delaunay(octahedron, uniform_points(octahedron, 12, seed)).triangulation, 3)
    basis = Simplex(domain.orbifold, domain, degree=degree)
    knots = basis.knot_sets.knots
    assert np.einsum("ei,eki->ek", knots.sum(axis=1), knots).min() < 0
    matrix = basis.design_matrix(_points(domain, 400)).toarray()
    assert matrix.min() >= 0
    np.testing.assert_allclose(matrix @ np.linalg.lstsq(matrix, np.ones(400))[0], 1, atol=1e-11)


@pytest.mark.parametrize("count", [4, 5, 6, 7])
def test_derivatives_are_differences(count: int) -> None:
    """D_u M_B = (m - 3) sum mu_b M_(B - b), to third order, by differences of the jets of one order less."""
    knots, columns, h = cone(count), framed(cone(40, 6)), 1e-6
    jets = values(knots, columns, 10)
    for direction, pairs in ((1, ((0, 1), (1, 3), (2, 4), (3, 6), (4, 7), (5, 8))), (2, ((0, 2), (2, 5), (5, 9)))):
        ahead, back = columns.copy(), columns.copy()
        ahead[:, :, 0] += h * columns[:, :, direction]
        back[:, :, 0] -= h * columns[:, :, direction]
        slope = (values(knots, ahead, 10) - values(knots, back, 10)) / (2 * h)
        for low, high in pairs:
            error = np.abs(slope[:, low] - jets[:, high]).max(initial=0)
            assert error < 1e-5 * (1 + np.abs(jets[:, high]).max()), (low, high)


@pytest.mark.parametrize("count", [4, 5, 6])
def test_m_knots_are_m_minus_4_times_smooth_and_a_double_knot_costs_one(count: int) -> None:
    """Across the plane of two knots; the paper says one derivative more than there is."""
    knots = cone(count, 8)
    assert _continuous_orders(knots, knots[0] + knots[1]) == count - 3
    double = np.concatenate([knots[:-1], knots[:1]])
    assert _continuous_orders(double, double[0] + double[1]) == count - 4


def _continuous_orders(knots: np.ndarray, x: np.ndarray) -> int:
    """How many of M, M', M'', ... are continuous at x across the plane of the first two knots."""
    normal = np.cross(knots[0], knots[1])
    normal /= np.linalg.norm(normal)
    columns = np.stack([np.stack([x + s * 1e-7 * normal, normal, normal], axis=1) for s in (-1.0, 1.0)])
    jets = values(knots, columns, 10)[:, [0, 1, 3, 6]]
    jump = np.abs(jets[1] - jets[0]) > 1e-4 * np.abs(jets).max()
    return int(np.argmax([*jump, True]))


# ---- B-splines on X/H -----------------------------------------------------------------------------------------------


def opposite(basis: Simplex):
    return lambda _, o: [o, *range(3, basis.degree + 2)]


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("name", NAMES)
def test_polynomials_have_their_blossoms_as_coefficients(name: str, degree: int) -> None:
    domain = checks.domain(name).refined()
    basis = Simplex(domain.orbifold, domain, degree=degree)
    # Cubics reach over several triangles of Bolza's surface: rounding of the gluings comes back some 1e4 times.
    assert reproduction_error(basis, opposite(basis), np.random.default_rng(0)) < 1e-8
    assert basis.size <= {1: domain.vertex_count, 2: domain.edge_count}.get(
        degree, 5 * domain.vertex_count - 8 * domain.euler_characteristic
    )


@pytest.mark.parametrize("degree", [2, 3])
@pytest.mark.parametrize("name", ["torus", "Klein bottle", "one-vertex torus"])
def test_functions_are_not_negative_and_add_up_to_one_in_the_plane(name: str, degree: int) -> None:
    domain = checks.domain(name)
    basis = Simplex(domain.orbifold, domain, degree=degree)
    matrix = basis.design_matrix(_points(domain, 300)).toarray()
    assert matrix.min() > -1e-12
    np.testing.assert_allclose(matrix.sum(axis=1), 1, atol=1e-12)
    assert np.linalg.matrix_rank(matrix, tol=1e-8) == basis.size


def _points(domain: GeodesicTriangulation, count: int) -> Points:
    rng = np.random.default_rng(0)
    face = rng.integers(domain.face_count, size=count)
    x = domain.geometry.project(np.einsum("nc,nci->ni", rng.dirichlet(np.ones(3), count), domain.corners[face]))
    return Points(domain.patch[face], np.einsum("nij,nj->ni", domain.placement[face], x))


@pytest.mark.parametrize("name", ["projective plane", "torus", "Klein bottle", "Bolza", "three crosscaps"])
@pytest.mark.parametrize("degree", [2, 3])
def test_derivatives_are_as_continuous_as_claimed_and_no_more(name: str, degree: int) -> None:
    domain = checks.domain(name)
    basis = Simplex(domain.orbifold, domain, degree=degree)
    assert basis.smoothness == degree - 1
    assert jump(basis, degree - 1) < 0.1
    assert jump(basis, degree) > 0.3


def test_three_lifts_of_one_vertex_in_line_cost_a_derivative() -> None:
    domain = checks.domain("one-vertex torus")
    assert Simplex(domain.orbifold, domain, degree=2).smoothness == 0
    assert Simplex(domain.orbifold, domain, degree=3).smoothness == 1


@pytest.mark.parametrize("seed", range(5))
def test_ears_fill_the_polygon(seed: int) -> None:
    """Of star-shaped polygons: areas add up and none turns over; of any polygon the signed areas add up."""
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0, 2 * np.pi, 9)) + np.arange(9) * 1e-3
    points = rng.uniform(0.3, 1, (9, 1)) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    star = np.diff(np.append(angle, angle[0] + 2 * np.pi)).max() < np.pi
    for polygon, simple in ((points, star), (rng.normal(size=(7, 2)), False)):
        t = clip_ears(polygon)
        assert len(t) == len(polygon) - 2
        areas = _areas(polygon[t])
        assert areas.sum() == pytest.approx(_shoelace(polygon))
        assert not simple or (areas > 0).all()


def test_rounding_does_not_choose_among_ears() -> None:
    """All ears of a regular polygon are alike."""
    angle = 2 * np.pi * np.arange(9) / 9
    polygon, rng = np.stack([np.cos(angle), np.sin(angle)], axis=1), np.random.default_rng(0)
    for _ in range(10):
        np.testing.assert_array_equal(clip_ears(polygon + 1e-15 * rng.normal(size=polygon.shape)), clip_ears(polygon))


def _areas(t: np.ndarray) -> np.ndarray:
    return np.linalg.det(t[:, 1:] - t[:, :1]) / 2


def _shoelace(p: np.ndarray) -> float:
    q = np.roll(p, -1, axis=0)
    return float((p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum() / 2)


def test_errors_say_what_to_do() -> None:
    domain = checks.domain("torus")
    with pytest.raises(UsageError, match="dms"):
        Simplex(domain.orbifold, domain, degree=4)
    with pytest.raises(UsageError, match="radius"):
        Simplex(domain.orbifold, domain, radius=0.5)
