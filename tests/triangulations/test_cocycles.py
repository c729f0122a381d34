"""Cocycles: dimensions, intersection forms and refinement, on triangulations of all kinds of surfaces."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import REGISTRY
from hypothesis import given, settings, strategies as st

from orbiframe.delaunay.polygon_fan import polygon_triangulation
from orbiframe.errors import TopologyError
from orbiframe.triangulations.cocycles import (
    cohomology,
    corner_values,
    intersections,
    orientations,
    refined_jumps,
    require_cocycles,
)
from orbiframe.triangulations.potentials import potentials
from orbiframe.words.word import Word

KINDS = {1: "finite", 0: "lattice", -1: "regular-polygon"}
# The rank of the first cohomology with real coefficients.
RANKS = {"aA": 0, "aa": 0, "abAB": 2, "abaB": 1, "aabb": 1, "abcdABCD": 4, "abABcdCD": 4, "aabbcc": 2, "aabbccdd": 3}


def fan(text: str, refined: int = 0):
    word = Word.parse(text)
    sign = int(np.sign(word.euler_characteristic))
    domain = polygon_triangulation(REGISTRY.load("group", KINDS[sign])(REGISTRY.geometry(sign), word))
    for _ in range(refined):
        domain = domain.refined()
    return domain


@pytest.mark.parametrize("refined", [0, 2])
@pytest.mark.parametrize("text", RANKS)
def test_there_are_as_many_classes_as_the_surface_has(text, refined):
    domain = fan(text, refined)
    jumps = cohomology(domain)
    assert jumps.shape == (RANKS[text], 3 * domain.face_count)
    require_cocycles(domain, jumps)
    # No combination is the difference of whole numbers on the triangles: the classes are independent.
    face = np.arange(len(domain.twin)) // 3
    trivial = (face == np.arange(domain.face_count)[:, None]).astype(int)
    trivial = trivial - trivial[:, domain.twin]
    both = np.concatenate([jumps, trivial])
    assert np.linalg.matrix_rank(both) == RANKS[text] + domain.face_count - 1


@pytest.mark.parametrize("text", ["abAB", "abcdABCD", "abABcdCDefEF"])
def test_the_intersection_form_is_unimodular_and_kept_by_refinement(text):
    domain = fan(text)
    jumps = cohomology(domain)
    form = intersections(domain, jumps)
    assert (form == -form.T).all()
    assert round(np.linalg.det(form)) == 1
    finer = refined_jumps(jumps)
    require_cocycles(domain.refined(), finer)
    assert (intersections(domain.refined(), finer) == form).all()


def test_the_intersection_form_depends_on_classes_alone():
    """What jumps by whole numbers between the triangles changes nothing."""
    domain = fan("abABcdCD", 1)
    jumps = cohomology(domain)
    steps = np.random.default_rng(0).integers(-3, 4, size=(len(jumps), domain.face_count))
    face = np.arange(len(domain.twin)) // 3
    moved = jumps + steps[:, face] - steps[:, face[domain.twin]]
    require_cocycles(domain, moved)
    assert (intersections(domain, moved) == intersections(domain, jumps)).all()


@pytest.mark.parametrize("text", ["abABcdCD", "aabbcc", "abaB"])
def test_values_at_corners_have_the_jumps(text):
    domain = fan(text, 1)
    jumps = cohomology(domain)
    value = corner_values(domain, jumps).reshape(len(jumps), -1)
    here = np.arange(3 * domain.face_count)
    after = here - here % 3 + (here + 1) % 3
    assert (value[:, here] - value[:, domain.start] == jumps).all()
    assert (value[:, after] - value[:, domain.end] == jumps).all()


def test_what_is_no_cocycle_is_said():
    domain = fan("abAB", 1)
    jumps = cohomology(domain)
    edge = np.flatnonzero(jumps[0])[0]
    wrong = jumps.copy()
    wrong[0, edge] += 1
    with pytest.raises(TopologyError, match="twin"):
        require_cocycles(domain, wrong)
    wrong[0, domain.twin[edge]] -= 1
    with pytest.raises(TopologyError, match="round vertex"):
        require_cocycles(domain, wrong)


def test_a_nonorientable_surface_has_no_orientation():
    with pytest.raises(TopologyError, match="nonorientable"):
        orientations(fan("aabb"))
    assert set(orientations(fan("abAB", 1))) == {1}


@settings(deadline=None, max_examples=30)
@given(st.integers(2, 30), st.integers(0, 2**31))
def test_potentials_are_found_from_differences(count, seed):
    """On random connected graphs with random numbers at the nodes."""
    rng = np.random.default_rng(seed)
    value = rng.integers(-9, 10, size=(count, 2))
    tail = np.concatenate([np.arange(1, count), rng.integers(0, count, 5)])
    head = np.concatenate([[rng.integers(0, k) for k in range(1, count)], rng.integers(0, count, 5)])
    root = np.arange(count) == rng.integers(count)
    found = potentials(root, tail, head, value[tail] - value[head])
    assert (found == value - value[root]).all()
