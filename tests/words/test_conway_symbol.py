from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from itertools import combinations_with_replacement, product

import pytest
from hypothesis import given, settings, strategies as st

from orbiframe import TopologyError, Word
from orbiframe.words import ConwaySymbol, MirrorWord, Relations, word_of
from orbiframe.words.conway_symbol import PLANE_GROUPS

ORDERS = st.lists(st.integers(2, 12), max_size=4).map(tuple)


@st.composite
def signatures(draw):
    """Any orbifold that is not bad, not too large."""
    parts = draw(st.integers(0, 2)), draw(ORDERS), tuple(draw(st.lists(ORDERS, max_size=3))), draw(st.integers(0, 2))
    try:
        return ConwaySymbol(*parts)
    except TopologyError:
        return ConwaySymbol(parts[0] + 1, *parts[1:])


@settings(max_examples=60, deadline=None)
@given(signatures())
def test_a_symbol_is_read_as_it_is_written(signature):
    assert ConwaySymbol.parse(str(signature)) == signature
    assert signature.canonical.canonical == signature.canonical
    assert signature.canonical.euler_characteristic == signature.euler_characteristic


@settings(max_examples=60, deadline=None)
@given(signatures())
def test_the_word_of_an_orbifold_folds_to_it(signature):
    word, orders = word_of(signature)
    assert word.signature(orders).canonical == signature.canonical
    assert word.orientable == signature.orientable
    assert sorted(c for cycle in word.vertex_cycles for c in cycle) == list(range(len(word)))


@settings(max_examples=60, deadline=None)
@given(signatures())
def test_euler_characteristic_counts_cells_by_the_order_of_their_stabilizers(signature):
    """The sum of (-1)^dimension / |stabilizer| over the cells of the folded polygon: Thurston's definition."""
    word, orders = word_of(signature)
    vertices = sum(Fraction(1, n * (2 if c.ends else 1)) for c, n in zip(word.cycles, orders, strict=True))
    sides = {abs(k): Fraction(1, 2 if word.letters.count(k) + word.letters.count(-k) == 1 else 1) for k in word.letters}
    assert vertices - sum(sides.values()) + 1 == signature.euler_characteristic


@pytest.mark.parametrize(
    ("text", "chi", "order"),
    [
        ("*532", Fraction(1, 60), 120),
        ("532", Fraction(1, 30), 60),
        ("3*2", Fraction(1, 12), 24),
        ("*332", Fraction(1, 12), 24),
        ("*432", Fraction(1, 24), 48),
        ("*77", Fraction(1, 7), 14),
        ("77", Fraction(2, 7), 7),
        ("7*", Fraction(1, 7), 14),
        ("7x", Fraction(1, 7), 14),
        ("*227", Fraction(1, 14), 28),
        ("227", Fraction(1, 7), 14),
        ("2*7", Fraction(1, 14), 28),
        ("1", 2, 1),
        ("*", 1, 2),
        ("x", 1, 2),
        ("*237", Fraction(-1, 84), None),
        ("237", Fraction(-1, 42), None),
        ("oo", -2, None),
        ("xxx", -1, None),
        ("o", 0, None),
        ("2*2 12", Fraction(-5, 24), None),
    ],
)
def test_euler_characteristic_and_order(text, chi, order):
    signature = ConwaySymbol.parse(text)
    assert signature.euler_characteristic == chi
    assert signature.order == order


@pytest.mark.parametrize("text", PLANE_GROUPS)
def test_the_plane_groups_are_those_with_characteristic_zero(text):
    assert ConwaySymbol.parse(text).euler_characteristic == 0
    assert str(ConwaySymbol.parse(text).canonical) == text


def test_there_are_seventeen_plane_groups():
    """All symbols with characteristic 0, by brute force: no part may cost more than 2, so no order exceeds 6."""
    orders = [c for n in range(5) for c in combinations_with_replacement(range(2, 7), n)]
    boundaries = [(), *((corners,) for corners in orders), ((), ())]
    found = set()
    for handles, cones, mirrors, crosscaps in product((0, 1), orders, boundaries, (0, 1, 2)):
        if 2 * handles + len(cones) / 2 + len(mirrors) + crosscaps <= 2:
            with suppress(TopologyError):
                signature = ConwaySymbol(handles, cones, mirrors, crosscaps)
                found |= {str(signature.canonical)} if signature.euler_characteristic == 0 else set()
    assert found == set(PLANE_GROUPS)


@pytest.mark.parametrize(
    ("text", "name"),
    [
        *(("*235", "Ih"), ("3*2", "Th"), ("2*5", "D5d"), ("*225", "D5h"), ("225", "D5"), ("7*", "C7h"), ("*77", "C7v")),
        *(("77", "C7"), ("7x", "S14"), ("x", "Ci"), ("*", "Cs"), ("222", "D2"), ("*2 2 12", "D12h"), ("12 12", "C12")),
        *(("4*2", "p4g"), ("*236", "p6m"), ("22x", "pgg"), ("*22 22", "C22v"), ("122 122", "C122"), ("*237", "*732")),
    ],
)
def test_names(text, name):
    assert ConwaySymbol.parse(text).name == name


def test_corners_may_be_read_from_any_of_them_and_backwards_together():
    same = ConwaySymbol.parse("*234*567").canonical
    assert ConwaySymbol.parse("*342*756").canonical == same
    assert ConwaySymbol.parse("*432*765").canonical == same
    assert ConwaySymbol.parse("*432*567").canonical != same
    assert ConwaySymbol.parse("*432*567x").canonical == ConwaySymbol.parse("*234*567x").canonical
    assert ConwaySymbol.parse("ox").canonical == ConwaySymbol.parse("xxx")


@pytest.mark.parametrize("text", ["5", "23", "*5", "*23", "2 12"])
def test_bad_orbifolds_are_refused_in_words(text):
    with pytest.raises(TopologyError, match="bad orbifold"):
        ConwaySymbol.parse(text)


@pytest.mark.parametrize(
    ("text", "problem"),
    [("*2q7", "character 3 of"), ("", "no symbol"), ("x2", "no symbol"), ("xo", "no symbol"), ("*203", "order 0")],
)
def test_other_texts_are_refused_in_words(text, problem):
    with pytest.raises(TopologyError, match=problem):
        ConwaySymbol.parse(text)


@pytest.mark.parametrize(
    ("text", "relations"),
    [
        ("*237", "<a, b, c | a^2, b^2, c^2, (ac)^2, (ab)^3, (bc)^7>"),
        ("237", "<a, b, c | abc, a^2, b^3, c^7>"),
        ("xx", "<a, b | aabb>"),
        ("7x", "<a, b | abb, a^7>"),
        ("*", "<a | a^2>"),
    ],
)
def test_presentations(text, relations):
    assert str(Relations.of(*word_of(ConwaySymbol.parse(text)))) == relations


def test_a_word_without_mirrors_is_as_before():
    plain, mirrored = Word.parse("abABcdCD"), MirrorWord.parse("abABcdCD")
    assert (plain.mate, plain.vertex_cycles, plain.relations) == (
        mirrored.mate,
        mirrored.vertex_cycles,
        mirrored.relations,
    )
    with pytest.raises(TopologyError, match="occurs 3 times"):
        MirrorWord.parse("abab A")
