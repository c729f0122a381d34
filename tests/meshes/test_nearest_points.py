"""Distances to meshes against brute force over densely cut triangles."""

from __future__ import annotations

import numpy as np
import pytest
from small_meshes import double_pyramid

from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.meshes.polyhedron import Polyhedron
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
    spots = np.random.default_rng(2).normal(size=(50, 1, 3)) * 0.01 + [5.0, 0.0, 1.0]
    small = (spots + np.array([[0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]])).reshape(-1, 3)
    vertices = np.concatenate([[[-100, -100, 0], [100, -100, 0], [0, 200, 0]], small])
    mesh = Polyhedron.from_faces(vertices, np.arange(len(vertices)).reshape(-1, 3))
    assert NearestPoints(mesh).distance(np.array([[5.0, 0.0, 0.3]]))[0] == pytest.approx(0.3)


def test_in_a_fan_of_needles_few_are_tried() -> None:
    """Not many more for a point among 200,000 triangles than among 2,000; the distance is that to the double cone.

    The points are near the cones, but not near the axis, from where all needles are equally far.
    """
    rng = np.random.default_rng(3)
    r, turn, sign = rng.uniform(0.1, 1, 1000), rng.uniform(0, 2 * np.pi, 1000), rng.choice([-1, 1], 1000)
    on_cones = np.stack([r * np.cos(turn), r * np.sin(turn), sign * (1 - r)], axis=1)
    points = on_cones + 0.03 * rng.uniform(-1, 1, size=(1000, 3))
    down = np.stack([np.hypot(points[:, 0], points[:, 1]), np.abs(points[:, 2])], axis=1)
    share = np.clip((down @ [1, -1] + 1) / 2, 0, 1)
    truth = np.linalg.norm(down - np.stack([share, 1 - share], axis=1), axis=1)
    for n in (1000, 100_000):
        squares, tried = NearestPoints(double_pyramid(n)).searched(points)
        np.testing.assert_allclose(np.sqrt(squares), truth, atol=5 / n**2)
        assert tried < 300 * len(points)


@pytest.mark.long
def test_all_triangles_agree_with_brute_force() -> None:
    """Points, sides and insides of triangles of every shape, those without area too."""
    rng = np.random.default_rng(4)
    corners = rng.normal(size=(301, 3, 3)) * 10 ** rng.uniform(-4, 0, size=(301, 1, 1))
    corners[::7, 2] = corners[::7, 1]
    corners[::11] = corners[::11, :1]
    mesh = Polyhedron.from_faces(corners.reshape(-1, 3), np.arange(903).reshape(-1, 3))
    points, weights = rng.normal(size=(50, 3)), rng.dirichlet([0.3, 0.3, 0.3], size=4000)
    dense = (weights @ corners).reshape(-1, 3)
    brute = np.linalg.norm(points[:, None] - dense, axis=2).min(axis=1)
    found = NearestPoints(mesh).distance(points)
    assert (found <= brute + 1e-12).all()
    np.testing.assert_allclose(found, brute, atol=0.1)
    inside = np.einsum("fk,fkc->fc", rng.dirichlet([1, 1, 1], size=301), corners)
    np.testing.assert_allclose(NearestPoints(mesh).distance(inside), 0, atol=1e-7)
