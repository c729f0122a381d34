"""Sides of creases: the corners about a vertex that no marked edge parts, and their normals."""

from __future__ import annotations

import numpy as np
import pytest
from creased import cylinder, mesh_of

from orbiframe.meshes.bending import bending, sharp_edges
from orbiframe.meshes.crease_sides import corner_sides, side_normals
from orbiframe.meshes.face_diagonals import triangulated


def test_a_cube_has_three_sides_at_every_corner() -> None:
    cube = mesh_of("cube.off")
    crease = sharp_edges(cube, 90)
    assert crease.sum() == 24
    side = corner_sides(cube, crease)
    assert side.max() + 1 == 24
    normals = side_normals(cube, side)
    np.testing.assert_allclose(np.sort(np.abs(normals), axis=1), np.tile([0, 0, 1], (24, 1)), atol=1e-12)
    for s in range(24):
        assert len(np.unique(cube.tail[side == s])) == 1


@pytest.mark.parametrize(("degrees", "count"), [(89.9, 24), (90, 24), (90.1, 0), (180, 0)])
def test_edges_are_sharp_from_an_angle_on(degrees: float, count: int) -> None:
    assert sharp_edges(mesh_of("cube.off"), degrees).sum() == count


def test_without_marks_every_vertex_is_one_side() -> None:
    mesh = mesh_of("klein_bottle.off")
    side = corner_sides(mesh, np.zeros(len(mesh.tail), dtype=bool))
    assert side.max() + 1 == len(mesh.vertices)
    assert len(np.unique(np.stack([side, mesh.tail], axis=1), axis=0)) == len(mesh.vertices)


def test_one_marked_edge_parts_nothing() -> None:
    """The end of a crease: one goes round it."""
    mesh = mesh_of("projective_plane.off")
    crease = np.zeros(len(mesh.tail), dtype=bool)
    crease[[0, mesh.twin[0]]] = True
    assert corner_sides(mesh, crease).max() + 1 == len(mesh.vertices)


def test_normals_by_angle_do_not_depend_on_diagonals() -> None:
    """On the side of a cylinder they point away from the axis, however its rectangles are cut."""
    mesh = triangulated(cylinder(9))
    crease = sharp_edges(mesh, 60)
    side = corner_sides(mesh, crease)
    normals = side_normals(mesh, side, mesh.vertices)
    first = np.unique(side, return_index=True)[1]
    walls = np.abs(normals[:, 2]) < 0.5
    assert walls.sum() == 18
    radial = mesh.vertices[mesh.tail[first]][walls][:, :2]
    cosine = np.abs((normals[walls, :2] * radial).sum(axis=1)) * 2
    np.testing.assert_allclose(cosine, 1, atol=1e-12)
    by_area = side_normals(mesh, side)[walls, :2]
    assert np.abs((by_area * radial).sum(axis=1)).min() * 2 < 1 - 1e-3
    assert bending(mesh).angle[~crease].max() == pytest.approx(np.radians(40))
