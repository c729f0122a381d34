"""Mistakes in the paper, sections 1 and 2: what is printed is wrong, and what is right holds here."""

import numpy as np
import pytest
from orbiframe_groups.finite import FiniteGroup
from reference_geometries import GEOMETRIES, random_points

from orbiframe import FundamentalPolygon, GeometryError, Word
from orbiframe.groups import PolygonGroup, regular_polygon

S2, E2, H2 = GEOMETRIES
FORM = np.array([1.0, -1.0, -1.0])


@pytest.fixture(scope="module")
def octagon():
    return PolygonGroup(regular_polygon(H2, Word.parse("abABcdCD")))


def test_e01_the_remaining_motions_are_reflections_and_glide_reflections():
    """Section 1.1 (7) makes them a reflection times any motion; each is a reflection or a glide reflection."""
    rng = np.random.default_rng(1)
    motions = [H2.rotation(1.0), H2.translation(0.8, 0.3), H2.parabolic(0.7, 0.4), np.eye(3)]
    for g in motions:
        by = H2.carry(random_points(H2, rng, 1)[0])
        kind = H2.classify(H2.reflection(0.2) @ by @ g @ H2.inverse(by))
        assert kind in ("reflection", "glide")
    assert H2.classify(H2.glide(0.5, 0.3)) == "glide"
    assert E2.classify(E2.glide(0.5, 0.3)) == "glide"


def test_e02_the_angle_of_tangent_vectors_takes_a_minus_sign(octagon):
    """The corner of the octagon has 45 degrees; the formula of section 1.2 as printed says 135."""
    polygon = octagon.polygon
    ahead, back = (H2.log(polygon.vertices[0], polygon.vertices[k]) for k in (1, -1))
    beta = np.sum(ahead * FORM * back)
    size = np.sqrt(np.sum(ahead * FORM * ahead) * np.sum(back * FORM * back))
    assert np.degrees(np.arccos(-beta / size)) == pytest.approx(45.0)
    assert np.degrees(np.arccos(beta / size)) == pytest.approx(135.0)
    assert np.degrees(polygon.interior_angles[0]) == pytest.approx(45.0)


def test_e03_the_map_to_the_conformal_model_adds_the_root():
    """tanh d goes to tanh(d/2) with 1 + sqrt(1 - r^2); with the printed 1 - sqrt the image leaves the disc."""
    d = np.linspace(0.1, 3.0, 10)
    klein = H2.to_chart("projective", H2.from_polar(d, 0.0))[:, 0]
    np.testing.assert_allclose(klein, np.tanh(d))
    root = np.sqrt(1 - klein**2)
    np.testing.assert_allclose(klein / (1 + root), np.tanh(d / 2))
    np.testing.assert_allclose(H2.to_chart("conformal", H2.from_polar(d, 0.0))[:, 0], np.tanh(d / 2))
    assert (klein / (1 - root) > 1).all()


def test_e04_isometries_are_moebius_or_anti_moebius_maps_of_the_conformal_model():
    """z -> (a z + b) / (conj(b) z + conj(a)), with conj(z) in place of z where orientation is reversed."""
    rng = np.random.default_rng(2)
    x = random_points(H2, rng, 12)
    for g, expected in ((H2.translation(0.7, 0.4) @ H2.rotation(1.0), "moebius"), (H2.glide(0.6, 0.9), "anti")):
        z, w = (H2.to_chart("conformal", p) @ [1, 1j] for p in (x, H2.act(g, x)))
        moebius, anti = _same_cross_ratio(z, w), _same_cross_ratio(z.conj(), w)
        assert (moebius, anti) == (expected == "moebius", expected == "anti")


def _same_cross_ratio(z, w):
    def ratio(u):
        return (u[0::4] - u[2::4]) * (u[1::4] - u[3::4]) / ((u[0::4] - u[3::4]) * (u[1::4] - u[2::4]))

    return bool(np.allclose(ratio(z), ratio(w), atol=1e-10))


def test_e05_the_angle_excess_is_the_area_on_curved_planes_only():
    for geometry in GEOMETRIES:
        x, y, z = geometry.from_polar(0.9, np.array([0.1, 2.0, 4.0]))
        excess = sum(float(geometry.angle(*corner)) for corner in ((x, y, z), (y, z, x), (z, x, y))) - np.pi
        area = float(geometry.triangle_area(x, y, z))
        assert excess == pytest.approx(geometry.curvature * area, abs=1e-14)
    x, y, z = [1, 0, 0], [1, 3, 0], [1, 0, 4]
    assert float(E2.triangle_area(x, y, z)) == 6.0
    assert sum(float(E2.angle(*c)) for c in ((x, y, z), (y, z, x), (z, x, y))) == pytest.approx(np.pi)


def test_e06_linear_maps_that_keep_the_euclidean_plane_need_not_be_isometries():
    """diag(1, 2, 2) maps x0 = 1 onto itself; on S^2 and H^2 no such map exists beside the isometries."""
    scaling = np.diag([1.0, 2.0, 2.0])
    x = random_points(E2, np.random.default_rng(3), 5)
    assert E2.point_defect(E2.act(scaling, x)).max() == 0
    assert E2.isometry_defect(scaling) == 3.0
    assert E2.distance(*E2.act(scaling, x[:2])) == pytest.approx(2 * E2.distance(*x[:2]))
    for geometry in (S2, H2):
        assert (
            geometry.point_defect(geometry.act(scaling, random_points(geometry, np.random.default_rng(3), 5))).min() > 0
        )


def test_e07_most_neighbours_of_the_octagon_meet_it_in_a_vertex_only(octagon):
    """F and h(F) have a side, a vertex or nothing in common: 8 sides and 40 single vertices in {8, 8}."""
    polygon = octagon.polygon
    corners = H2.act(octagon.tiles(polygon.circumradius)[1:, None], polygon.vertices)
    shared = (H2.distance(corners[:, :, None], polygon.vertices) < 1e-5).sum(axis=(1, 2))
    assert sorted(shared) == [1] * 40 + [2] * 8


def test_e08_the_pairing_h_s_maps_the_mate_to_the_side(octagon):
    """Of the two conventions of sections 2.2 and 2.5 the one that fits F and h_s F meeting in s."""
    polygon = octagon.polygon
    middles = H2.geodesic(polygon.vertices, polygon.heads, 0.5)
    for side, mate in enumerate(polygon.word.mate):
        h = polygon.pairings[side]
        np.testing.assert_allclose(H2.act(h, middles[mate]), middles[side], atol=1e-12)
        assert H2.distance(H2.act(h, middles[side]), middles[mate]) > 1
        # The centre of h_s F is the mirror image of the origin in s.
        centre = H2.act(h, H2.origin)
        np.testing.assert_allclose(H2.geodesic(H2.origin, centre, 0.5), middles[side], atol=1e-12)


def test_e09_every_group_has_a_fixed_point_of_the_identity_and_the_failure_needs_another(octagon):
    """The identity fixes every point in every group; a singular point needs another h: none here, one in aAbB."""
    kinds = [H2.classify(g, 1e-6) for g in octagon.tiles(4.0)]
    assert kinds.count("identity") == 1
    assert set(kinds) == {"identity", "translation"}
    # The square glued to a sphere: its corners become cone points, and the pairings rotate about two of them.
    cone = FundamentalPolygon(E2, E2.from_polar(1.0, 2 * np.pi * np.arange(4) / 4), Word.parse("aAbB"))
    np.testing.assert_allclose(cone.angle_defects + 2 * np.pi, [np.pi, np.pi / 2, np.pi / 2])
    assert E2.classify(cone.pairings[0]) == "rotation"
    with pytest.raises(GeometryError, match="need 2 pi"):
        PolygonGroup(cone)


def test_e10_the_cycle_relation_has_the_inner_letters_exchanged(octagon):
    """a1 b1' a1' b1 ... = e; the printed a1 b1 a1' b1' ... is off by 2.5e6. Crosscaps are right as printed."""
    assert np.abs(octagon.element("aBAbcDCd") - np.eye(3)).max() < 1e-10
    printed = np.abs(octagon.element("abABcdCD") - np.eye(3)).max()
    assert printed == pytest.approx(2.5e6, rel=0.01)
    crosscaps = PolygonGroup(regular_polygon(H2, Word.parse("aabbcc")))
    assert np.abs(crosscaps.element("aabbcc") - np.eye(3)).max() < 1e-10


def test_e11_the_hemisphere_is_no_convex_polygon_but_a_cell_of_its_own_kind():
    """The square with corners on the equator has straight angles, and its opposite corners have no unique segment."""
    equator = S2.from_polar(np.pi / 2, 2 * np.pi * np.arange(4) / 4)
    with pytest.raises(GeometryError, match="open hemisphere"):
        FundamentalPolygon(S2, equator, Word.parse("abab"))
    for text in ("aa", "abab"):
        group = FiniteGroup(S2, Word.parse(text))
        assert group.area == 2 * np.pi
        assert group.atlas().radius[0] == np.pi / 2


def test_e12_the_sides_of_the_polygon_are_circular_arcs_in_the_conformal_model(octagon):
    """The hull is the hyperbolic one: the middle of a side lies nearer to the centre than that of the chord."""
    polygon = octagon.polygon
    ends = [H2.to_chart("conformal", p) for p in (polygon.vertices[0], polygon.heads[0])]
    middle = H2.to_chart("conformal", H2.geodesic(polygon.vertices[0], polygon.heads[0], 0.5))
    assert np.linalg.norm(middle) < np.linalg.norm(sum(ends) / 2) - 0.1
    # The circle through the ends and the middle is orthogonal to the unit circle: |centre|^2 = 1 + radius^2.
    centre = np.linalg.solve([2 * (ends[0] - middle), 2 * (ends[1] - middle)], [e @ e - middle @ middle for e in ends])
    assert centre @ centre == pytest.approx(1 + np.sum((centre - middle) ** 2))
