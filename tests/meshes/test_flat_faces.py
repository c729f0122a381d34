"""Faces without area: which edge they go by, and what they may not join."""

from __future__ import annotations

import numpy as np

from orbiframe.meshes.flat_faces import _Rings, without_flat_faces
from orbiframe.meshes.polyhedron import Polyhedron


def test_of_longest_edges_alike_the_open_one_counts() -> None:
    """Vertices 1 and 2 are one point: by the open edge from 0 to 1 the face is dropped, by that to 2 it would join."""
    points = [[0, 0, 0], [1, 0, 0], [1, 0, 0], [0.5, 1, 0]]
    left, what = without_flat_faces(Polyhedron.from_faces(points, [[0, 1, 2], [0, 2, 3]]))
    assert what == (0, 1, 0)
    assert left.tail.tolist() == [0, 2, 3]


def test_a_needle_joins_the_face_across_its_longest_edge() -> None:
    points = [[0, 0, 0], [2, 0, 0], [1, 0, 0], [1, 1, 0], [1, -1, 0]]
    faces = [[0, 2, 1], [0, 1, 3], [2, 0, 4], [1, 2, 4]]
    left, what = without_flat_faces(Polyhedron.from_faces(points, faces))
    assert what == (1, 0, 0)
    assert left.face_sizes.tolist() == [4, 3, 3]
    assert set(left.tail[:4].tolist()) == {0, 2, 1, 3}


def test_faces_that_run_alike_along_an_edge_are_not_joined() -> None:
    mesh = Polyhedron.from_faces(np.eye(4)[:, :3], [[0, 1, 2], [0, 1, 3]])
    assert mesh.same[0]
    assert not _Rings(mesh)._join(0, 0, 1)
    turned = Polyhedron.from_faces(np.eye(4)[:, :3], [[0, 1, 2], [1, 0, 3]])
    assert _Rings(turned)._join(0, 0, 1)
