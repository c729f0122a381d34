"""Cuts: which sides are edges, and what new points are."""

from __future__ import annotations

import numpy as np

from orbiframe.meshes.cut import Cut
from orbiframe.meshes.polyhedron import Polyhedron

SQUARE = Polyhedron.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])


def test_a_square_about_a_new_point_has_four_sides_on_its_outline() -> None:
    cut = Cut(SQUARE, np.array([[k, (k + 1) % 4, 4] for k in range(4)]), np.zeros(4, dtype=np.intp), np.array([[0, 2]]))
    assert cut.on_outline.tolist() == [True, False, False] * 4
    assert cut.vertex.tolist() == [0, 1, 2, 3, 4]
    np.testing.assert_array_equal(cut.with_middles(SQUARE.vertices)[4], [0.5, 0.5, 0])


def test_a_diagonal_is_no_edge() -> None:
    cut = Cut(SQUARE, np.array([[0, 1, 2], [0, 2, 3]]), np.zeros(2, dtype=np.intp), np.zeros((0, 2), dtype=np.intp))
    assert cut.on_outline.tolist() == [True, True, False, False, True, True]
