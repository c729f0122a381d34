"""Elements of groups: against brute force, lattices, the area of discs and the growth functions of surface groups."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_groups.finite import FiniteGroup
from orbiframe_groups.lattice import lattice_group
from orbiframe_invariants.word_growth import elements_by_length, even_corners, growth_series
from reference_geometries import GEOMETRIES
from reference_surfaces import brute_force_group

from orbiframe import FundamentalPolygon, GeometryError, Word
from orbiframe.groups import PolygonGroup, dirichlet_domain_of, elements_within, regular_polygon
from orbiframe.groups.conway_group import orbifold_group
from orbiframe.words.conway_symbol import ConwaySymbol

S2, E2, H2 = GEOMETRIES


def regular(text: str) -> PolygonGroup:
    return PolygonGroup(regular_polygon(H2, Word.parse(text)))


def klein_quartic() -> PolygonGroup:
    """Klein's 14-gon: side 2 k + 1 is glued to side 2 k + 6, seven corners meet at both vertices."""
    letters = [0] * 14
    for k in range(7):
        letters[2 * k + 1], letters[(2 * k + 6) % 14] = k + 1, -k - 1
    return PolygonGroup(regular_polygon(H2, Word(tuple(letters))))


def oblique_octagon() -> PolygonGroup:
    """The Bolza surface seen from another point: the polygon of the same word with its corners moved by elements.

    The corners are the images of one point P under the corner elements of the regular octagon.
    """
    from orbiframe.groups.corner_elements import corner_elements

    group = regular("abcdABCD")
    corner = H2.act(H2.translation(0.25, 0.4), group.polygon.vertices[0])
    return PolygonGroup(FundamentalPolygon(H2, H2.act(corner_elements(group.polygon).matrix, corner), group.word))


@pytest.mark.parametrize("text", ["abcdABCD", "abABcdCD", "aabbcc", "abACbC"])
def test_elements_are_all_words_within_the_radius(text: str) -> None:
    group, radius = regular(text), 5.3
    words = brute_force_group(group.atlas().isometry[1:], 4)
    inside = words[H2.distance(H2.origin, words[..., 0]) <= radius]
    found = elements_within(group, radius)
    apart = np.abs(found.precise().matrix[:, None] - inside).max(axis=(2, 3))
    assert len(found) == len(inside)
    assert (apart.min(axis=1) < 1e-8).all()
    assert (apart.min(axis=0) < 1e-8).all()


@settings(max_examples=15, deadline=None)
@given(st.floats(-3, 3), st.floats(0.3, 2.0), st.floats(1.0, 12.0))
def test_elements_of_a_lattice_are_its_points_in_the_disc(shear: float, height: float, radius: float) -> None:
    group = lattice_group(E2, Word.parse("abAB"), second=(shear, height))
    n = np.arange(-300, 301)
    points = n[:, None, None] * [1.0, 0.0] + n[None, :, None] * np.array([shear, height])
    distance = np.sort(np.hypot(*np.moveaxis(points, -1, 0)).ravel())
    if (np.abs(distance - radius) < 1e-6).any():
        return
    found = elements_within(group, radius)
    np.testing.assert_allclose(np.sort(found.distance), distance[distance <= radius], atol=1e-11)


def test_a_slender_parallelogram_has_a_round_dirichlet_cell() -> None:
    """The cell of the lattice of (1, 0) and (n + 1/2, 1) is that of (1, 0) and (1/2, 1): circumradius 5/8."""
    cell = dirichlet_domain_of(lattice_group(E2, Word.parse("abAB"), second=(30.5, 1.0)))
    assert cell.side_count == 6
    assert cell.circumradius == pytest.approx(5 / 8, abs=1e-12)


@pytest.mark.parametrize("make", [klein_quartic, oblique_octagon])
def test_each_element_comes_once_and_none_is_missing(make) -> None:
    """Polygons that are no Dirichlet cells, or whose sides make up no lines, against brute force."""
    group, radius = make(), 6.0
    found = elements_within(group, radius)
    place = found.precise().place
    apart = H2.distance(place[:, None], place) + 10 * np.eye(len(place))
    assert apart.min() > 1.0
    walked = brute_force_group(group.atlas().isometry[1:], 1)
    for _ in range(4):
        step = (walked[:, None] @ group.atlas().isometry[1:]).reshape(-1, 3, 3)
        walked = np.concatenate([walked, step])
        walked = walked[H2.distance(H2.origin, walked[..., 0]) <= radius + 2 * group.polygon.circumradius]
        walked = walked[np.unique(np.round(walked[..., 1:, 0], 4), axis=0, return_index=True)[1]]
    inside = walked[H2.distance(H2.origin, walked[..., 0]) <= radius, :, 0]
    between = H2.distance(inside[:, None], place)
    assert between.min(axis=1).max() < 1e-6
    assert between.min(axis=0).max() < 1e-6


def test_the_dirichlet_cell_of_a_regular_polygon_is_the_polygon() -> None:
    group = regular("aabbcc")
    cell = dirichlet_domain_of(group)
    apart = H2.distance(cell.vertices[:, None], group.polygon.vertices).min(axis=1)
    assert cell.side_count == 6
    assert apart.max() < 1e-12


@pytest.mark.parametrize("make", [oblique_octagon, klein_quartic, lambda: regular("aabbcc")])
def test_words_are_read_off(make) -> None:
    group = make()
    found = elements_within(group, 7.0)
    for number in range(1, len(found), 37):
        matrix = found.precise(np.array([number])).matrix[0]
        assert np.abs(group.element(found.word(number)) - matrix).max() < 1e-10 * np.abs(matrix).max()
    assert found.word(0) == ()


def test_the_number_of_elements_grows_like_the_area_of_the_disc() -> None:
    found = elements_within(regular("abABcdCD"), 15.0)
    assert len(found) == pytest.approx((np.cosh(15.0) - 1) / 2, rel=2e-3)
    place = found.precise(slice(None, None, 400)).place
    np.testing.assert_allclose(H2.distance(H2.origin, place), found.distance[::400], atol=1e-9)


def test_the_antipodal_group_has_two_elements() -> None:
    found = elements_within(FiniteGroup(S2, Word.parse("aa")), np.pi)
    np.testing.assert_allclose(found.precise().matrix, [np.eye(3), -np.eye(3)], atol=1e-15)
    assert [found.word(k) for k in range(2)] == [(), (1,)]
    assert len(elements_within(FiniteGroup(S2, Word.parse("aa")), 3.0)) == 1


@pytest.mark.parametrize(("symbol", "order"), [("*235", 120), ("235", 60), ("332", 12), ("3x", 6), ("*33", 6)])
def test_spherical_groups_have_as_many_elements_as_known(symbol: str, order: int) -> None:
    group = orbifold_group(S2, ConwaySymbol.parse(symbol))
    found = elements_within(group, np.pi)
    assert len(found) == order
    for number in range(order):
        np.testing.assert_allclose(group.element(found.word(number)), found.precise().matrix[number], atol=1e-13)


@pytest.mark.parametrize("symbol", ["*237", "2223", "2*33"])
def test_groups_with_fixed_points_fill_the_disc(symbol: str) -> None:
    group = orbifold_group(H2, ConwaySymbol.parse(symbol))
    found = elements_within(group, 7.0)
    assert len(found) == pytest.approx(2 * np.pi * (np.cosh(7.0) - 1) / group.area, rel=0.02)
    place = found.precise().place
    assert H2.distance(place[1:], place[0]).min() > 0.1
    assert len(np.unique(np.round(place, 5), axis=0)) == len(found)


def test_elements_far_away_keep_their_digits() -> None:
    """|a|^2 - |b|^2 = 1 to eps e^d, what is left of a difference of two numbers of the size e^d."""
    group = regular("abABcdCD")
    found = elements_within(group, 13.0)
    last = found.precise(np.arange(len(found) - 50, len(found)))
    assert np.abs(np.abs(last.a) ** 2 - np.abs(last.b) ** 2 - 1).max() < 1e-13 * np.exp(13.0)


def test_too_many_elements_are_refused() -> None:
    with pytest.raises(GeometryError, match="no more than 1000"):
        elements_within(regular("abABcdCD"), 12.0, most=1000)
    with pytest.raises(GeometryError, match="more than 1000"):
        elements_by_length(regular("abABcdCD"), 6, most=1000)
    with pytest.raises(GeometryError, match="radius"):
        elements_within(regular("abABcdCD"), -1.0)


def series(numerator: list[int], denominator: list[int], length: int) -> tuple[int, ...]:
    """The first coefficients of a rational function."""
    found: list[int] = []
    for n in range(length + 1):
        top = numerator[n] if n < len(numerator) else 0
        found.append(top - sum(c * found[n - k] for k, c in enumerate(denominator[1 : n + 1], start=1)))
    return tuple(found)


@pytest.mark.parametrize(("text", "length"), [("abABcdCD", 6), ("abcdABCD", 6), ("aabbcc", 7), ("abABcdCDefEF", 4)])
def test_growth_series_of_surface_groups(text: str, length: int) -> None:
    """(1 + 2z + ... + 2z^(m-1) + z^m) / (1 - (l-2)(z + ... + z^(m-1)) + z^m), l = 2m letters [Cannon 1984]."""
    half = len(text) // 2
    inner = [2 - len(text)] * (half - 1)
    assert growth_series(regular(text), length) == series([1, *[2] * (half - 1), 1], [1, *inner, 1], length)


def one_vertex_word(pairs: int, seed: int) -> Word:
    """A random word with one vertex: letters in random places with random signs, until one comes out."""
    rng = np.random.default_rng(seed)
    while True:
        letters = np.repeat(np.arange(1, pairs + 1), 2)[rng.permutation(2 * pairs)] * rng.choice([1, -1], 2 * pairs)
        if len((word := Word(tuple(map(int, letters)))).vertex_cycles) == 1:
            return word


@settings(max_examples=12, deadline=None)
@given(st.integers(3, 10), st.integers(0, 2**32 - 1))
def test_random_words_of_up_to_20_letters(pairs: int, seed: int) -> None:
    """Relations hold, the tree has the growth of the {l, l} tiling, and every word names its element."""
    word = one_vertex_word(pairs, seed)
    group, letters = regular(str(word)), 2 * pairs
    for relation in word.letter_relations:
        assert np.abs(group.element(relation) - np.eye(3)).max() < 1e-12 * np.cosh(group.polygon.circumradius) ** 2
    assert growth_series(group, 3) == series([1, *[2] * (pairs - 1), 1], [1, *[2 - letters] * (pairs - 1), 1], 3)
    found = elements_within(group, 2.2 * group.polygon.inradius)
    for number in range(len(found)):
        matrix = found.precise(np.array([number])).matrix[0]
        assert np.abs(group.element(found.word(number)) - matrix).max() < 1e-11 * np.abs(matrix).max()


def test_growth_series_of_a_lattice() -> None:
    group = lattice_group(E2, Word.parse("abAB"), second=(2.3, 1.1))
    assert growth_series(group, 6) == (1, 4, 8, 12, 16, 20, 24)


def test_growth_of_kleins_quartic_against_the_words() -> None:
    """Seven corners at a vertex: the sides make up no lines, and words are compared."""
    group = klein_quartic()
    assert not even_corners(group.polygon)
    words = brute_force_group(group.atlas().isometry[1:], 2)
    found = elements_by_length(group, 2)
    assert growth_series(group, 2) == (1, 14, len(words) - 15)
    assert np.array_equal(found.depth, np.sort(found.depth))


@pytest.mark.parametrize("text", ["abABcdCD", "aabbcc"])
def test_both_ways_to_shortest_words_agree(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    group = regular(text)
    lines = growth_series(group, 4)
    monkeypatch.setattr("orbiframe_invariants.word_growth.even_corners", lambda polygon: False)
    assert growth_series(group, 4) == lines
