"""Seams and T-junctions of meshes that were taken apart."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_polyhedra import face_lists, random_polyhedra

from orbiframe.meshes.open_edges import open_halfedges, seams
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.polyhedra import reference_polyhedra

SEEDS = st.integers(0, 2**32 - 1)


def taken_apart(mesh: Polyhedron, noise: float = 0.0, seed: int = 0) -> Polyhedron:
    """Every face on vertices of its own, each moved by at most the noise along each axis."""
    points = mesh.vertices[mesh.tail]
    shift = np.random.default_rng(seed).uniform(-noise, noise, points.shape)
    return Polyhedron.from_corners(points + shift, mesh.offsets, np.arange(len(mesh.tail)))


def wall(columns: int, rows: int) -> Polyhedron:
    """Bricks, each row half a brick beyond the one below, each with its four corners only."""
    bricks = [(c + (r % 2) / 2, r) for r in range(rows) for c in range(columns)]
    corners = [[(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)] for x, y in bricks]
    number = {point: i for i, point in enumerate(sorted({p for brick in corners for p in brick}))}
    return Polyhedron.from_faces([(*p, 0.0) for p in number], [[number[p] for p in brick] for brick in corners])


@settings(max_examples=30, deadline=None)
@given(random_polyhedra(), SEEDS, st.sampled_from([0.0, 1e-12, 1e-8]))
def test_a_mesh_taken_apart_is_all_seam(mesh: Polyhedron, seed: int, noise: float) -> None:
    found = seams(taken_apart(mesh, noise, seed))
    assert found.vertices.tolist() == list(range(len(mesh.tail)))
    assert found.closed == len(mesh.tail)
    assert len(found.junctions) == 0
    assert found.tolerance <= 8 * np.sqrt(3) * 2 * noise
    assert (found.tolerance == 0) == (noise == 0)


@settings(max_examples=30, deadline=None)
@given(random_polyhedra(), SEEDS)
def test_closed_meshes_and_meshes_with_holes_have_no_seam(mesh: Polyhedron, seed: int) -> None:
    assert seams(mesh).closed == 0
    faces = face_lists(mesh)
    faces.pop(seed % len(faces))
    torn = Polyhedron.from_faces(mesh.vertices, faces)
    assert (seams(torn).closed, len(seams(torn).vertices)) == (0, 0)


def test_boundaries_that_touch_in_a_point_are_no_seam() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [-1, 0, 0], [0, -1, 0.0]])
    assert seams(Polyhedron.from_faces(points, [[0, 1, 2], [3, 4, 5]])).closed == 0


def test_only_the_cut_is_a_seam() -> None:
    """Two squares whose common edge has vertices of its own on either side."""
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0]]
    found = seams(Polyhedron.from_faces(points, [[0, 1, 2, 3], [4, 5, 6, 7]]))
    assert (found.vertices.tolist(), found.closed, found.tolerance) == ([1, 2, 4, 7], 2, 0)


@pytest.mark.parametrize("gap", [0.0, 1e-9, 1e-4])
def test_a_vertex_inside_an_edge_is_a_junction(gap: float) -> None:
    points = [
        [0, 0, 0],
        [2, 0, 0],
        [2, 1, 0],
        [0, 1, 0],
        [1, gap / 3, 0],
        [0, -1, 0],
        [1, -1, 0],
        [2, -1, 0],
        [2, 0, gap],
    ]
    mesh = Polyhedron.from_faces(points, [[0, 1, 2, 3], [5, 6, 4, 0], [6, 7, 8, 4]])
    assert [4, 0, 1] in seams(mesh).junctions.tolist()


def test_every_joint_of_a_brick_wall_is_a_junction() -> None:
    columns, rows = 6, 5
    mesh = wall(columns, rows)
    found = seams(mesh)
    # Between two rows every brick's edge has one corner of the other row inside, on either side.
    assert len(found.junctions) == 2 * columns * (rows - 1)
    x, a, b = mesh.vertices[found.junctions.T][..., 0]
    assert (np.minimum(a, b) + 0.4 < x).all()
    assert (x < np.maximum(a, b) - 0.4).all()


@pytest.mark.parametrize("scale", [1e-300, 1e-150, 1e150, 1e300])
def test_seams_do_not_depend_on_the_scale(scale: float) -> None:
    apart = taken_apart(reference_polyhedra()["prism"], 1e-6)
    found = seams(apart.with_vertices(apart.vertices * scale))
    assert found.closed == 30
    assert scale * 1e-7 < found.tolerance < scale * 1e-4


def test_many_long_edges_end_the_search_in_time_and_are_no_seam() -> None:
    points = np.random.default_rng(1).random((9000, 3))
    found = seams(Polyhedron.from_faces(points, np.arange(9000).reshape(-1, 3)))
    assert not found.complete
    assert found.closed == 0


def test_open_halfedges_leave_out_shared_and_crowded_edges() -> None:
    points = np.random.default_rng(2).random((6, 3))
    fan = Polyhedron.from_faces(points, [[0, 1, 2], [0, 1, 3], [1, 0, 4], [2, 0, 5]])
    ends = {frozenset((int(fan.tail[h]), int(fan.head[h]))) for h in open_halfedges(fan)}
    assert ends == {frozenset(e) for e in [(1, 2), (1, 3), (0, 3), (0, 4), (1, 4), (0, 5), (2, 5)]}


def test_coordinates_that_are_not_finite_have_no_seams() -> None:
    assert seams(Polyhedron.from_faces([[0, 0, 0], [1, np.nan, 0], [0, 1, 0]], [[0, 1, 2]])).closed == 0
