"""Corner elements of regular polygons: against products of pairings, and the Poincare relation at high genus."""

from __future__ import annotations

from functools import reduce
from types import SimpleNamespace

import numpy as np
import pytest
from reference_meshes import geometry

from orbiframe import Word
from orbiframe.groups import PolygonGroup, regular_polygon
from orbiframe.groups.corner_elements import corner_elements, products_of_pairings
from orbiframe.words import standard_word

WORDS = ["abAB", "abaB", "abAb", "aabb", "abABcdCD", "abcdABCD", "abcdbDAC", "aabbcc", "abACbC", "abbcca", "aabbccdd"]


def polygon_of(word: Word):
    return regular_polygon(geometry(int(np.sign(word.euler_characteristic))), word)


@pytest.mark.parametrize("text", WORDS)
def test_they_are_products_of_pairings(text):
    polygon = polygon_of(Word.parse(text))
    products = products_of_pairings(PolygonGroup(polygon)).matrix
    np.testing.assert_allclose(corner_elements(polygon).matrix, products, atol=1e-13 * np.abs(products).max() ** 1.5)


@pytest.mark.parametrize("text", WORDS)
def test_they_take_the_first_corner_to_the_others(text):
    polygon = polygon_of(Word.parse(text))
    images = corner_elements(polygon).matrix @ polygon.vertices[0]
    np.testing.assert_allclose(images, polygon.vertices, atol=1e-12 * polygon.vertices[:, 0].max() ** 3)


@pytest.mark.parametrize("genus", [2, 5, 10, 20, 50])
def test_sides_are_glued_at_high_genus(genus):
    """h_s = g_s g_{s'+1}^-1 = g_{s+1} g_{s'}^-1 for opposite letters, to eps e^(2R); matrices fail from genus 20 on."""
    word = standard_word(2 - 2 * genus, True)
    polygon = polygon_of(word)
    assert np.abs(polygon.angle_defects).max() < 1e-12
    g, side, mate = corner_elements(polygon), np.arange(len(word)), np.array(word.mate)
    after = np.roll(side, -1)
    difference = (g[side] @ g[after[mate]].inverse).inverse @ (g[after] @ g[mate].inverse)
    assert np.abs(difference.b).max() < 1e-16 * np.exp(2 * polygon.circumradius)


def test_the_relator_of_the_word_is_trivial():
    """The elements g_p^-1 g_(p+1) of the letters multiply to the identity along the word, and twins are inverse."""
    for text in WORDS:
        word = Word.parse(text)
        g = corner_elements(polygon_of(word))
        letters = [g[np.array([p])].inverse @ g[np.array([(p + 1) % len(word)])] for p in range(len(word))]
        whole = reduce(lambda left, right: left @ right, letters).matrix[0]
        np.testing.assert_allclose(whole, np.eye(3), atol=1e-8)
        for side, mate in enumerate(word.mate):
            other = letters[mate] if word.reverses(side) else letters[mate].inverse
            np.testing.assert_allclose(letters[side].matrix, other.matrix, atol=1e-9)


def test_generators_of_any_group_will_do():
    polygon = polygon_of(Word.parse("abACbC"))
    group = PolygonGroup(polygon)
    stranger = SimpleNamespace(word=group.word, geometry=group.geometry, generator=group.generator)
    np.testing.assert_allclose(products_of_pairings(stranger).matrix, corner_elements(polygon).matrix, atol=1e-9)
