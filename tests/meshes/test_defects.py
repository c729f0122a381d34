"""Defects: what is listed, against a look at every pair."""

from __future__ import annotations

import numpy as np
from hypothesis import given, strategies as st

from orbiframe.meshes.defects import duplicate_faces
from orbiframe.meshes.polyhedron import Polyhedron

FACES = st.lists(st.lists(st.integers(0, 5), min_size=3, max_size=5, unique=True), min_size=1, max_size=8)


@given(FACES)
def test_duplicate_faces_are_those_with_the_same_vertices(faces: list[list[int]]) -> None:
    last: dict[frozenset[int], int] = {}
    expected = []
    for number, face in enumerate(faces):
        if frozenset(face) in last:
            expected.append((last[frozenset(face)], number))
        last[frozenset(face)] = number
    assert duplicate_faces(Polyhedron.from_faces(np.eye(6)[:, :3], faces)) == sorted(expected)


def test_a_size_that_occurs_once_hides_no_larger_faces() -> None:
    faces = [[0, 1, 2], [0, 1, 2, 3], [3, 2, 1, 0]]
    assert duplicate_faces(Polyhedron.from_faces(np.eye(4)[:, :3], faces)) == [(1, 2)]
