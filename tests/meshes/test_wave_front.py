"""Distances along meshes: in the plane, round a cube's edges, on a cone, on the sphere, and the flow of heat."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from orbiframe.errors import GeometryError
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.heat_distance import heat_distances
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.subdivision import refine
from orbiframe.meshes.wave_front import front_distances, through_sides

OCTAHEDRON = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]


def sphere(density: int) -> Polyhedron:
    fine = refine(Polyhedron.from_faces(np.concatenate([np.eye(3), -np.eye(3)]), OCTAHEDRON), density).polyhedron
    return fine.with_vertices(fine.vertices / np.linalg.norm(fine.vertices, axis=1, keepdims=True))


def plane_grid(count: int, height=lambda x, y: 0 * x) -> Polyhedron:
    """A square of side 1 in triangles of irregular shape."""
    i, j = np.divmod(np.arange((count + 1) ** 2), count + 1)
    inner = ((i > 0) & (i < count) & (j > 0) & (j < count))[:, None]
    x = np.stack([i, j], axis=1) / count + inner * np.random.default_rng(0).uniform(-0.2, 0.2, (len(i), 2)) / count
    k = np.flatnonzero((i < count) & (j < count))
    faces = np.concatenate([np.stack([k, k + count + 1, k + count + 2], 1), np.stack([k, k + count + 2, k + 1], 1)])
    return Polyhedron.from_faces(np.column_stack([x, height(x[:, 0], x[:, 1])]), faces.tolist())


def test_in_the_plane_it_is_exact():
    mesh = plane_grid(20)
    source = 0
    found = front_distances(mesh, np.array([source]), np.zeros(1))
    np.testing.assert_allclose(found, np.linalg.norm(mesh.vertices - mesh.vertices[source], axis=1), atol=1e-12)


def test_over_a_fold_it_is_exact():
    """A sheet that is bent along a line unfolds into the plane."""
    flat = plane_grid(20)
    x = flat.vertices
    # The line runs along edges: the column of vertices in the middle is put on it.
    middle = np.arange(21) + 10 * 21
    x[middle, 0] = 0.5
    beyond = np.maximum(x[:, 0] - 0.5, 0)
    bent = flat.with_vertices(np.column_stack([np.minimum(x[:, 0], 0.5), x[:, 1], beyond]))
    found = front_distances(bent, np.array([0]), np.zeros(1))
    np.testing.assert_allclose(found, np.linalg.norm(x - x[0], axis=1), atol=1e-12)


def test_on_the_sphere_the_error_falls_with_the_size():
    errors = []
    for density in (8, 16, 32):
        mesh = sphere(density)
        found = front_distances(mesh, np.array([7]), np.zeros(1))
        exact = np.arccos(np.clip(mesh.vertices @ mesh.vertices[7], -1, 1))
        errors.append(np.abs(found - exact).max())
    assert errors[2] < 0.015 * np.pi
    assert errors[1] < 0.65 * errors[0]
    assert errors[2] < 0.65 * errors[1]


def test_several_sources_other_parts_and_a_ring_without_orientation():
    """The nearest source counts; what no face joins is infinitely far; a Moebius band has ways through its twist."""
    mesh = sphere(6)
    both = np.concatenate([mesh.vertices, mesh.vertices + 5])
    pair = Polyhedron.from_faces(both, [*mesh.triangles.tolist(), *(mesh.triangles + len(mesh.vertices)).tolist()])
    ends = np.array([0, 3])
    one, other, joined = (front_distances(pair, ends[k], np.zeros(len(ends[k]))) for k in ([0], [1], [0, 1]))
    np.testing.assert_array_equal(joined, np.minimum(one, other))
    assert np.isinf(joined[len(mesh.vertices) :]).all()
    count = 60
    u = 2 * np.pi * np.arange(count) / count
    edge = np.array([1.0, -1.0])[:, None, None] * 0.1
    across = np.stack([np.cos(u / 2) * np.cos(u), np.cos(u / 2) * np.sin(u), np.sin(u / 2)], axis=1)
    rows = np.stack([np.cos(u), np.sin(u), 0 * u], axis=1) + edge * across
    quads = [[k, k + 1, count + k + 1, count + k] for k in range(count - 1)] + [[count - 1, count, 0, 2 * count - 1]]
    band = triangulated(Polyhedron.from_faces(rows.reshape(-1, 3), quads))
    found = front_distances(band, np.array([0]), np.zeros(1))
    # Round the band either way: half of its middle line, about.
    assert found.max() == pytest.approx(np.pi, rel=0.1)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=6, max_size=6), st.floats(0.05, 0.95))
def test_one_triangle(numbers, share):
    """Through a side from a point below it is as in the plane; along an end if that misses the side."""
    source, apex = np.array([numbers[0], -abs(numbers[1])]), np.array([numbers[2], 0.05 + abs(numbers[3])])
    start, end = np.array([-1.0, 0.0]), np.array([share, 0.0])
    lengths = [
        np.linalg.norm(p - q) for p, q in ((start, source), (end, source), (end, start), (apex, start), (apex, end))
    ]
    found = through_sides(*(np.array([length]) for length in lengths))[0]
    height = apex[1] - source[1]
    crossing = source[0] + (apex[0] - source[0]) * -source[1] / height
    if -1 + 1e-6 < crossing < share - 1e-6:
        assert found == pytest.approx(np.linalg.norm(apex - source), abs=1e-7)
    elif not -1 - 1e-6 < crossing < share + 1e-6:
        assert found == pytest.approx(min(lengths[0] + lengths[3], lengths[1] + lengths[4]), abs=1e-7)


def test_heat_is_that_of_its_authors_and_near_the_truth():
    """Against potpourri3d, of N. Sharp, where it is installed, and against the sphere."""
    mesh = sphere(16)
    found = heat_distances(mesh, np.array([7]))
    exact = np.arccos(np.clip(mesh.vertices @ mesh.vertices[7], -1, 1))
    assert np.abs(found - exact).max() < 0.03 * np.pi
    assert found[7] == 0
    peer = pytest.importorskip("potpourri3d", reason="potpourri3d is not installed")
    theirs = peer.MeshHeatMethodDistanceSolver(mesh.vertices, mesh.triangles, use_robust=False).compute_distance(7)
    np.testing.assert_allclose(found, theirs, atol=1e-3)


def test_exact_polyhedral_distances_are_met():
    """Against the exact algorithm of pygeodesic (D. Kirsanov), where it is installed, on a bumpy sheet."""
    peer = pytest.importorskip("pygeodesic.geodesic", reason="pygeodesic is not installed")
    mesh = plane_grid(30, lambda x, y: 0.15 * np.sin(7 * x) * np.cos(5 * y))
    exact, _ = peer.PyGeodesicAlgorithmExact(mesh.vertices, mesh.triangles).geodesicDistances(np.array([40]))
    found = front_distances(mesh, np.array([40]), np.zeros(1))
    assert np.abs(found - exact).max() < 0.01 * exact.max()


def test_a_triangle_without_area_has_no_heat():
    mesh = Polyhedron.from_faces(np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0.0]]), [[0, 1, 2], [0, 2, 3]])
    with pytest.raises(GeometryError, match="triangle 0 has no area"):
        heat_distances(mesh, np.array([3]))
