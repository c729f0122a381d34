import numpy as np
import pytest
from reference_geometries import GEOMETRIES

from orbiframe import FundamentalPolygon, GeometryError, Word
from orbiframe.groups import regular_polygon
from orbiframe.words import standard_word

S2, E2, H2 = GEOMETRIES


def standard(euler_characteristic, orientable):
    return regular_polygon(H2, standard_word(euler_characteristic, orientable))


@pytest.mark.parametrize(
    ("euler_characteristic", "orientable", "circumradius", "conformal", "inradius", "side", "area"),
    [
        (-2, True, 2.448452447678076, 2**-0.25, 1.528570919480998, 3.057141838961996, 4),
        (-4, True, 3.325771782117242, 0.9306048591020996, 1.9916523910494368, 3.9833047820988736, 8),
        (-6, True, 3.922537413292047, 0.9611865232676157, 2.2979964883730983, 4.595992976746197, 12),
        (-1, False, 1.762747174039086, 2**-0.5, 1.1462158347805889, 2.2924316695611777, 2),
        (-3, False, 2.938703488736371, 0.8994537199739336, 1.7898204100717155, 3.579640820143431, 6),
    ],
)
def test_regular_polygons_in_closed_form(
    euler_characteristic, orientable, circumradius, conformal, inradius, side, area
):
    polygon = standard(euler_characteristic, orientable)
    assert polygon.circumradius == pytest.approx(circumradius, rel=1e-14)
    assert polygon.inradius == pytest.approx(inradius, rel=1e-13)
    np.testing.assert_allclose(polygon.side_lengths, side, rtol=1e-13)
    np.testing.assert_allclose(
        np.linalg.norm(H2.to_chart("conformal", polygon.vertices), axis=1), conformal, rtol=1e-13
    )
    np.testing.assert_allclose(
        np.linalg.norm(H2.to_chart("projective", polygon.vertices), axis=1), np.tanh(circumradius), rtol=1e-13
    )
    np.testing.assert_allclose(polygon.interior_angles, 2 * np.pi / len(polygon.word), rtol=1e-11)
    assert polygon.area == pytest.approx(area * np.pi, rel=1e-12)


@pytest.mark.parametrize("text", ["abAB", "abaB", "aabb"])
def test_the_unit_square(text):
    polygon = regular_polygon(E2, Word.parse(text))
    np.testing.assert_allclose(polygon.vertices[:, 1:], [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    assert polygon.area == pytest.approx(1.0)
    assert polygon.relation_defect < 1e-15 * 4


def test_hexagon_torus_and_klein_quartic_have_two_vertices():
    hexagon = regular_polygon(E2, Word.parse("abcABC"))
    assert hexagon.area == pytest.approx(1.5 * np.sqrt(3))
    assert hexagon.relation_defect < 1e-14
    letters = [0] * 14
    for label, side in enumerate(range(0, 14, 2), start=1):
        letters[side], letters[(side + 5) % 14] = label, -label
    quartic = regular_polygon(H2, Word(tuple(letters)))
    np.testing.assert_allclose(quartic.interior_angles, 2 * np.pi / 7)
    assert quartic.area == pytest.approx(8 * np.pi)
    assert quartic.relation_defect < 1e-9


@pytest.mark.parametrize("text", ["abABcdCD", "abcdABCD", "aabbcc", "abABcc", "abACbC"])
def test_pairings_carry_the_mate_to_the_side_and_the_polygon_across_it(text):
    polygon = regular_polygon(H2, Word.parse(text))
    for side, mate in enumerate(polygon.word.mate):
        h = polygon.pairings[side]
        ends = H2.act(h, np.stack([polygon.vertices[mate], polygon.heads[mate]]))
        wanted = np.stack([polygon.vertices[side], polygon.heads[side]])
        if not polygon.word.reverses(side):
            wanted = wanted[::-1]
        np.testing.assert_allclose(ends, wanted, atol=1e-11)
        assert polygon.sides[side] @ H2.act(h, H2.origin) < -1
    assert np.abs(polygon.length_defects).max() < 1e-13
    assert np.abs(polygon.angle_defects).max() < 1e-12
    assert polygon.relation_defect < 1e-9


def test_relations_lose_precision_like_the_square_of_e_to_the_circumradius():
    """What matrices of size e^R can keep; the reason for atlases of small patches."""
    for genus, largest in [(2, 1e-10), (5, 1e-5), (10, 0.1)]:
        assert standard(2 - 2 * genus, True).relation_defect < largest


def test_conditions_are_defects_that_name_the_place():
    rectangle = E2.from_chart("projective", np.array([[-1, -0.5], [1, -0.5], [1, 0.5], [-1, 0.5]]))
    FundamentalPolygon(E2, rectangle, Word.parse("abaB")).require_conditions()
    wrong = FundamentalPolygon(E2, rectangle, Word.parse("aabb"))
    np.testing.assert_allclose(wrong.length_defects, [1, -1, 1, -1])
    with pytest.raises(GeometryError, match=r"sides 0 and 1 of 'aabb' .* lengths 2 and 1"):
        wrong.require_conditions()
    sharp = FundamentalPolygon(H2, H2.from_polar(3.0, 2 * np.pi * np.arange(8) / 8), Word.parse("abABcdCD"))
    assert sharp.angle_defects[0] < -1
    with pytest.raises(GeometryError, match=r"corners 0, 5, 6, 7, 4, 1, 2, 3 .* need 2 pi"):
        sharp.require_conditions()


@pytest.mark.parametrize("text", ["abABcdCD", "aabbcc"])
def test_angles_are_refused_that_are_wrong_by_a_millionth(text):
    """Regular polygons a little too large or too small: the sides agree, the angles of the one cycle do not."""
    exact = regular_polygon(H2, Word.parse(text))
    directions = 2 * np.pi * np.arange(len(text)) / len(text)
    for change, fits in [(1e-6, False), (-1e-6, False), (1e-11, True)]:
        polygon = FundamentalPolygon(H2, H2.from_polar(exact.circumradius + change, directions), exact.word)
        assert np.abs(polygon.length_defects).max() < 1e-13
        assert 0.1 * abs(change) < abs(polygon.angle_defects[0]) < 20 * abs(change)
        if fits:
            polygon.require_conditions()
        else:
            with pytest.raises(GeometryError, match="need 2 pi"):
                polygon.require_conditions()


def test_sides_are_refused_that_differ_by_a_millionth():
    """In the plane the angles of a quadrangle are right whatever its sides are."""
    for change, fits in [(1e-6, False), (1e-11, True)]:
        corners = E2.from_chart("projective", np.array([[-0.5, -0.5], [0.5 + change, -0.5], [0.5, 0.5], [-0.5, 0.5]]))
        polygon = FundamentalPolygon(E2, corners, Word.parse("abAB"))
        assert np.abs(polygon.length_defects).max() == pytest.approx(change, rel=1e-4)
        if fits:
            polygon.require_conditions()
        else:
            with pytest.raises(GeometryError, match="sides 0 and 2"):
                polygon.require_equal_lengths()


@pytest.mark.parametrize(("width", "height"), [(1, 2), (2, 1), (3, 0.25)])
def test_inradius_is_the_distance_of_the_nearest_side(width, height):
    corners = np.array([[-width, -height], [width, -height], [width, height], [-width, height]]) / 2
    polygon = FundamentalPolygon(E2, E2.from_chart("projective", corners), Word.parse("abAB"))
    assert polygon.inradius == pytest.approx(min(width, height) / 2)
    assert polygon.circumradius == pytest.approx(np.hypot(width, height) / 2)


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        ([[0, 0], [1, 0], [1, 1], [0, 1]], "convex polygon counterclockwise"),
        ([[-1, 1], [1, 1], [1, -1], [-1, -1]], "convex polygon counterclockwise"),
        ([[1, 0], [-1, 1], [-0.2, 0], [-1, -1]], "convex polygon counterclockwise"),
        ([[-1, -1], [1, -1], [0, 1]], "3 vertices for the 4 letters"),
    ],
)
def test_polygons_that_are_not_convex_round_the_origin_are_refused(corners, message):
    with pytest.raises(GeometryError, match=message):
        FundamentalPolygon(E2, E2.from_chart("projective", np.array(corners, float)), Word.parse("abAB"))


@pytest.mark.parametrize(
    ("geometry", "text", "message"),
    [
        (E2, "abABcdCD", "is a genus 2; its geometry is h2, not e2"),
        (H2, "abAB", "is a torus; its geometry is e2, not h2"),
        (S2, "aa", "no convex polygon on the sphere"),
        (H2, "abBAcdCDefEF", "corners"),
    ],
)
def test_regular_polygons_that_do_not_exist_are_refused(geometry, text, message):
    with pytest.raises(GeometryError, match=message):
        regular_polygon(geometry, Word.parse(text))


def test_discs_meet_the_polygon_where_sampled_points_say_so():
    polygon = standard(-2, True)
    rng = np.random.default_rng(3)
    centres = H2.from_polar(rng.uniform(0, 5, 400), rng.uniform(-4, 4, 400))
    on_sides = H2.geodesic(polygon.vertices, polygon.heads, np.linspace(0, 1, 201)[:, None]).reshape(-1, 3)
    distance = H2.distance(centres[:, None], on_sides).min(axis=1)
    distance[(centres @ polygon.sides.T >= 0).all(axis=1)] = 0
    radius = 0.7
    clear = np.abs(distance - radius) > 1e-3
    np.testing.assert_array_equal(polygon.meets_disc(centres, radius)[clear], (distance <= radius)[clear])
