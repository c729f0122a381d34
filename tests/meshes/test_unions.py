"""Disjoint unions: counts add up, nothing is glued, and every part is as it was."""

from __future__ import annotations

import numpy as np
import pytest

from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.surface_type import surface_type
from orbiframe.meshes.unions import disjoint_union
from orbiframe.testing.polyhedra import reference_polyhedra

FLAT = Polyhedron.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])


@pytest.mark.parametrize("names", [["cube"], ["cube", "Klein bottle"], ["double torus", "cube", "cube"]])
def test_parts_stand_side_by_side(names: list[str]) -> None:
    meshes = [reference_polyhedra()[name] for name in names]
    union = disjoint_union(meshes)
    assert surface_type(union).components == len(meshes)
    assert surface_type(union).euler_characteristic == sum(surface_type(m).euler_characteristic for m in meshes)
    vertex = face = halfedge = 0
    for mesh in meshes:
        corners = union.tail[halfedge : halfedge + len(mesh.tail)]
        assert np.array_equal(union.vertices[corners], mesh.vertices[mesh.tail])
        assert np.array_equal(corners, mesh.tail + vertex)
        assert np.array_equal(union.face_sizes[face : face + mesh.face_count], mesh.face_sizes)
        assert np.array_equal(union.twin[halfedge : halfedge + len(mesh.tail)], mesh.twin + halfedge)
        assert np.array_equal(union.same[halfedge : halfedge + len(mesh.tail)], mesh.same)
        vertex, face, halfedge = vertex + len(mesh.vertices), face + mesh.face_count, halfedge + len(mesh.tail)
    assert (len(union.vertices), union.face_count, len(union.tail)) == (vertex, face, halfedge)


def test_open_edges_stay_open() -> None:
    assert (disjoint_union([FLAT, FLAT, FLAT]).twin == -1).all()


def test_normals_are_kept_where_all_parts_have_some() -> None:
    up = FLAT.with_vertices(FLAT.vertices, np.tile([0.0, 0.0, 1.0], (3, 1)))
    down = FLAT.with_vertices(FLAT.vertices, np.tile([0.0, 0.0, -1.0], (3, 1)))
    normals = disjoint_union([up, down]).normals
    assert normals is not None
    assert normals[:, 2].tolist() == [1.0, 1.0, 1.0, -1.0, -1.0, -1.0]
    assert disjoint_union([up, FLAT]).normals is None
