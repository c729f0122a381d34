import mpmath
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from reference_geometries import GEOMETRIES, exact_distance, exact_point, random_points

from orbiframe import GeometryError

S2, E2, H2 = GEOMETRIES
each_geometry = pytest.mark.parametrize("geometry", GEOMETRIES, ids=lambda g: g.name)
angles = st.floats(-np.pi, np.pi)
radii = st.floats(0, 3)


def points(geometry):
    return st.builds(geometry.from_polar, radii, angles)


# ---- accuracy against fifty digits --------------------------------------------------------------------------------


@each_geometry
@pytest.mark.parametrize("reach", [0.5, 3.0])
@pytest.mark.parametrize("apart", [1e-12, 1e-8, 1e-4, 0.1, 1.0])
def test_distance_and_versine_are_accurate(geometry, reach, apart):
    rng = np.random.default_rng(5)
    x = geometry.from_polar(rng.uniform(0, reach, 20), rng.uniform(-4, 4, 20))
    y = geometry.act(geometry.carry(x), geometry.from_polar(apart * rng.uniform(0.5, 1, 20), rng.uniform(-4, 4, 20)))
    y = geometry.settle(y)
    wanted = [exact_distance(geometry, p, q) for p, q in zip(x, y, strict=True)]
    # The points of S^2 are known by three numbers that are not quite on it; their directions are exact.
    slack = 2e-16 / apart if geometry is S2 else 0.0
    np.testing.assert_allclose(geometry.distance(x, y), np.array(wanted, float), rtol=2e-14 + slack)
    versine = [2 * _exact_sine(geometry, d / 2) ** 2 for d in wanted]
    np.testing.assert_allclose(geometry.versine(x, y), np.array(versine, float), rtol=4e-14 + 2 * slack)


def _exact_sine(geometry, x):
    return {1: mpmath.sin, 0: mpmath.mpf, -1: mpmath.sinh}[geometry.curvature](x)


@pytest.mark.parametrize("apart", [1e-8, 1e-3, 1.0, 9.0])
def test_hyperbolic_distance_far_from_the_origin_loses_one_power_only(apart):
    rng = np.random.default_rng(6)
    x = H2.from_polar(rng.uniform(6, 8, 40), rng.uniform(-4, 4, 40))
    y = H2.exp(x, apart * np.einsum("nij,j->ni", H2.frame(x), [0.6, 0.8]))
    wanted = np.array([exact_distance(H2, p, q) for p, q in zip(x, y, strict=True)], float)
    np.testing.assert_allclose(H2.distance(x, y), wanted, rtol=np.cosh(8) * 2e-16)


def test_the_naive_formulas_would_fail_where_ours_hold():
    x = H2.from_polar(8.0, 0.3)
    y = H2.exp(x, 1e-8 * H2.frame(x)[:, 0])
    form = x[0] * y[0] - x[1] * y[1] - x[2] * y[2]
    wanted = float(exact_distance(H2, x, y))
    assert abs(np.arccosh(max(form, 1.0)) / wanted - 1) > 1e-2
    assert abs(H2.distance(x, y) / wanted - 1) < 1e-12


def test_spherical_distance_at_the_antipode():
    x = S2.from_polar(0.7, 0.2)
    y = S2.exp(-x, 1e-9 * S2.frame(-x)[:, 0])
    assert S2.distance(x, y) == pytest.approx(np.pi - 1e-9, abs=1e-15)
    assert S2.distance(x, -x) == np.pi
    np.testing.assert_allclose(S2.exp(x, S2.log(x, -x)), -x, atol=1e-15)


@each_geometry
def test_triangle_area_is_accurate_for_small_triangles(geometry):
    rng = np.random.default_rng(7)
    x = random_points(geometry, rng, 10)
    corners = [geometry.exp(x, 1e-5 * np.einsum("nij,j->ni", geometry.frame(x), v)) for v in ([1, 0], [0, 1])]
    wanted = [_exact_area(geometry, p, q, r) for p, q, r in zip(x, *corners, strict=True)]
    found = geometry.triangle_area(x, *corners)
    # What is known of the points of S^2 limits the oracle as in the test of distances.
    np.testing.assert_allclose(found, np.array(wanted, float), rtol=1e-10 if geometry is S2 else 1e-13)


def _exact_area(geometry, *corners):
    """Half the determinant in E^2, else the angle defect by the law of cosines, in fifty digits."""
    if geometry.curvature == 0:
        return mpmath.det(mpmath.matrix([exact_point(geometry, p) for p in corners])) / 2
    a, b, c = (exact_distance(geometry, corners[i], corners[i - 1]) for i in range(3))
    cos, sin = (mpmath.cos, mpmath.sin) if geometry.curvature > 0 else (mpmath.cosh, mpmath.sinh)
    sides = ((a, b, c), (b, c, a), (c, a, b))
    angle_sum = sum(
        mpmath.acos(geometry.curvature * (cos(p) - cos(q) * cos(r)) / (sin(q) * sin(r))) for p, q, r in sides
    )
    return geometry.curvature * (angle_sum - mpmath.pi)


def test_areas_known_in_closed_form():
    octant = np.eye(3)
    assert S2.triangle_area(*octant) == pytest.approx(np.pi / 2, rel=1e-15)
    assert S2.triangle_area(octant[1], octant[0], octant[2]) == pytest.approx(-np.pi / 2, rel=1e-15)
    assert E2.triangle_area([1, 0, 0], [1, 3, 0], [1, 0, 4]) == 6.0
    large = H2.from_polar(18.0, 2 * np.pi * np.arange(3) / 3)
    assert H2.triangle_area(*large) == pytest.approx(np.pi, abs=1e-6)
    # Three points almost on a great circle: the triangle is almost a hemisphere.
    assert S2.triangle_area(*S2.from_polar(np.pi / 2 - 1e-9, 2 * np.pi * np.arange(3) / 3)) == pytest.approx(2 * np.pi)


# ---- frames and isometries ----------------------------------------------------------------------------------------


@each_geometry
def test_frame_is_the_frame_of_the_origin_carried_along_the_geodesic(geometry):
    """Parallel transport: the velocity of the geodesic keeps its coordinates, and the turned velocity too."""
    radius, angle = 1.3, np.linspace(-3, 3, 7)
    x = geometry.from_polar(radius, angle)
    velocity = -geometry.log(x, geometry.origin) / radius
    ahead, left = np.stack([np.cos(angle), np.sin(angle)], -1), np.stack([-np.sin(angle), np.cos(angle)], -1)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", geometry.frame(x), ahead), velocity, atol=1e-14)
    turned = np.einsum("nij,nj->ni", geometry.frame(x), left)
    np.testing.assert_allclose(turned, geometry.turn(x, velocity), atol=1e-14)


def test_frames_of_the_sphere_are_orthonormal_and_right_handed_everywhere():
    rng = np.random.default_rng(8)
    x = S2.project(rng.standard_normal((200, 3)))
    x = np.concatenate([x, [[-1, 0, 0], [1, 0, 0], [0, 1, 0], [-1e-300, 0, 1]]])
    carried = S2.carry(x)
    assert S2.isometry_defect(carried).max() < 1e-15 * 4
    np.testing.assert_allclose(np.linalg.det(carried), 1.0, atol=1e-14)


def test_frame_of_the_hyperbolic_plane_is_the_published_one():
    x0, x1, x2 = x = H2.from_polar(1.1, 0.7)
    wanted = [[x1, 1 + x1**2 / (1 + x0), x1 * x2 / (1 + x0)], [x2, x1 * x2 / (1 + x0), 1 + x2**2 / (1 + x0)]]
    np.testing.assert_allclose(H2.frame(x), np.transpose(wanted), rtol=1e-15)


@each_geometry
def test_translation_carries_the_frame(geometry):
    g = geometry.translation(0.9, 0.4)
    np.testing.assert_allclose(g, geometry.carry(geometry.from_polar(0.9, 0.4)), atol=1e-15)
    np.testing.assert_allclose(
        geometry.translation(0.4, 1.1) @ geometry.translation(0.5, 1.1), geometry.translation(0.9, 1.1), atol=1e-14
    )


@settings(max_examples=25, deadline=None)
@given(st.data(), st.sampled_from(GEOMETRIES))
def test_isometries_preserve_versine_area_and_orientation(data, geometry):
    x, y, z = (data.draw(points(geometry)) for _ in range(3))
    g = geometry.translation(data.draw(radii), data.draw(angles)) @ geometry.reflection(data.draw(angles))
    moved = [geometry.act(g, p) for p in (x, y, z)]
    allowed = 1e-13 * np.cosh(6.0) ** 2
    assert geometry.versine(*moved[:2]) == pytest.approx(geometry.versine(x, y), abs=allowed, rel=1e-9)
    turned = geometry.triangle_area(x, y, z) + geometry.triangle_area(*moved)
    assert min(abs(turned), abs(abs(turned) - 4 * np.pi)) < 1e-7


@settings(max_examples=25, deadline=None)
@given(st.data(), st.sampled_from(GEOMETRIES))
def test_triangle_inequality(data, geometry):
    x, y, z = (data.draw(points(geometry)) for _ in range(3))
    assert geometry.distance(x, z) <= geometry.distance(x, y) + geometry.distance(y, z) + 1e-12


@each_geometry
def test_nearest_isometry_repairs_drift_and_keeps_orientation(geometry):
    rng = np.random.default_rng(10)
    g = geometry.translation(rng.uniform(0, 1, 30), 0.3) @ geometry.reflection(rng.uniform(0, 3, 30))
    drifted = g + 1e-7 * rng.standard_normal(g.shape)
    repaired = geometry.nearest_isometry(drifted)
    assert geometry.isometry_defect(repaired).max() < 1e-14 * 30
    assert np.abs(repaired - g).max() < 1e-6
    assert (geometry.parity(repaired) == -1).all()


@pytest.mark.parametrize("length", [1e-6, 0.1, 2.0, 8.0])
def test_nearest_isometry_does_not_harm_accurate_ones(length):
    g = H2.rotation(0.3) @ H2.translation(length, 0.2) @ H2.rotation(1.0) @ H2.reflection(0.4)
    np.testing.assert_allclose(H2.nearest_isometry(g), g, rtol=1e-13, atol=1e-15 * np.cosh(length))


# ---- kinds of motions ---------------------------------------------------------------------------------------------


def _conjugate(geometry, g):
    by = geometry.translation(0.8, 0.5) @ geometry.rotation(0.3)
    return by, by @ g @ geometry.inverse(by)


@each_geometry
@pytest.mark.parametrize("angle", [1e-6, 0.4, -1.2, 2.9, np.pi])
def test_rotations_tell_their_centre_and_angle(geometry, angle):
    by, g = _conjugate(geometry, geometry.rotation(angle))
    motion = geometry.motion(g, 1e-12)
    assert motion.kind == "rotation"
    # On the sphere the rotation by -a about -x is the same.
    centre = geometry.act(by, geometry.origin)
    side = np.sign(motion.point @ centre) if geometry is S2 else 1.0
    assert abs(np.cos(motion.angle) - np.cos(angle)) + abs(np.sin(side * motion.angle) - np.sin(angle)) < 1e-9
    np.testing.assert_allclose(side * motion.point, centre, atol=1e-8)


@pytest.mark.parametrize("geometry", [E2, H2], ids=lambda g: g.name)
@pytest.mark.parametrize("length", [1e-6, 0.5, 3.0])
@pytest.mark.parametrize("kind", ["translation", "glide"])
def test_translations_and_glides_tell_their_length_and_axis(geometry, length, kind):
    by, g = _conjugate(geometry, getattr(geometry, kind)(length, 0.6))
    motion = geometry.motion(g, 1e-12)
    assert motion.kind == kind
    assert motion.length == pytest.approx(length, rel=1e-8)
    assert abs(motion.line @ geometry.act(by, geometry.from_polar(0.9, 0.6))) < (1e-9 if geometry is H2 else 1.0)


@each_geometry
def test_reflections_tell_their_mirror(geometry):
    by, g = _conjugate(geometry, geometry.reflection(0.6))
    motion = geometry.motion(g)
    assert motion.kind == "reflection"
    assert np.abs(geometry.act(by, geometry.from_polar([0.0, 0.9], 0.6)) @ motion.line).max() < 1e-14


def test_the_special_motions():
    assert [geometry.classify(np.eye(3)) for geometry in GEOMETRIES] == ["identity"] * 3
    _, g = _conjugate(H2, H2.parabolic(0.7, 1.1))
    motion = H2.motion(g)
    assert motion.kind == "parabolic"
    np.testing.assert_allclose(g @ motion.point, motion.point, atol=1e-12)
    assert H2.isometry_defect(g) < 1e-13
    assert S2.motion(-np.eye(3)).kind == "rotary reflection"
    assert S2.motion(-np.eye(3)).angle == np.pi
    _, g = _conjugate(S2, S2.rotation(0.5) @ np.diag([-1.0, 1.0, 1.0]))
    motion = S2.motion(g)
    assert motion.kind == "rotary reflection"
    assert abs(motion.angle) == pytest.approx(0.5)
    np.testing.assert_allclose(g @ motion.point, -motion.point, atol=1e-14)


def test_parabolic_moves_along_the_horocycle():
    g = H2.parabolic(1.0, 0.0)
    assert np.linalg.matrix_power(g, 3) == pytest.approx(H2.parabolic(3.0, 0.0))
    # Points of a horocycle at horocyclic distance s are at distance 2 asinh(s / 2).
    assert H2.distance(H2.origin, g[:, 0]) == pytest.approx(2 * np.arcsinh(0.5))
    with pytest.raises(GeometryError, match="ideal points"):
        S2.parabolic(1.0)


# ---- charts -------------------------------------------------------------------------------------------------------


@each_geometry
@pytest.mark.parametrize("model", ["projective", "conformal"])
def test_charts_come_back(geometry, model):
    x = random_points(geometry, np.random.default_rng(11), 30)
    np.testing.assert_allclose(geometry.from_chart(model, geometry.to_chart(model, x)), x, atol=1e-13)


@each_geometry
def test_radii_in_the_charts(geometry):
    tangent = {1: np.tan, 0: np.asarray, -1: np.tanh}[geometry.curvature]
    x = geometry.from_polar(1.2, 0.0)
    assert geometry.to_chart("projective", x)[0] == pytest.approx(tangent(1.2))
    assert geometry.to_chart("conformal", x)[0] == pytest.approx(tangent(0.6) if geometry.curvature else 1.2)


@each_geometry
def test_geodesics_are_straight_in_the_projective_model_and_angles_true_in_the_conformal_one(geometry):
    x, y, z = random_points(geometry, np.random.default_rng(12), 3)
    a, b, c = geometry.to_chart("projective", geometry.geodesic(x, y, np.array([0.0, 0.3, 1.0])))
    assert np.linalg.det(np.stack([b - a, c - a])) == pytest.approx(0.0, abs=1e-13)
    steps = np.stack([geometry.geodesic(x, end, 1e-6) for end in (y, z)])
    u, v = geometry.to_chart("conformal", steps) - geometry.to_chart("conformal", x)
    drawn = np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v)
    assert drawn == pytest.approx(float(geometry.angle(x, y, z)), abs=1e-5)


# ---- refusals -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("geometry", "vector", "words"),
    [
        (S2, [0.0, 0.0, 0.0], "other than zero"),
        (S2, [np.nan, 0.0, 1.0], "other than zero"),
        (E2, [0.0, 1.0, 1.0], "x0 > 0"),
        (H2, [1.0, 1.0, 1.0], r"x0 > \|"),
        (H2, [-2.0, 0.0, 0.0], r"x0 > \|"),
    ],
)
def test_vectors_that_are_no_points_are_named(geometry, vector, words):
    with pytest.raises(GeometryError, match=f"vector 1 .*{words}"):
        geometry.project([[1.0, 0.0, 0.0], vector])


def test_charts_refuse_what_they_do_not_show():
    with pytest.raises(GeometryError, match="point 1 has radius 1"):
        H2.from_chart("conformal", [[0.0, 0.5], [0.0, 1.0]])
    with pytest.raises(GeometryError, match="projective and conformal"):
        H2.to_chart("mercator", H2.origin)
