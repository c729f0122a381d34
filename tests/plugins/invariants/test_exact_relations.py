"""The exact proof of relations: against matrices in floating point, and mutants that it rejects."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from orbiframe_geometries.h2 import H2
from orbiframe_invariants.exact_relations import ExactElement, ExactNumber, ExactRing, exact_pairings, prove_relations
from orbiframe_invariants.named_words import word_named

from orbiframe.errors import GeometryError
from orbiframe.groups.fundamental_polygon import regular_polygon
from orbiframe.planes.precise_isometry import PreciseIsometry
from orbiframe.words.word import Word, standard_word

WORDS = ["abABcdCD", "abcdABCD", "aabbcc", "aabcBC", "abABcdCDefEF", "aabbccddee"]


def value(number: ExactNumber) -> complex:
    """The number in floating point."""
    ring = number.ring
    zeta = np.exp(2j * np.pi * np.arange(2 * ring.sides) / (4 * ring.sides))
    t = np.sqrt(complex(np.array(ring.square, dtype=float) @ zeta))
    return complex(np.array(number.u, dtype=float) @ zeta + t * (np.array(number.v, dtype=float) @ zeta))


def matrix(element: ExactElement) -> np.ndarray:
    a, b = value(element.a), value(element.b)
    size = np.sqrt(abs(a) ** 2 - abs(b) ** 2)
    return PreciseIsometry(-1, np.array(a / size), np.array(b / size), np.array(element.reverses)).matrix


@pytest.mark.parametrize("text", WORDS)
def test_exact_pairings_are_those_of_the_polygon_up_to_a_turn(text):
    """The polygon in floating point may start at another corner: a rotation takes one to the other."""
    word = Word.parse(text)
    polygon = regular_polygon(H2(), word)
    middle = H2().project(polygon.vertices[0] + polygon.heads[0])
    turn = H2().rotation(np.arctan2(middle[2], middle[1]) - np.pi / len(word))
    for exact, pairing in zip(exact_pairings(word), polygon.pairings, strict=True):
        np.testing.assert_allclose(turn @ matrix(exact) @ H2().inverse(turn), pairing, atol=1e-9)


@pytest.mark.parametrize("text", [*(str(standard_word(2 - 2 * g, True)) for g in (2, 3, 6)), *WORDS])
def test_relations_of_one_vertex_are_proved(text):
    assert len(prove_relations(Word.parse(text))) == 1


def test_klein_s_quartic_has_two_vertices_and_two_relations():
    assert len(prove_relations(word_named("klein-quartic"))) == 2


def test_a_product_that_is_no_relation_is_not_the_identity():
    pairings = exact_pairings(Word.parse("abABcdCD"))
    product = pairings[0]
    for pairing in pairings[1:]:
        product = product @ pairing
    assert not product.is_identity


def test_another_inradius_breaks_the_relation():
    """The mutant: the same polygon with cosh r changed keeps its pairings, but they close up no more."""
    word = Word.parse("abcdABCD")
    pairings = [replace(p, a=p.a + p.a) for p in exact_pairings(word)]
    product = pairings[word.relations[0][0]]
    for side in word.relations[0][1:]:
        product = product @ pairings[side]
    assert not product.is_identity


def test_zero_is_seen_through_the_cyclotomic_polynomial():
    """1 + zeta^k + zeta^2k + ... over all roots of unity of odd order vanishes, though no coefficient does."""
    ring = ExactRing(10, 1)
    fifth = sum(ring.root(8 * k) for k in range(5))
    assert ring.is_zero(fifth)
    assert not ring.is_zero(fifth + ring.root(1))


@pytest.mark.parametrize(("text", "said"), [("abAB", "hyperbolic"), ("aabBcdCDee", "cycles of")])
def test_what_has_no_regular_polygon_is_refused(text, said):
    with pytest.raises(GeometryError, match=said):
        prove_relations(Word.parse(text))
