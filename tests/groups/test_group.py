import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_groups.finite import FiniteGroup
from orbiframe_groups.lattice import lattice_group
from reference_geometries import GEOMETRIES

from orbiframe import FundamentalPolygon, GeometryError, Word
from orbiframe.groups import PolygonGroup, regular_polygon
from orbiframe.planes import PreciseIsometry
from orbiframe.words import standard_word

S2, E2, H2 = GEOMETRIES


def regular(text, geometry=H2):
    return PolygonGroup(regular_polygon(geometry, Word.parse(text)))


OCTAGON = [(0.0, 1), (3.057142, 8), (4.218425, 16), (4.741097, 16), (4.896905, 8)]
CROSSCAPS = [(0.0, 1), (2.292432, 6), (3.256614, 12), (3.525494, 6), (4.303882, 12), (4.584863, 6), (4.663350, 12)]


@pytest.mark.parametrize(
    ("text", "count", "shells"),
    [("abABcdCD", 49, OCTAGON), ("abcdABCD", 49, OCTAGON), ("aabbcc", 103, [*CROSSCAPS, (5.036910, 24)])],
)
def test_tiles_by_distance_of_their_centres(text, count, shells):
    distance = H2.distance(H2.origin, regular(text).tiles(5.2)[..., 0])
    assert (distance <= 5.2).sum() == count
    assert (np.diff(distance) >= -1e-9).all()
    for centre, multiplicity in shells:
        assert (np.abs(distance - centre) < 1e-6).sum() == multiplicity


@pytest.mark.parametrize(("text", "count"), [("aabbcc", 25), ("abABcdCD", 49), ("abABcdCDefEF", 121)])
def test_tiles_that_touch_the_polygon(text, count):
    """1 + l (l - 2) tiles of {l, l} have a vertex with F in common, by counting shared vertices."""
    group = regular(text)
    tiles = group.tiles(group.polygon.circumradius)
    corners = H2.act(tiles[:, None], group.polygon.vertices)
    shared = H2.distance(corners[:, :, None], group.polygon.vertices) < 1e-4
    assert shared.any(axis=(1, 2)).sum() == count == 1 + len(group.word) * (len(group.word) - 2)


def test_tiles_of_the_unit_square_torus_against_the_lattice():
    group = regular("abAB", E2)
    radius = 4.3
    grid = np.stack(np.meshgrid(np.arange(-6, 7), np.arange(-6, 7)), axis=-1).reshape(-1, 2)
    wanted = grid[np.hypot(*np.maximum(np.abs(grid) - 0.5, 0).T) <= radius]
    found = group.tiles(radius)[:, 1:, 0]
    assert sorted(map(tuple, np.rint(found).astype(int))) == sorted(map(tuple, wanted))


def test_area_of_the_tiles_grows_like_the_disc():
    group = regular("abcdABCD")
    radius = 5.0
    outer, inner = (2 * np.pi * (np.cosh(r) - 1) for r in (radius + 2 * group.polygon.circumradius, radius))
    assert inner < len(group.tiles(radius)) * group.area < outer


def test_the_systoles_of_the_two_octagons():
    """Shortest closed geodesics [Strohmaier and Uski 2013 for Bolza]."""
    for text, systoles in [
        ("abcdABCD", [2 * np.arccosh(1 + np.sqrt(2)), 4.896904895, 5.828070775]),
        ("abABcdCD", [2 * np.arccosh(1 + np.sqrt(0.5)), 3.057141839, 3.797845915]),
    ]:
        group = regular(text)
        # A geodesic of length l passes within the circumradius of the origin: its element moves it by l + 2R at most.
        traces = np.trace(group.tiles(4.6)[1:], axis1=-2, axis2=-1)
        lengths = np.unique(np.round(np.arccosh((traces - 1) / 2), 6))
        np.testing.assert_allclose(lengths[:2], systoles[:2], atol=2e-6)
        assert np.abs(lengths - systoles[2]).min() < 2e-6


def test_homology_of_the_surfaces():
    """The abelianised relation: zero for Z^2g, twice a primitive vector for Z^(g-1) + Z/2."""
    for chi, orientable, wanted in [(-2, True, 0), (-4, True, 0), (-1, False, 2), (-3, False, 2)]:
        word = standard_word(chi, orientable)
        (relation,) = word.letter_relations
        sums = [sum(np.sign(k) for k in relation if abs(k) == label) for label in range(1, len(word) // 2 + 1)]
        assert {abs(s) for s in sums} == {wanted}


@settings(max_examples=20, deadline=None)
@given(st.floats(0, 7), st.floats(-np.pi, np.pi), st.sampled_from(["abABcdCD", "aabbcc", "abcdABCD"]))
def test_reduction_brings_every_point_home(radius, angle, text):
    group = regular(text)
    x = H2.from_polar(radius, angle)
    y, g = group.reduce(x)
    assert (group.polygon.sides @ y).min() >= -1e-9
    np.testing.assert_allclose(H2.act(g, x), y, atol=1e-13 * np.cosh(radius) ** 2 + 1e-12)


def test_reduction_keeps_shapes_and_leaves_points_of_the_polygon_alone():
    group = regular("abABcdCD")
    x = H2.from_polar(np.array([[0.0, 0.5], [1.0, 1.5]]), 0.3)
    y, g = group.reduce(x)
    assert (y.shape, g.shape) == ((2, 2, 3), (2, 2, 3, 3))
    np.testing.assert_allclose(y, x, rtol=1e-15)
    np.testing.assert_array_equal(g, np.broadcast_to(np.eye(3), g.shape))
    assert group.reduce(H2.origin)[1].shape == (3, 3)


def test_points_that_cannot_be_reduced_are_named():
    with pytest.raises(GeometryError, match="point 1"):
        regular("abABcdCD").reduce([[1.0, 0.0, 0.0], [1.0, np.nan, 0.0]])


@pytest.mark.parametrize("text", ["abABcdCD", "aabbcc"])
def test_far_points_come_home_to_the_digits_that_they_have(text):
    """x = g y for long words g, in long double: reduce finds y again up to some eps e^d."""
    group, rng = regular(text), np.random.default_rng(3)
    letters = [*range(1, len(text) // 2 + 1), *range(-1, -len(text) // 2 - 1, -1)]
    for length in (3, 6, 9):
        y = H2.from_polar(rng.uniform(0, 1, 30), rng.uniform(0, 6, 30))
        for here in y:
            g = group.precise_element(tuple(rng.choice(letters, length)))
            x = (g @ PreciseIsometry.translation(-1, here)).place
            if x[0] < 1e9:
                assert H2.distance(group.reduce(x)[0], here) < 1e-14 * x[0] + 1e-13


def test_points_whose_digits_are_lost_are_refused():
    x = H2.from_polar(np.array([1.0, 24.0]), 0.3)
    with pytest.raises(GeometryError, match="point 1"):
        regular("abABcdCD").reduce(x)


def test_elements_of_words():
    group = regular("abABcdCD")
    a, b = group.element("a"), group.element("b")
    np.testing.assert_allclose(group.element("aB"), a @ H2.inverse(b), atol=1e-10)
    np.testing.assert_array_equal(group.element(""), np.eye(3))
    with pytest.raises(GeometryError, match="letter 5 is no generator"):
        group.element("ae")


def test_atlas_of_a_polygon_is_one_patch():
    group = regular("aabbcc")
    atlas = group.atlas()
    assert atlas.patch_count == 1
    assert atlas.radius[0] == group.polygon.circumradius
    assert atlas.tail.tolist() == atlas.head.tolist() == [-1] + [0] * 6
    np.testing.assert_array_equal(atlas.isometry[1:], group.polygon.pairings)


def test_any_polygon_that_meets_the_conditions_has_a_group():
    """A hexagon torus from an oblique lattice: opposite sides equal, angles of two triples adding up to 2 pi."""
    half = np.array([[-1.0, -0.7], [0.3, -0.9], [1.1, 0.1]])
    polygon = FundamentalPolygon(E2, E2.from_chart("projective", np.concatenate([half, -half])), Word.parse("abcABC"))
    group = PolygonGroup(polygon)
    assert polygon.relation_defect < 1e-14
    assert {E2.classify(g) for g in group.tiles(3.0)} == {"identity", "translation"}
    with pytest.raises(GeometryError, match="need 2 pi"):
        PolygonGroup(FundamentalPolygon(H2, H2.from_polar(2.0, 2 * np.pi * np.arange(8) / 8), Word.parse("abABcdCD")))


def test_klein_bottle_of_the_rectangle():
    """`abaB`: the glide (u, v) -> (-u, v + 1), and the translation by the first side."""
    group = lattice_group(E2, Word.parse("abaB"), first=(2.0, 0.0), second=(0.0, 1.0))
    np.testing.assert_allclose(group.element("a") @ [1, 0.3, 0.0], [1, -0.3, -1.0], atol=1e-15)
    np.testing.assert_allclose(np.abs(group.element("b") @ [1, 0.0, 0.0]), [1, 2.0, 0.0], atol=1e-15)
    assert group.area == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        ("abABcdCD", {}, "is a genus 2 with 8 sides"),
        ("abAB", {"second": (0.0, -1.0)}, "signed area -1"),
        ("aabb", {"second": (0.0, 2.0)}, "sides 0 and 1"),
    ],
)
def test_lattices_that_do_not_exist_are_refused(text, options, message):
    with pytest.raises(GeometryError, match=message):
        lattice_group(E2, Word.parse(text), **options)


def test_sphere_and_projective_plane():
    sphere, plane = (FiniteGroup(S2, Word.parse(text)) for text in ("aA", "aa"))
    x = S2.project(np.random.default_rng(1).standard_normal((50, 3)))
    np.testing.assert_array_equal(sphere.reduce(x)[0], S2.settle(x))
    y, g = plane.reduce(x)
    assert (y[:, 0] >= 0).all()
    np.testing.assert_allclose(S2.act(g, x), y)
    np.testing.assert_allclose(plane.reduce(-x)[0], y)
    np.testing.assert_array_equal(plane.reduce([[0.0, -1.0, 0.5], [0.0, 0.0, -1.0]])[0][:, 1:] >= 0, [[1, 0], [1, 1]])
    assert [len(plane.tiles(r)) for r in (1.0, 2.0)] == [1, 2]
    assert (sphere.area, plane.area) == (4 * np.pi, 2 * np.pi)
    with pytest.raises(GeometryError, match="is a torus"):
        FiniteGroup(S2, Word.parse("abAB"))
