"""Bisection: short edges, no thin triangles, the same surface, and points found again."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_polyhedra import random_triangle_meshes
from signed_faces import WORDS, fan, wandering

from orbiframe.errors import TopologyError
from orbiframe.meshes.bisection import bisected, edge_length_for
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.orientation import reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.meshes.subdivision import refine
from orbiframe.meshes.surface_type import doubled_edges, surface_type
from orbiframe.testing.polyhedra import reference_polyhedra

SEEDS = st.integers(0, 2**32 - 1)
PARTS = st.sampled_from([0.1, 0.25, 0.6, 1.5])


def mixed(mesh: Polyhedron, seed: int) -> Polyhedron:
    return reversed_faces(mesh, np.random.default_rng(seed).random(mesh.face_count) < 0.5)


def angles(mesh: Polyhedron) -> np.ndarray:
    """The angles of all triangles, (F, 3), by the law of cosines."""
    a, b, c = mesh.edge_lengths.reshape(-1, 3).T
    opposite = [
        (b**2 + c**2 - a**2) / (2 * b * c),
        (c**2 + a**2 - b**2) / (2 * c * a),
        (a**2 + b**2 - c**2) / (2 * a * b),
    ]
    return np.arccos(np.clip(np.stack(opposite, axis=1), -1, 1))


@settings(max_examples=30, deadline=None)
@given(random_triangle_meshes(8), PARTS, SEEDS)
def test_edges_are_short_and_the_surface_is_the_same(mesh: Polyhedron, part: float, seed: int) -> None:
    coarse = mixed(mesh, seed)
    longest = part * coarse.edge_lengths.max()
    fine = bisected(coarse, longest).polyhedron
    assert fine.edge_lengths.max() <= longest
    assert surface_type(fine) == surface_type(coarse)
    np.testing.assert_array_equal(fine.twin[fine.twin], np.arange(len(fine.twin)))
    np.testing.assert_array_equal(fine.tail, np.where(fine.same, fine.tail[fine.twin], fine.head[fine.twin]))
    np.testing.assert_array_equal(fine.vertices[: len(mesh.vertices)], mesh.vertices)
    if part > 1:
        np.testing.assert_array_equal(fine.triangles, coarse.triangles)


@settings(max_examples=30, deadline=None)
@given(st.sampled_from(sorted(WORDS)), SEEDS, st.sampled_from([0, 15, 60]), st.sampled_from([0.4, np.inf]))
def test_cells_with_common_edges_become_a_simplicial_complex(name: str, seed: int, steps: int, part: float) -> None:
    """Loops, edges with the same ends, faces that meet themselves: afterwards three vertices have at most one face."""
    coarse = wandering(WORDS[name], seed, steps).polyhedron()
    forest = bisected(coarse, part * coarse.edge_lengths.max() or np.inf, True)
    fine = forest.polyhedron
    assert surface_type(fine) == surface_type(coarse)
    assert not doubled_edges(fine).any()
    corners = np.sort(fine.triangles, axis=1)
    assert (np.diff(corners, axis=1) > 0).all()
    assert len(np.unique(corners, axis=0)) == len(corners) or fine.face_count == 2
    ends = np.sort(np.stack([fine.tail, fine.head]), axis=0)[:, fine.representative]
    assert len(np.unique(ends, axis=1).T) == fine.edge_count
    rng = np.random.default_rng(seed)
    face = rng.integers(coarse.face_count, size=50)
    weights = rng.dirichlet(np.ones(3), size=50)
    there, fine_weights = forest.locate(face, weights)
    first = np.einsum("nc,nci->ni", weights, coarse.vertices[coarse.triangles[face]])
    second = np.einsum("nc,nci->ni", fine_weights, fine.vertices[fine.triangles[there]])
    np.testing.assert_allclose(first, second, atol=1e-12)


@pytest.mark.parametrize("name", ["torus", "Klein bottle", "genus 3", "4 crosscaps"])
def test_a_simplicial_complex_is_made_of_one_vertex_too(name: str) -> None:
    coarse = fan(WORDS[name]).polyhedron()
    assert doubled_edges(coarse).all()
    fine = bisected(coarse, np.inf, True).polyhedron
    assert not doubled_edges(fine).any()
    assert surface_type(fine) == surface_type(coarse)
    assert bisected(fine, np.inf, True).polyhedron.face_count == fine.face_count


@settings(max_examples=30, deadline=None)
@given(random_triangle_meshes(6), st.sampled_from([0.05, 0.1, 0.3]))
def test_no_angle_falls_below_half_the_least(mesh: Polyhedron, part: float) -> None:
    """Rosenberg and Stenger (1975) for halving the longest side again and again."""
    fine = bisected(mesh, part * mesh.edge_lengths.max()).polyhedron
    assert angles(fine).min() >= angles(mesh).min() / 2 * (1 - 1e-9)


@settings(max_examples=30, deadline=None)
@given(random_triangle_meshes(8), PARTS, SEEDS)
def test_a_point_keeps_its_position_in_space(mesh: Polyhedron, part: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    coarse = mixed(mesh, seed)
    forest = bisected(coarse, part * coarse.edge_lengths.max())
    face = rng.integers(mesh.face_count, size=300)
    barycentric = rng.dirichlet([0.3, 0.3, 0.3], size=300)
    barycentric[:60] = np.eye(3)[rng.integers(3, size=60)]
    barycentric[60:120, 2] = 0
    barycentric[60:120, :2] = np.array([0.5, 0.5])
    found, weights = forest.locate(face, barycentric)
    fine = forest.polyhedron
    before = np.einsum("nc,nci->ni", barycentric, coarse.vertices[coarse.triangles[face]])
    after = np.einsum("nc,nci->ni", weights, fine.vertices[fine.triangles[found]])
    np.testing.assert_allclose(after, before, atol=1e-13)
    assert (weights >= 0).all()
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-14)


@settings(max_examples=20, deadline=None)
@given(random_triangle_meshes(6), SEEDS)
def test_fine_triangles_tile_their_coarse_one(mesh: Polyhedron, seed: int) -> None:
    forest = bisected(mixed(mesh, seed), 0.3 * mesh.edge_lengths.max())
    fine = forest.polyhedron
    owner = np.arange(len(forest.side))
    inner = np.flatnonzero(forest.side >= 0)
    for node in inner:  # children stand behind their parents
        owner[forest.child[node] : forest.child[node] + 2] = owner[node]
    leaves = np.flatnonzero(forest.side < 0)
    np.testing.assert_array_equal(np.sort(forest.child[leaves]), np.arange(fine.face_count))
    total = np.zeros((mesh.face_count, 3))
    np.add.at(total, owner[leaves], vector_areas(fine)[forest.child[leaves]])
    np.testing.assert_allclose(total, vector_areas(forest.coarse), atol=1e-12)


def test_a_right_triangle_is_halved_across_its_longest_side() -> None:
    """Two unit right triangles back to back: the two hypotenuses of length sqrt 2 coincide, so one cut each."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=float)
    pillow = Polyhedron.from_faces(corners, [[0, 1, 2], [2, 1, 0]])
    fine = bisected(pillow, 1.2).polyhedron
    assert fine.face_count == 4
    np.testing.assert_array_equal(fine.vertices[3:], [[0.5, 0.5, 0]])


def test_the_same_mesh_gives_the_same_bits() -> None:
    mesh = refine(triangulated(reference_polyhedra()["double torus"]), 2).polyhedron
    first, second = (bisected(mesh, 0.2) for _ in range(2))
    for name in ("side", "child"):
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))
    np.testing.assert_array_equal(first.polyhedron.vertices, second.polyhedron.vertices)


@pytest.mark.parametrize("vertices", [500, 4000])
def test_edge_length_gives_about_so_many_vertices(vertices: int) -> None:
    for mesh in map(triangulated, reference_polyhedra().values()):
        made = len(bisected(mesh, edge_length_for(mesh, vertices)).polyhedron.vertices)
        assert 0.7 * vertices <= made <= 3 * vertices


@pytest.mark.parametrize("length", [1e2, 1e4, 1e6])
@pytest.mark.parametrize("name", ["tetrahedron", "cube"])
def test_needles_do_not_ask_for_endless_vertices(name: str, length: float) -> None:
    mesh = triangulated(reference_polyhedra()[name])
    needle = mesh.with_vertices(mesh.vertices * [length, 1, 1])
    made = len(bisected(needle, edge_length_for(needle, 1000)).polyhedron.vertices)
    assert 1000 <= made <= 30_000


def test_a_mesh_without_area_has_an_edge_length() -> None:
    flat = reference_polyhedra()["tetrahedron"]
    assert edge_length_for(flat.with_vertices(flat.vertices * [1, 0, 0]), 1000) > 0


@pytest.mark.parametrize("longest", [0.0, -1.0, np.nan])
def test_a_length_that_is_not_positive_is_refused(longest: float) -> None:
    with pytest.raises(TopologyError, match="must be positive"):
        bisected(reference_polyhedra()["tetrahedron"], longest)


def test_an_open_mesh_is_refused() -> None:
    with pytest.raises(TopologyError, match="closed"):
        bisected(Polyhedron.from_faces(np.eye(3), [[0, 1, 2]]), 0.1)
