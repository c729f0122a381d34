import itertools

import pytest
from hypothesis import given, settings, strategies as st

from orbiframe import TopologyError, Word
from orbiframe.words import standard_word
from orbiframe.words.word import inverse_letters, parse_letters, reduced_letters


@pytest.mark.parametrize(
    ("text", "surface", "euler_characteristic", "vertices"),
    [
        ("aA", "sphere", 2, 2),
        ("abBA", "sphere", 2, 3),
        ("aa", "projective plane", 1, 1),
        ("abab", "projective plane", 1, 2),
        ("abAB", "torus", 0, 1),
        ("abcABC", "torus", 0, 2),
        ("aabb", "Klein bottle", 0, 1),
        ("abaB", "Klein bottle", 0, 1),
        ("aabbcc", "3 crosscaps", -1, 1),
        ("abABcc", "3 crosscaps", -1, 1),
        ("abABcdCD", "genus 2", -2, 1),
        ("abcdABCD", "genus 2", -2, 1),
        ("aabbccdd", "4 crosscaps", -2, 1),
        ("abABcdCDefEF", "genus 3", -4, 1),
    ],
)
def test_surfaces_of_known_words(text, surface, euler_characteristic, vertices):
    word = Word.parse(text)
    assert (word.surface, word.euler_characteristic) == (surface, euler_characteristic)
    assert len(word.vertex_cycles) == vertices
    assert str(word) == text
    assert word.standard.surface == surface


def test_klein_quartic_has_two_vertices():
    """Sides 2k+1 and 2k+6 (mod 14) of the 14-gon, numbered from 1, are glued [Klein 1879]."""
    letters = [0] * 14
    for label, side in enumerate(range(0, 14, 2), start=1):
        letters[side], letters[(side + 5) % 14] = label, -label
    word = Word(tuple(letters))
    assert word.surface == "genus 3"
    assert sorted(map(len, word.vertex_cycles)) == [7, 7]


@st.composite
def words(draw):
    size = draw(st.integers(1, 7))
    letters = draw(st.permutations([*range(1, size + 1)] * 2))
    signs = draw(st.lists(st.sampled_from([1, -1]), min_size=2 * size, max_size=2 * size))
    return Word(tuple(a * b for a, b in zip(letters, signs, strict=True)))


@settings(max_examples=60, deadline=None)
@given(words(), st.integers(0, 20))
def test_what_does_not_depend_on_where_one_starts_to_read(word, shift):
    turned = Word(word.letters[shift % len(word) :] + word.letters[: shift % len(word)])
    for other in (turned, word.inverse, Word.parse(str(word))):
        assert (other.surface, len(other.vertex_cycles)) == (word.surface, len(word.vertex_cycles))


@settings(max_examples=60, deadline=None)
@given(words())
def test_vertex_cycles_against_brute_force_identification(word):
    """Corners are glued when ends of glued sides are: transitive closure, and every corner once."""
    size = len(word)
    glued = {(i, i) for i in range(size)}
    for side in range(size):
        mate, head = word.mate[side], (side + 1) % size
        ends = (mate, (mate + 1) % size)
        glued |= {(side, ends[not word.reverses(side)]), (head, ends[word.reverses(side)])}
    for k, i, j in itertools.product(range(size), repeat=3):
        if (i, k) in glued and (k, j) in glued:
            glued.add((i, j))
    classes = {frozenset(j for j in range(size) if (i, j) in glued) for i in range(size)}
    assert {frozenset(cycle) for cycle in word.vertex_cycles} == classes
    assert sorted(itertools.chain(*word.vertex_cycles)) == list(range(size))
    deficit = 2 - word.euler_characteristic
    assert deficit >= 0
    assert not (word.orientable and deficit % 2)


@settings(max_examples=60, deadline=None)
@given(words())
def test_every_side_end_is_crossed_once(word):
    """Round all vertices one crosses each pair of sides at both of its ends: n crossings together."""
    crossed = [side for relation in word.relations for side in relation]
    assert len(crossed) == len(word)
    for side in range(len(word)):
        assert crossed.count(side) + crossed.count(word.mate[side]) == 2


def test_relations_of_the_standard_words():
    """a b' a' b = e for the torus and a^2 b^2 = e up to rotation and inverse for crosscaps."""
    assert Word.parse("abAB").letter_relations == (parse_letters("BabA"),) or Word.parse("abAB").letter_relations == (
        parse_letters("BabA")[1:] + parse_letters("B"),
    )
    (relation,) = Word.parse("aabbcc").letter_relations
    assert relation == parse_letters("CCBBAA")


def test_letters_beyond_z_carry_a_number():
    word = standard_word(2 - 2 * 20, True)
    assert len(word) == 80
    assert "a1b1A1B1" in str(word)
    assert Word.parse(str(word)) == word
    assert parse_letters("z1 A1") == (52, -27)


def test_free_reduction_and_inverse():
    assert reduced_letters(parse_letters("abBAcAa")) == parse_letters("c")
    word = parse_letters("abCa")
    assert reduced_letters(word + inverse_letters(word)) == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("abA", "letter 'b' occurs 1 time "),
        ("aabbAb", "letter 'a' occurs 3 times"),
        ("", "needs letters"),
        ("ab-AB", "character 3 of 'ab-AB' is '-'"),
        ("ab  A;B", "is ';'"),
    ],
)
def test_words_that_glue_nothing_are_refused(text, message):
    with pytest.raises(TopologyError, match=message):
        Word.parse(text)


@pytest.mark.parametrize(("euler_characteristic", "orientable"), [(3, True), (1, True), (2, False), (-1, True)])
def test_impossible_surfaces_are_refused(euler_characteristic, orientable):
    with pytest.raises(TopologyError, match="no closed connected"):
        standard_word(euler_characteristic, orientable)
