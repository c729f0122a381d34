"""Groups with cone points and mirrors, against orders, areas and angles in closed form."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from reference_geometries import GEOMETRIES

from orbiframe import GeometryError, TopologyError
from orbiframe.delaunay import polygon_triangulation
from orbiframe.groups import ConwayGroup, MirroredPolygon, orbifold_group, orbifold_of, orbifold_polygon, stabilizer
from orbiframe.testing import Lab, contract_tests, group_laws
from orbiframe.words import ConwaySymbol, MirrorWord
from orbiframe.words.conway_symbol import PLANE_GROUPS

S2, E2, H2 = GEOMETRIES
GEOMETRY = {1: S2, 0: E2, -1: H2}
FAMILIES = ["1", "*", "x", "22", "*22", "2*", "2x", "55", "*55", "5*", "5x", "225", "*225", "2*5", "222", "*222", "2*2"]
EXCEPTIONS = ["332", "*332", "3*2", "432", "*432", "532", "*532"]
HYPERBOLIC = [
    "*237",
    "237",
    "*245",
    "334",
    "*2223",
    "2*23",
    "222x",
    "*2*",
    "o2",
    "4*3",
    "xxx",
    "oo",
]
ALL = [*FAMILIES, *EXCEPTIONS, *PLANE_GROUPS, *HYPERBOLIC]

# The order of the point group of each plane group, and of a lattice by which its translations are that many cells.
POINT_GROUP = dict(zip(PLANE_GROUPS, (1, 2, 2, 2, 2, 4, 4, 4, 4, 4, 8, 8, 3, 6, 6, 6, 12), strict=True))


def group_of(text):
    signature = ConwaySymbol.parse(text)
    return orbifold_group(GEOMETRY[signature.curvature], signature)


def points(group, count, seed=0):
    """Points within some 1.3 times the radius of the cell."""
    rng = np.random.default_rng(seed)
    radius = min(np.pi, 1.3 * group.atlas().radius[0])
    return group.geometry.from_polar(radius * np.sqrt(rng.random(count)), rng.uniform(-np.pi, np.pi, count))


@pytest.mark.parametrize("text", ALL)
def test_relations_hold(text):
    group = group_of(text)
    for letters, order in group.relations.powers:
        power = np.linalg.matrix_power(group.element(letters), order)
        np.testing.assert_allclose(power, np.eye(3), atol=1e-9)


@pytest.mark.parametrize("text", [*PLANE_GROUPS, *HYPERBOLIC])
def test_the_cell_meets_poincares_conditions_and_folds_to_the_orbifold(text):
    polygon = group_of(text).polygon
    polygon.require_conditions(1e-12)
    assert polygon.signature.canonical == ConwaySymbol.parse(text).canonical
    assert polygon.relation_defect < 1e-9


@pytest.mark.parametrize("text", ["*237", "*245"])
def test_the_defect_of_relations_is_that_of_the_rotations_by_wrong_angles(text):
    """Two mirrors at the angle pi/n + d: n times their product is a rotation by 2 n d about the corner."""
    polygon = group_of(text).polygon
    vertices = H2.project(polygon.vertices * [1, 1 + 1e-6, 1 - 2e-6])
    wrong = replace(polygon, vertices=vertices)
    expected = 0.0
    for cycle, order, defect in zip(wrong.word.cycles, wrong.orders, wrong.angle_defects, strict=True):
        there = H2.carry(vertices[cycle.corners[0]])
        turn = there @ H2.rotation(2 * order * defect) @ H2.inverse(there)
        expected = max(expected, np.abs(turn - np.eye(3)).max())
    assert expected > 1e-6
    assert wrong.relation_defect == pytest.approx(expected, rel=1e-2)


@pytest.mark.parametrize("text", ALL)
def test_area_is_that_of_gauss_and_bonnet(text):
    """In E^2, where any scale is right, the area of the cell is 1."""
    group = group_of(text)
    expected = 2 * np.pi * abs(group.signature.euler_characteristic) or 1.0
    assert group.area == pytest.approx(float(expected), rel=1e-11)


@pytest.mark.parametrize("text", [*FAMILIES, *EXCEPTIONS])
def test_a_finite_group_has_the_order_of_its_symbol(text):
    """The matrices are closed under products, each once, and there are 2 / chi of them."""
    group = group_of(text)
    elements = group.elements
    assert len(elements) == group.signature.order
    products = (elements[:, None] @ elements).reshape(-1, 9)
    gaps = np.linalg.norm(products[:, None] - elements.reshape(-1, 9), axis=-1)
    assert ((gaps < 1e-9).sum(axis=1) == 1).all()


@pytest.mark.parametrize(
    ("text", "census"),
    [
        ("332", {"identity": 1, "rotation": 11}),
        ("*532", {"identity": 1, "rotation": 59, "reflection": 15, "rotary reflection": 45}),
        ("*432", {"identity": 1, "rotation": 23, "reflection": 9, "rotary reflection": 15}),
        ("3*2", {"identity": 1, "rotation": 11, "reflection": 3, "rotary reflection": 9}),
        ("*332", {"identity": 1, "rotation": 11, "reflection": 6, "rotary reflection": 6}),
        ("5x", {"identity": 1, "rotation": 4, "rotary reflection": 5}),
        ("2*5", {"identity": 1, "rotation": 9, "reflection": 5, "rotary reflection": 5}),
    ],
)
def test_kinds_of_elements_are_those_of_the_polyhedral_groups(text, census):
    group = group_of(text)
    assert Counter(S2.classify(g) for g in group.elements) == census


@pytest.mark.parametrize("text", PLANE_GROUPS)
def test_a_plane_group_has_its_point_group_and_lattice(text):
    """Directions of the elements form the point group; translations have a cell of as many times the area of F."""
    group = group_of(text)
    tiles = group.tiles(12.0)
    turns = np.unique(np.round(tiles[:, 1:, 1:], 6) + 0.0, axis=0)
    assert len(turns) == POINT_GROUP[text]
    pure = np.abs(tiles[:, 1:, 1:] - np.eye(2)).max(axis=(1, 2)) < 1e-9
    moves = tiles[pure][:, 1:, 0]
    crosses = np.abs(moves[:, None, 0] * moves[None, :, 1] - moves[:, None, 1] * moves[None, :, 0])
    assert crosses[crosses > 1e-6].min() == pytest.approx(POINT_GROUP[text], rel=1e-9)


@pytest.mark.parametrize("text", ALL)
def test_tiles_cover_a_disc_once(text):
    group = group_of(text)
    x = points(group, 60)
    tiles = group.tiles(float(min(np.pi, 1.3 * group.atlas().radius[0])))
    pulled = group.geometry.act(group.geometry.inverse(tiles)[:, None], x)
    y, _ = group.reduce(pulled)
    inside = group.geometry.distance(y, pulled) < 1e-9
    assert (inside.sum(axis=0) == 1).all()


@pytest.mark.parametrize("text", ALL)
def test_reduction_is_invariant(text):
    group = group_of(text)
    x = points(group, 40, seed=1)
    y, g = group.reduce(x)
    np.testing.assert_allclose(group.geometry.act(g, x), y, atol=1e-9)
    for h in group.tiles(float(min(np.pi, group.atlas().radius[0])))[:12]:
        np.testing.assert_allclose(group.reduce(group.geometry.act(h, x))[0], y, atol=1e-7)


@pytest.mark.parametrize(("text", "order"), [("*237", 84), ("237", 42), ("*245", 40), ("334", 12)])
def test_the_number_of_tiles_in_a_disc_is_the_ratio_of_areas(text, order):
    """Area 4 pi sinh^2(r / 2) over 2 pi / order, and about half a circumference more for tiles that are cut."""
    group, radius = group_of(text), 4.0
    inner, outer = (
        4 * np.pi * np.sinh(r / 2) ** 2 / group.area for r in (radius, radius + 2 * group.polygon.circumradius)
    )
    assert group.area == pytest.approx(2 * np.pi / order, rel=1e-9)
    assert inner < len(group.tiles(radius)) < outer


@pytest.mark.parametrize("text", ["*237", "*632", "*2345", "*2222", "*333"])
def test_a_group_of_reflections_has_the_polygon_of_its_angles(text):
    polygon = group_of(text).polygon
    orders = ConwaySymbol.parse(text).mirrors[0]
    np.testing.assert_allclose(polygon.interior_angles.astype(float), np.pi / np.array(orders), rtol=1e-11)


def test_the_triangle_237_has_its_known_sides():
    """cosh a = (cos A + cos B cos C) / (sin B sin C) by the second law of cosines."""
    polygon = group_of("*237").polygon
    a = np.pi / np.array([2, 3, 7])
    b, c = np.roll(a, 1), np.roll(a, -1)
    expected = np.arccosh((np.cos(a) + np.cos(b) * np.cos(c)) / (np.sin(b) * np.sin(c)))
    # Side k runs from corner k to the next, opposite to the corner before it.
    np.testing.assert_allclose(polygon.side_lengths, np.roll(expected, 1), rtol=1e-10)


@pytest.mark.parametrize("text", [*PLANE_GROUPS, *HYPERBOLIC])
def test_stabilizers_of_the_corners_of_the_cell(text):
    polygon, group = group_of(text).polygon, group_of(text)
    for cycle, order in zip(polygon.word.cycles, polygon.orders, strict=True):
        fixing = stabilizer(group, polygon.vertices[cycle.corners[0]])
        assert len(fixing) == (2 * order if cycle.ends else order)
    for side in polygon.word.mirrors:
        middle = polygon.side_flags[side, :, 0]
        assert len(stabilizer(group, middle)) == 2
    assert len(stabilizer(group, group.geometry.origin)) == 1


@pytest.mark.parametrize(
    ("text", "orders"),
    [("532", {1, 2, 3, 5}), ("*432", {4, 6, 8}), ("*22", {4}), ("77", {7}), ("3*2", {2, 3, 4}), ("2*5", {2, 10})],
)
def test_stabilizers_of_the_corners_of_spherical_cells(text, orders):
    group = group_of(text)
    corners = {len(stabilizer(group, vertex)) for vertex in group.vertices}
    assert corners <= orders
    assert max(orders) in corners


@pytest.mark.parametrize("text", [*FAMILIES, *EXCEPTIONS])
def test_the_sides_of_a_spherical_domain_are_those_of_the_points_without_a_nearer_image(text):
    group = orbifold_group(S2, ConwaySymbol.parse(text))
    x = S2.from_polar(np.arccos(np.linspace(-1, 1, 4000)), 2.399963 * np.arange(4000))
    distance = S2.distance(S2.origin, S2.act(group.elements[:, None], x))
    nearest = distance.argmin(axis=0)
    clear = np.sort(distance, axis=0)[1] - distance.min(axis=0) > 1e-9 if len(distance) > 1 else np.full(4000, True)
    inside = (x @ group.sides.T > 0).all(axis=1)
    assert (inside == (distance.min(axis=0) >= distance[0]))[clear].all()
    assert inside.mean() == pytest.approx(1 / len(group.elements), rel=0.05)
    assert S2.distance(S2.origin, x[inside]).max() <= group.circumradius + 1e-12
    assert S2.distance(S2.origin, x[inside]).max() >= group.circumradius - 0.1
    assert ((nearest == 0) == inside)[clear].all()


def test_a_stabilizer_is_carried_along_with_its_point():
    group = group_of("*237")
    corner = group.polygon.vertices[2]
    g = group.tiles(3.0)[-1]
    there = stabilizer(group, group.geometry.act(g, corner))
    assert len(there) == 14
    np.testing.assert_allclose(H2.distance(H2.act(there, H2.act(g, corner)), H2.act(g, corner)), 0, atol=1e-6)


@st.composite
def symbols(draw):
    orders = st.lists(st.integers(2, 7), max_size=3).map(tuple)
    parts = draw(st.integers(0, 1)), draw(orders), tuple(draw(st.lists(orders, max_size=2))), draw(st.integers(0, 2))
    try:
        return ConwaySymbol(*parts)
    except TopologyError:
        assume(False)


@settings(max_examples=25, deadline=None)
@given(symbols())
def test_every_orbifold_has_a_convex_cell(signature):
    assume(signature.curvature <= 0)
    geometry = GEOMETRY[signature.curvature]
    polygon = orbifold_polygon(geometry, signature)
    polygon.require_conditions(1e-10)
    assert polygon.signature.canonical == signature.canonical
    group = ConwayGroup(polygon)
    x = geometry.from_polar(np.linspace(0.1, 1, 9), np.arange(9.0))
    moved = geometry.act(polygon.pairings[:, None], x)
    expected = np.broadcast_to(group.reduce(x)[0], moved.shape)
    np.testing.assert_allclose(group.reduce(moved)[0], expected, atol=1e-4)


def test_distances_on_the_orbifold_are_seen_by_its_copies():
    """The copies of the one patch of *237 are the tiles, each once, though mirrors meet in every corner."""
    group = group_of("*237")
    copies = orbifold_of(group).lifts(0, 2.0)[1]
    centres = group.tiles(2.6)[:, :, 0]
    assert len(copies) == (H2.distance(H2.origin, centres) <= 2.0).sum()


# ---- polygons that are refused --------------------------------------------------------------------------------------


def test_a_moved_vertex_is_noticed_with_its_place_and_value():
    polygon = group_of("*237").polygon
    vertices = polygon.vertices.copy()
    vertices[0] = H2.geodesic(vertices[0], H2.origin, 0.1)
    with pytest.raises(GeometryError, match=r"corners \d of 'abc' add up to .* a corner of mirrors needs pi / n"):
        ConwayGroup(MirroredPolygon(H2, vertices, polygon.word))


def test_sides_of_different_lengths_are_noticed():
    polygon = group_of("237").polygon
    vertices = polygon.vertices.copy()
    vertices[0] = H2.geodesic(vertices[0], H2.origin, 0.01)
    with pytest.raises(GeometryError, match="must be equal"):
        ConwayGroup(MirroredPolygon(H2, vertices, polygon.word))


def test_a_cone_angle_that_is_no_part_of_the_circle_is_noticed():
    """A regular octagon with angles 50 degrees, glued to a surface with a cone point of 400 degrees."""
    radius = np.arccosh(1 / (np.tan(np.pi / 8) * np.tan(np.radians(25))))
    vertices = H2.from_polar(radius, np.pi * np.arange(8) / 4)
    with pytest.raises(GeometryError, match=r"which is 2 pi / 0\.9; a cone point needs 2 pi / n"):
        ConwayGroup(MirroredPolygon(H2, vertices, MirrorWord.parse("abABcdCD")))


def test_an_octagon_with_half_the_angle_has_a_cone_point_of_order_2():
    radius = np.arccosh(1 / (np.tan(np.pi / 8) * np.tan(np.pi / 16)))
    vertices = H2.from_polar(radius, np.pi * np.arange(8) / 4)
    group = ConwayGroup(MirroredPolygon(H2, vertices, MirrorWord.parse("abABcdCD")))
    assert str(group.signature) == "oo2"
    assert group.area == pytest.approx(5 * np.pi, rel=1e-12)


@pytest.mark.parametrize(("text", "geometry"), [("*235", H2), ("*237", E2), ("o", S2), ("*237", S2), ("x", E2)])
def test_a_wrong_geometry_is_refused(text, geometry):
    with pytest.raises(GeometryError, match="Euler characteristic"):
        orbifold_group(geometry, ConwaySymbol.parse(text))


def test_a_spherical_cell_is_not_taken_for_the_whole_sphere():
    with pytest.raises(GeometryError, match="no fundamental polygon"):
        polygon_triangulation(group_of("532"))
    assert polygon_triangulation(group_of("x")).area_defect < 1e-12


# ---- the laws of the kit --------------------------------------------------------------------------------------------


def closed_surface(geometry, word):
    """The group of the surface of a word, by its symbol."""
    deficit = 2 - word.euler_characteristic
    return orbifold_group(
        geometry, ConwaySymbol(handles=deficit // 2) if word.orientable else ConwaySymbol(crosscaps=deficit)
    )


test_closed_surfaces_keep_the_laws = contract_tests(
    "group",
    closed_surface,
    expected_failures={"the_word_is_the_one_asked_for": "the group is that of the surface, whatever its word"},
)

SINGULAR = ["532", "*332", "3*2", "5x", "4*2", "22x", "*632", "*x", "237", "*237", "2*23"]
LAWS = [
    group_laws.pairings_are_isometries,
    group_laws.twins_are_inverse,
    group_laws.orientation_matches_the_word,
    group_laws.reduction_is_idempotent_and_invariant,
    group_laws.tiles_cover_a_disc_once,
]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.__name__)
@pytest.mark.parametrize("text", SINGULAR)
def test_singular_orbifolds_keep_the_laws_that_allow_fixed_points(law, text, monkeypatch, tmp_path):
    monkeypatch.setattr(group_laws, "_groups", lambda component: iter([component]))
    law(group_of(text), Lab(tmp_path))


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.__name__)
def test_every_such_law_rejects_its_mutant(law, monkeypatch, tmp_path):
    monkeypatch.setattr(group_laws, "_groups", lambda component: iter([component(None, None)]))
    mutant = group_laws.MUTANTS[law.__name__](lambda *_: group_of("2*23"))
    with pytest.raises(AssertionError):
        law(mutant, Lab(tmp_path))


@pytest.mark.parametrize("text", SINGULAR)
def test_the_law_that_nothing_is_fixed_is_broken(text, monkeypatch, tmp_path):
    monkeypatch.setattr(group_laws, "_groups", lambda component: iter([component]))
    with pytest.raises(AssertionError, match="is in the group"):
        group_laws.elements_have_no_fixed_point(group_of(text), Lab(tmp_path))
