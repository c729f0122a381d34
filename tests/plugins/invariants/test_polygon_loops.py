"""Loops along sides as products of side pairings: against the relations that both must keep, in matrices."""

from __future__ import annotations

import json

import numpy as np
import pytest
from orbiframe_invariants.canonical_word import canonical_form, tree_letters
from orbiframe_invariants.generator_matrices import generator_matrices
from orbiframe_invariants.named_words import word_named
from orbiframe_invariants.polygon_loops import loops_in_pairings

from orbiframe.components.registry import Registry
from orbiframe.words import text_of

REGISTRY = Registry.discover()
WORDS = ["abABcdCD", "bolza", "klein-quartic", "aabbcc", "abAcBDdCee", "aabbccdd", "abcaBC"]


def group_of(text: str):
    word = word_named(text)
    chi = word.euler_characteristic
    name = {0: "lattice", -1: "regular-polygon"}[(chi > 0) - (chi < 0)]
    return REGISTRY.load("group", name)(REGISTRY.geometry(chi), word)


def product(letters, matrices: dict[str, list]) -> np.ndarray:
    found = np.eye(3)
    for letter in letters:
        matrix = np.array(matrices[text_of(abs(letter))])
        found = found @ (matrix if letter > 0 else np.linalg.inv(matrix))
    return found


def regular(text: str) -> bool:
    return len({len(cycle) for cycle in word_named(text).vertex_cycles}) == 1


@pytest.mark.parametrize("text", [text for text in WORDS if regular(text)])
def test_the_word_is_1_in_loops_and_the_relations_are_in_pairings(text):
    group = group_of(text)
    matrices, word = generator_matrices(group), group.word
    for relation in word.letter_relations:
        np.testing.assert_allclose(product(relation, matrices["pairings"]), np.eye(3), atol=1e-6)
    np.testing.assert_allclose(product(word.letters, matrices["loops"]), np.eye(3), atol=1e-6)
    if len(word.vertex_cycles) > 1:
        return  # the letters of the standard word are so long that their matrices have no digits left
    change = canonical_form(word).new_in_old
    standard = {text_of(k): product(loop, matrices["loops"]) for k, loop in change.items()}
    np.testing.assert_allclose(product(word.standard.letters, standard), np.eye(3), atol=1e-4)


@pytest.mark.parametrize("text", [text for text in WORDS if regular(text)])
def test_loops_run_along_the_sides_of_the_polygon(text):
    """Where one begins, the loops one after the other come to the corners of the polygon moved by one element each."""
    group = group_of(text)
    matrices, word = generator_matrices(group), group.word
    assert [letter for letter, loop in loops_in_pairings(word).items() if not loop] == sorted(tree_letters(word))
    if len(word.vertex_cycles) > 1:
        return
    geometry, vertices = group.geometry, group.polygon.vertices
    begin = np.eye(3)
    for side, letter in enumerate(word.letters):
        # The lift of the loop goes from begin v0 to end v0, and is as long as the side.
        end = begin @ product([letter], matrices["loops"])
        ends = (geometry.act(g, vertices[0]) for g in (begin, end))
        assert float(geometry.distance(*ends)) == pytest.approx(group.polygon.side_lengths[side], rel=1e-5)
        np.testing.assert_allclose(geometry.act(end, vertices[0]), vertices[(side + 1) % len(word)], atol=1e-5)
        begin = end


def test_a_matrix_is_that_of_the_polygon(orbiframe):
    ran = orbiframe("group", "bolza", "--matrices", "--json")
    assert (ran.status, ran.err) == (0, "")
    found = json.loads(ran.out)
    group = group_of("bolza")
    np.testing.assert_allclose(found["matrices"]["pairings"]["b"], group.generator(2), atol=1e-12)
    # Bolza's generators move the origin by twice arcosh(1 + sqrt(2)).
    assert found["matrices"]["pairings"]["a"][0][0] == pytest.approx(np.cosh(2 * np.arccosh(1 + np.sqrt(2))), rel=1e-12)
    assert sorted(found["loops"]) == list("abcd")


def test_both_kinds_of_letters_are_named(orbiframe):
    out = orbiframe("group", "bolza", "--matrices").out
    assert "relations DcBadCbA = 1, of side pairings" in out
    assert "standard  abABcdCD, of loops along sides" in out
    assert out.count(" = ") > 8


def test_letters_of_a_symbol_have_matrices(orbiframe):
    found = json.loads(orbiframe("group", "*237", "--matrices", "--json").out)["matrices"]["letters"]
    for letter in "abc":
        np.testing.assert_allclose(np.linalg.matrix_power(np.array(found[letter]), 2), np.eye(3), atol=1e-9)
