"""Markings against gluings that are known, deck transformations that are known, and homology by brute force."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_markers.tree_cotree import tree_cotree
from random_polyhedra import random_polyhedra
from reference_surfaces import ALL, triangulated

from orbiframe import Marking, Polyhedron, TopologyError, Word, surface_type
from orbiframe.groups import marking_along
from orbiframe.testing.marker_laws import _plain
from orbiframe.testing.polyhedra import reference_polyhedra
from orbiframe.words import Presentation

WORDS = ["abAB", "abaB", "aabb", "aa", "abABcdCD", "abcdABCD", "aabbcc", "abACbC", "abcAdCeDEfghGijIBJHF"]


def glued_polygon(word: Word, turned: bool = False) -> Polyhedron:
    """One face with all corners in one vertex and its sides glued by a word: every edge is a loop."""
    n = len(word)
    side = np.arange(n)[::-1] if turned else np.arange(n)
    twin = side[np.array(word.mate)[side]] if not turned else n - 1 - np.array(word.mate)[side]
    same = np.array([word.reverses(int(s)) for s in side])
    return Polyhedron(np.zeros((1, 3)), np.array([0, n]), np.zeros(n, dtype=int), twin, same)


def with_centre(word: Word) -> Polyhedron:
    """A triangle for every side of the polygon, with the apex in its middle; vertices 0, the corners, and 1."""
    n = len(word)
    side, spoke = 3 * np.arange(n), 3 * np.arange(n) + 1
    twin, same = np.empty(3 * n, dtype=int), np.zeros(3 * n, dtype=bool)
    twin[side] = 3 * np.array(word.mate)
    same[side] = [word.reverses(s) for s in range(n)]
    twin[spoke] = np.roll(side, -1) + 2
    twin[side + 2] = np.roll(spoke, 1)
    return Polyhedron(np.eye(3)[:2], 3 * np.arange(n + 1), np.tile([0, 0, 1], n), twin, same)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("text", WORDS)
def test_one_glued_polygon_has_its_own_word(text, turned):
    word = Word.parse(text)
    mesh = glued_polygon(word, turned)
    none = np.zeros(len(word), dtype=bool)
    marking = marking_along(mesh, 0, none, none)
    assert _plain(marking.word) == _plain(word)
    assert sorted(marking.position) == list(range(len(word)))
    assert all(loop.tolist() == [0, 0] for loop in marking.loops)


@pytest.mark.parametrize("text", WORDS)
def test_a_cone_over_a_glued_polygon_has_its_word(text):
    """Vertices share many edges, and edges are loops; the cut along the polygon gives the word back."""
    word = Word.parse(text)
    mesh = with_centre(word)
    side = np.arange(3 * len(word)) % 3 == 0
    tree = np.zeros(len(side), dtype=bool)
    tree[[1, 5]] = True
    marking = marking_along(mesh, 1, tree, ~side & ~tree)
    assert _plain(marking.word) == _plain(word)
    assert all(loop.tolist() == [1, 0, 0, 1] for loop in marking.loops)


@pytest.mark.parametrize("text", WORDS)
def test_short_loops_are_found_where_vertices_share_edges(text):
    word = Word.parse(text)
    marking = tree_cotree(with_centre(word))
    assert marking.word.surface == word.surface
    assert len(marking.word.vertex_cycles) == 1


@pytest.mark.parametrize("name", [name for name in ALL if name != "sphere"])
def test_words_are_the_known_deck_transformations(name):
    """With the letters of the sides as they are known, the word of every halfedge is the element that is known."""
    map_ = triangulated(name, 2)
    mesh, atlas, geometry = map_.polyhedron, map_.orbifold.atlas, map_.orbifold.geometry
    marking = tree_cotree(mesh)
    frame = np.full((len(mesh.vertices), 3, 3), np.nan)
    frame[mesh.tail[0]] = np.eye(3)
    start, end = marking.transitions
    still = np.flatnonzero(start == end)
    for _ in range(len(mesh.vertices)):
        for h in still:
            i, j, g = mesh.tail[h], mesh.head[h], atlas.isometry[map_.transition[h]]
            if np.isnan(frame[j, 0, 0]) and not np.isnan(frame[i, 0, 0]):
                frame[j] = frame[i] @ g
            if np.isnan(frame[i, 0, 0]) and not np.isnan(frame[j, 0, 0]):
                frame[i] = frame[j] @ geometry.inverse(g)
    known = frame[mesh.tail] @ atlas.isometry[map_.transition] @ geometry.inverse(frame[mesh.head])
    element = {}
    for side in marking.sides:
        (letter,) = marking.subword(int(side))
        element[letter], element[-letter] = known[side], geometry.inverse(known[side])
    for halfedge in range(len(mesh.tail)):
        product = np.eye(3)
        for letter in marking.subword(halfedge):
            product = product @ element[letter]
        np.testing.assert_allclose(product, known[halfedge], atol=1e-6 * np.abs(known[halfedge]).max())


@given(random_polyhedra())
@settings(max_examples=30, deadline=None)
def test_random_polyhedra_have_the_word_of_their_surface_and_its_homology(mesh):
    marking, surface = tree_cotree(mesh), surface_type(mesh)
    word = marking.word
    assert (word.euler_characteristic, word.orientable) == (surface.euler_characteristic, surface.orientable)
    assert Presentation.of(word).homology == homology(mesh)
    assert len(marking.loops) == 2 - surface.euler_characteristic


def homology(mesh: Polyhedron) -> tuple[int, int]:
    """Rank and torsion of the first homology of the cell complex, by the Smith normal form of its boundary maps."""
    arrow = np.where(mesh.representative | mesh.same, 1, -1)
    faces = np.zeros((mesh.face_count, mesh.edge_count), dtype=int)
    np.add.at(faces, (mesh.face, mesh.edge), arrow)
    edges = np.flatnonzero(mesh.representative)
    ends = np.zeros((mesh.edge_count, len(mesh.vertices)), dtype=int)
    np.add.at(ends, (np.arange(len(edges)), mesh.head[edges]), 1)
    np.add.at(ends, (np.arange(len(edges)), mesh.tail[edges]), -1)
    assert not (faces @ ends).any()
    factors = smith(faces.astype(object))
    rank = mesh.edge_count - len(smith(ends.astype(object))) - len(factors)
    return rank, int(np.prod([factor for factor in factors if factor > 1], initial=1))


def smith(matrix: np.ndarray) -> list[int]:
    """The entries other than zero of a diagonal form, by row and column steps with the smallest entry as pivot."""
    m, factors = matrix.copy(), []
    while m.size and m.any():
        places = np.argwhere(m != 0)
        i, j = min(places, key=lambda place: abs(m[tuple(place)]))
        m[[0, i]] = m[[i, 0]]
        m[:, [0, j]] = m[:, [j, 0]]
        m[1:] -= (m[1:, :1] // m[0, 0]) * m[:1]
        m[:, 1:] -= (m[:1, 1:] // m[0, 0]) * m[:, :1]
        if not (m[1:, 0].any() or m[0, 1:].any()):
            factors.append(abs(int(m[0, 0])))
            m = m[1:, 1:]
    return factors


def test_what_is_no_tree_is_refused():
    mesh = reference_polyhedra()["torus"]
    none = np.zeros(len(mesh.tail), dtype=bool)
    with pytest.raises(TopologyError, match=r"tree of a marking has 0 edges in 7 parts; it needs 6 in one"):
        marking_along(mesh, 0, none, none)
    good = tree_cotree(mesh)
    tree = _tree(good)
    with pytest.raises(TopologyError, match="cotree of a marking has 0 edges in 14 parts; it needs 13 in one"):
        marking_along(mesh, 0, tree, none)
    open_mesh = Polyhedron.from_faces(np.eye(3), [[0, 1, 2]])
    with pytest.raises(TopologyError, match="only a closed polyhedron"):
        marking_along(open_mesh, 0, np.zeros(3, dtype=bool), np.zeros(3, dtype=bool))


def _tree(marking: Marking) -> np.ndarray:
    """Edges with the trivial word that make a tree, found greedily."""
    mesh, (start, end) = marking.polyhedron, marking.transitions
    group, tree = np.arange(len(mesh.vertices)), np.zeros(len(mesh.tail), dtype=bool)
    for h in np.flatnonzero(start == end):
        i, j = group[mesh.tail[h]], group[mesh.head[h]]
        if i != j:
            group[group == j] = i
            tree[[h, mesh.twin[h]]] = True
    return tree


@given(st.sampled_from(WORDS))
def test_presentations_read_the_word(text):
    word = Word.parse(text)
    group = Presentation.of(word)
    rank = len(word) // 2
    assert group.relator == word.letters
    assert group.homology == ((rank, 1) if word.orientable else (rank - 1, 2))


def test_presentations_in_words():
    assert str(Presentation.of(Word.parse("abaB"))) == "<a, b | abaB>"
    assert Presentation.of(Word.parse("abaB")).homology_text == "Z + Z/2"
    assert Presentation.of(Word.parse("abcdABCD")).homology_text == "Z^4"
    assert Presentation.of(Word.parse("aa")).homology_text == "Z/2"
    assert Presentation.of(Word.parse("aA")).homology_text == "0"
    with pytest.raises(TopologyError, match="end in 2 vertices"):
        Presentation.of(Word.parse("abcABC"))
