"""Reduction of words: the changes of generators in the free group, and on the matrices of regular polygons."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_invariants.canonical_word import canonical_form, substituted
from orbiframe_invariants.named_words import klein_quartic, opposite_sides, word_named
from reference_geometries import GEOMETRIES

from orbiframe import TopologyError, Word
from orbiframe.groups import PolygonGroup, regular_polygon
from orbiframe.groups.corner_elements import corner_elements
from orbiframe.words.word import inverse_letters

H2 = GEOMETRIES[2]
TAU = 2 * np.cos(2 * np.pi / 7)


@st.composite
def words(draw):
    labels = draw(st.permutations([k for k in range(1, draw(st.integers(1, 10)) + 1) for _ in (0, 1)]))
    return Word(tuple(k * draw(st.sampled_from((1, -1))) for k in labels))


def cyclically_reduced(letters):
    while len(letters) > 1 and letters[0] == -letters[-1]:
        letters = letters[1:-1]
    return letters


def conjugate(first, second):
    a, b = cyclically_reduced(first), cyclically_reduced(second)
    return len(a) == len(b) and any(a[k:] + a[:k] == b for k in range(max(1, len(a))))


@settings(max_examples=150, deadline=None)
@given(words())
def test_the_changes_undo_each_other_and_take_word_to_word(word):
    found = canonical_form(word)
    assert set(found.new_in_old) == set(map(abs, found.standard.letters))
    if found.standard.euler_characteristic < 2:
        for letter, loop in found.new_in_old.items():
            assert substituted(loop, found.old_in_new) == (letter,)
    there, back = substituted(word.letters, found.old_in_new), found.standard.letters
    if found.standard.euler_characteristic == 2:
        assert there == ()
    else:
        assert conjugate(there, back) or conjugate(there, inverse_letters(back))


def loops(word):
    """The deck transformation of the loop along every side, from the corners of the regular polygon."""
    corner = corner_elements(regular_polygon(H2, word))
    size = len(word)
    return {
        letter: (corner[np.array([p])].inverse @ corner[np.array([(p + 1) % size])]).matrix[0]
        for p, letter in enumerate(word.letters)
    }


def evaluated(letters, matrices):
    product = np.eye(3)
    for letter in letters:
        product = product @ (matrices[letter] if letter in matrices else H2.inverse(matrices[-letter]))
    return product


@pytest.mark.parametrize("text", ["abcdABCD", "aabcBC", "baaCdBCD", "bCAdbadC", "aabbcddc", "abcdbadc"])
def test_the_loops_of_the_standard_word_hold_its_relation_on_matrices(text):
    word = Word.parse(text)
    assert len(word.vertex_cycles) == 1
    old, found = loops(word), canonical_form(word)
    np.testing.assert_allclose(evaluated(word.letters, old), np.eye(3), atol=1e-8)
    new = {letter: evaluated(loop, old) for letter, loop in found.new_in_old.items()}
    size = max(np.abs(g).max() for g in new.values())
    np.testing.assert_allclose(evaluated(found.standard.letters, new), np.eye(3), atol=1e-13 * size**4)
    for letter, loop in found.old_in_new.items():
        given_again = evaluated(loop, new)
        original = old[letter] if letter in old else H2.inverse(old[-letter])
        np.testing.assert_allclose(given_again, original, atol=1e-13 * size**4)


def test_the_standard_word_is_left_alone():
    for text in ("abAB", "abABcdCD", "aabbcc", "aa"):
        found = canonical_form(Word.parse(text))
        assert found.new_in_old == found.old_in_new == {k: (k,) for k in found.new_in_old}


def test_the_klein_quartic_is_that_of_klein():
    """A 14-gon with two vertices of seven corners, angles 2 pi / 7, genus 3."""
    word = klein_quartic()
    assert (word.surface, [len(cycle) for cycle in word.vertex_cycles]) == ("genus 3", [7, 7])
    polygon = regular_polygon(H2, word)
    polygon.require_conditions(1e-11)
    np.testing.assert_allclose(polygon.interior_angles.astype(float), 2 * np.pi / 7, rtol=1e-12)
    assert polygon.area == pytest.approx(8 * np.pi, rel=1e-12)


@pytest.mark.parametrize(
    ("word", "length", "count"),
    [
        (opposite_sides(8), 2 * np.arccosh(1 + 2**0.5), 12),
        (klein_quartic(), 2 * np.arccosh((1 + TAU) * (2 + TAU) / 2), 21),
    ],
    ids=["bolza", "klein"],
)
def test_systoles_are_the_published_ones(word, length, count):
    """Bolza: Jenni 1984. Klein: 21 geodesics of the length 3.936; twice cosh of half of it is (1 + t)(2 + t)."""
    from orbiframe_invariants.closed_geodesics import systole

    found = systole(PolygonGroup(regular_polygon(H2, word)))
    assert found.length == pytest.approx(length, abs=1e-9)
    assert found.multiplicity == count


@pytest.mark.parametrize(("size", "genus", "vertices"), [(4, 1, 1), (6, 1, 2), (8, 2, 1), (10, 2, 2), (12, 3, 1)])
def test_the_ladder_of_opposite_sides(size, genus, vertices):
    word = opposite_sides(size)
    assert (word.euler_characteristic, len(word.vertex_cycles)) == (2 - 2 * genus, vertices)


def test_names_of_words():
    assert word_named("bolza") == Word.parse("abcdABCD")
    assert word_named("aabb") == Word.parse("aabb")
    with pytest.raises(TopologyError, match="Did you mean 'bolza'"):
        word_named("bolzas")
    with pytest.raises(TopologyError, match="an even number"):
        opposite_sides(7)
