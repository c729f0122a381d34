"""Distances to meshes against brute force over densely cut triangles."""

from __future__ import annotations

import numpy as np
import pytest

from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.meshes.subdivision import refine
from orbiframe.testing.polyhedra import reference_polyhedra


def test_distances_to_a_cube_are_known() -> None:
    cube = triangulated(reference_polyhedra()["cube"])
    low, high = cube.vertices.min(axis=0), cube.vertices.max(axis=0)
    points = np.random.default_rng(0).uniform(low - 1, high + 1, size=(2000, 3))
    outside = np.linalg.norm(points - np.clip(points, low, high), axis=1)
    inside = np.minimum(points - low, high - points).min(axis=1)
    np.testing.assert_allclose(NearestPoints(cube).distance(points), np.where(outside > 0, outside, inside), atol=1e-12)


@pytest.mark.parametrize("name", ["double torus", "tetrahedron"])
def test_no_vertex_of_a_fine_mesh_is_nearer(name: str) -> None:
    mesh = triangulated(reference_polyhedra()[name])
    fine = refine(mesh, 40).polyhedron
    points = np.random.default_rng(1).normal(size=(100, 3))
    brute = np.linalg.norm(points[:, None] - fine.vertices, axis=2).min(axis=1)
    found = NearestPoints(mesh).distance(points)
    assert (found <= brute + 1e-12).all()
    assert (brute - found < 0.6 * mesh.edge_lengths.max() / 40).all()


def test_triangles_of_very_different_size_are_all_tried() -> None:
    """The nearest triangle is one with a far centroid."""
    from orbiframe.meshes.polyhedron import Polyhedron

    spots = np.random.default_rng(2).normal(size=(50, 1, 3)) * 0.01 + [5.0, 0.0, 1.0]
    small = (spots + np.array([[0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]])).reshape(-1, 3)
    vertices = np.concatenate([[[-100, -100, 0], [100, -100, 0], [0, 200, 0]], small])
    mesh = Polyhedron.from_faces(vertices, np.arange(len(vertices)).reshape(-1, 3))
    assert NearestPoints(mesh).distance(np.array([[5.0, 0.0, 0.3]]))[0] == pytest.approx(0.3)
