"""Refinement: same surface, same area, and places on the coarse mesh against their definition."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_polyhedra import random_triangle_meshes

from orbiframe.errors import TopologyError
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.fans import fan_labels
from orbiframe.meshes.orientation import reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.meshes.subdivision import refine
from orbiframe.meshes.surface_type import surface_type
from orbiframe.testing.polyhedra import reference_polyhedra

SEEDS = st.integers(0, 2**32 - 1)


def mixed(mesh: Polyhedron, seed: int) -> Polyhedron:
    return reversed_faces(mesh, np.random.default_rng(seed).random(mesh.face_count) < 0.5)


@settings(max_examples=40, deadline=None)
@given(random_triangle_meshes(8), st.integers(1, 5), SEEDS)
def test_refined_surface_is_the_same(mesh: Polyhedron, density: int, seed: int) -> None:
    coarse = mixed(mesh, seed)
    fine = refine(coarse, density).polyhedron
    assert surface_type(fine) == surface_type(coarse)
    k, v, e, f = density, len(mesh.vertices), mesh.edge_count, mesh.face_count
    assert (len(fine.vertices), fine.edge_count, fine.face_count) == (
        v + e * (k - 1) + f * (k - 1) * (k - 2) // 2,
        e * k + 3 * f * k * (k - 1) // 2,
        f * k**2,
    )
    parts = np.repeat(vector_areas(coarse) / k**2, k**2, axis=0)
    np.testing.assert_allclose(vector_areas(fine), parts, atol=1e-12)


@settings(max_examples=20, deadline=None)
@given(random_triangle_meshes(8), st.integers(1, 5), SEEDS)
def test_twins_are_those_of_the_vertices(mesh: Polyhedron, density: int, seed: int) -> None:
    """Where no two edges of the mesh have the same ends, the ends alone tell the twins."""
    fine = refine(mixed(mesh, seed), density).polyhedron
    twin, same = fine.twin, fine.same
    np.testing.assert_array_equal(twin[twin], np.arange(len(twin)))
    np.testing.assert_array_equal(fine.tail, np.where(same, fine.tail[twin], fine.head[twin]))
    np.testing.assert_array_equal(fine.head, np.where(same, fine.head[twin], fine.tail[twin]))
    if np.array_equal(Polyhedron.from_faces(mesh.vertices, mesh.triangles).twin, mesh.twin):
        again = Polyhedron.from_faces(fine.vertices, fine.triangles)
        np.testing.assert_array_equal(again.twin, twin)
        np.testing.assert_array_equal(again.same, same)


@settings(max_examples=20, deadline=None)
@given(random_triangle_meshes(8), st.integers(1, 5))
def test_vertices_lie_where_face_and_barycentric_say(mesh: Polyhedron, density: int) -> None:
    result = refine(mesh, density)
    corners = mesh.vertices[mesh.triangles[result.face]]
    np.testing.assert_allclose(
        result.polyhedron.vertices, np.einsum("nc,nci->ni", result.barycentric, corners), atol=1e-14
    )
    np.testing.assert_allclose(result.barycentric.sum(axis=1), 1, atol=1e-15)
    grid = result.barycentric * density
    np.testing.assert_allclose(grid, np.round(grid), atol=1e-12)
    assert (grid >= 0).all()
    np.testing.assert_array_equal(result.polyhedron.vertices[: len(mesh.vertices)], mesh.vertices)
    own = mesh.triangles[result.face[: len(mesh.vertices)]]
    np.testing.assert_array_equal(
        (own * (result.barycentric[: len(mesh.vertices)] == 1)).sum(axis=1), np.arange(len(own))
    )


@settings(max_examples=20, deadline=None)
@given(random_triangle_meshes(8), st.integers(1, 5))
def test_the_first_face_speaks_for_a_vertex(mesh: Polyhedron, density: int) -> None:
    result = refine(mesh, density)
    first = np.full(len(result.polyhedron.vertices), mesh.face_count)
    for corner, face in zip(result.polyhedron.tail, result.polyhedron.face // density**2, strict=True):
        first[corner] = min(first[corner], face)
    np.testing.assert_array_equal(result.face, first)


@settings(max_examples=20, deadline=None)
@given(random_triangle_meshes(8), st.integers(1, 4))
def test_fine_triangles_lie_in_their_coarse_one(mesh: Polyhedron, density: int) -> None:
    fine = refine(mesh, density).polyhedron
    parts = fine.vertices[fine.triangles].reshape(mesh.face_count, -1, 3)
    corners = mesh.vertices[mesh.triangles]
    for points, triangle in zip(parts, corners, strict=True):
        weights = np.linalg.lstsq(np.vstack([triangle.T, np.ones(3)]), np.vstack([points.T, np.ones(len(points))]))[0]
        assert (weights > -1e-7).all()


def one_vertex_complex(word: str) -> Polyhedron:
    """The polygon of a gluing word, starred from its centre: all corners of the polygon are one or few vertices.

    A letter and the same letter in capitals run against each other along the boundary, equal letters run alike.
    """
    n = len(word)
    mates = [next(j for j in range(n) if j != i and word[j].lower() == word[i].lower()) for i in range(n)]
    twin = np.full(3 * n, -1)
    same = np.zeros(3 * n, dtype=bool)
    for i in range(n):
        twin[3 * i], same[3 * i] = 3 * mates[i], word[i] == word[mates[i]]
        twin[3 * i + 1], twin[3 * ((i + 1) % n) + 2] = 3 * ((i + 1) % n) + 2, 3 * i + 1
    loose = Polyhedron(np.zeros((3 * n, 3)), np.arange(n + 1) * 3, np.arange(3 * n), twin, same)
    count, label = fan_labels(loose)
    return Polyhedron(np.random.default_rng(2).normal(size=(count, 3)), loose.offsets, label, twin, same)


@pytest.mark.parametrize(
    ("word", "vertices", "chi", "orientable"),
    [
        ("abAB", 1, 0, True),
        ("abABcdCD", 1, -2, True),
        ("aabb", 1, 0, False),
        ("abAb", 1, 0, False),
        ("aabbcc", 1, -1, False),
        ("abab", 2, 1, False),
        ("aAbB", 3, 2, True),
    ],
)
@pytest.mark.parametrize("density", [1, 2, 3, 4])
def test_complexes_with_one_vertex(word: str, vertices: int, chi: int, orientable: bool, density: int) -> None:
    coarse = one_vertex_complex(word)
    assert len(coarse.vertices) == vertices + 1
    for mesh in (coarse, refine(coarse, density).polyhedron):
        kind = surface_type(mesh)
        assert (kind.euler_characteristic, kind.orientable, kind.closed) == (chi, orientable, True)
        assert kind.genus == (2 - chi if not orientable else (2 - chi) // 2)


def test_density_one_keeps_the_mesh() -> None:
    mesh = reference_polyhedra()["torus"]
    fine = refine(mesh, 1).polyhedron
    for name in ("vertices", "offsets", "tail", "twin", "same"):
        np.testing.assert_array_equal(getattr(fine, name), getattr(mesh, name))


@pytest.mark.parametrize("density", [1, 2, 5])
def test_boundary_stays_boundary(density: int) -> None:
    mesh = triangulated(Polyhedron.from_faces(np.eye(4)[:, :3], [[0, 1, 2, 3]]))
    fine = refine(mesh, density).polyhedron
    assert (fine.twin < 0).sum() == 4 * density
    assert surface_type(fine) == surface_type(mesh)


@pytest.mark.parametrize("density", [1, 3])
def test_vertices_in_no_face_stay_where_they_are(density: int) -> None:
    mesh = reference_polyhedra()["tetrahedron"]
    vertices = np.vstack([[[7, 7, 7]], mesh.vertices, [[8, 8, 8]]])
    result = refine(Polyhedron.from_faces(vertices, mesh.triangles + 1), density)
    np.testing.assert_array_equal(result.polyhedron.vertices[:6], vertices)
    assert surface_type(result.polyhedron) == surface_type(mesh)


def test_what_cannot_be_refined_is_refused() -> None:
    with pytest.raises(TopologyError, match="refinement of 0"):
        refine(reference_polyhedra()["tetrahedron"], 0)
    with pytest.raises(TopologyError, match="triangulated"):
        refine(reference_polyhedra()["cube"], 2)
