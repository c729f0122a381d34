"""Edge weights against linear elements, linear functions and equilateral triangles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_parametrizers.edge_weights import WEIGHTS, cotangent, mean_value, uniform
from reference_meshes import connected_sum, dataset, platonic, shuffled

from orbiframe import Polyhedron


def stiffness(mesh) -> np.ndarray:
    """The integrals of the products of gradients of the hat functions, triangle by triangle."""
    total = np.zeros((len(mesh.vertices),) * 2)
    for face in mesh.triangles:
        p = mesh.vertices[face]
        along = np.stack([p[1] - p[0], p[2] - p[0]], axis=1)
        gram = along.T @ along
        area = np.sqrt(np.linalg.det(gram)) / 2
        # Hat functions are 1 - s - t, s, t in coordinates s, t along the two sides.
        slopes = np.array([[-1.0, -1], [1, 0], [0, 1]])
        total[np.ix_(face, face)] += area * slopes @ np.linalg.inv(gram) @ slopes.T
    return total


def laplacian(mesh, weights) -> np.ndarray:
    once = mesh.representative
    total = np.zeros((len(mesh.vertices),) * 2)
    np.add.at(total, (mesh.tail[once], mesh.head[once]), -weights[once])
    total += total.T
    return total - np.diag(total.sum(axis=1))


@settings(max_examples=20, deadline=None)
@given(st.sampled_from(["T", "TT", "PPP"]), st.integers(0, 10), st.integers(0, 2**32 - 1))
def test_cotangents_are_the_stiffness_matrix_of_linear_elements(parts, moves, seed):
    rng = np.random.default_rng(seed)
    mesh = shuffled(connected_sum(parts), moves, rng)
    mesh = mesh.with_vertices(rng.normal(size=mesh.vertices.shape))
    exact = stiffness(mesh)
    assert np.allclose(laplacian(mesh, cotangent(mesh)), exact, rtol=0, atol=1e-9 * np.abs(exact).max())


def flat_pillow(rng) -> Polyhedron:
    """Two random triangulations of a square on top of each other, glued along the rim; vertices 4 to 13 are inside."""
    corners = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    inner = np.array([[0.5, 0.5]]) + 0.2 * rng.normal(size=(1, 2)).clip(-1, 1)
    vertices = np.vstack([corners, inner, [[0.5, 0.5]]])
    faces = [[i, (i + 1) % 4, 4] for i in range(4)] + [[(i + 1) % 4, i, 5] for i in range(4)]
    mesh = Polyhedron.from_faces(np.column_stack([vertices, np.zeros(6)]), faces)
    for _ in range(6):
        mesh = split_inside(mesh, rng)
    return mesh


def split_inside(mesh, rng) -> Polyhedron:
    """A vertex at a random place in a random face."""
    face = int(rng.integers(mesh.face_count))
    a, b, c = mesh.triangles[face]
    place = rng.dirichlet([3.0, 3.0, 3.0]) @ mesh.vertices[[a, b, c]]
    fresh = len(mesh.vertices)
    faces = np.vstack([np.delete(mesh.triangles, face, axis=0), [[a, b, fresh], [b, c, fresh], [c, a, fresh]]])
    return Polyhedron.from_faces(np.vstack([mesh.vertices, place]), faces)


@pytest.mark.parametrize("seed", range(5))
def test_linear_functions_are_harmonic_for_cotangents_where_the_mesh_is_flat(seed):
    mesh = flat_pillow(np.random.default_rng(seed))
    values = mesh.vertices @ np.array([2.0, -3.0, 0.0])
    residual = laplacian(mesh, cotangent(mesh)) @ values
    assert np.abs(residual[4:]).max() < 1e-10


@settings(max_examples=20, deadline=None)
@given(st.sampled_from(["T", "TT", "PPP"]), st.integers(0, 2**32 - 1))
def test_mean_values_are_positive_and_symmetric(parts, seed):
    mesh = connected_sum(parts)
    mesh = mesh.with_vertices(np.random.default_rng(seed).normal(size=mesh.vertices.shape))
    weights = mean_value(mesh)
    assert (weights > 0).all()
    assert np.array_equal(weights, weights[mesh.twin])


def test_mean_values_are_the_mean_of_floaters_coordinates():
    """At each end: the tangents of half of the two angles beside the edge over its length (Floater 2003)."""
    mesh = dataset("plate_genus2_coarse")
    p, weights = mesh.vertices, mean_value(mesh)

    def angle(at: int, i: int, j: int) -> float:
        u, v = p[i] - p[at], p[j] - p[at]
        return float(np.arccos(u @ v / np.linalg.norm(u) / np.linalg.norm(v)))

    for h in range(0, len(mesh.tail), 7):
        i, j = int(mesh.tail[h]), int(mesh.head[h])
        k, l_ = (int(mesh.tail[mesh.next[mesh.next[side]]]) for side in (h, mesh.twin[h]))
        ends = [sum(np.tan(angle(at, other, far) / 2) for far in (k, l_)) for at, other in ((i, j), (j, i))]
        assert weights[h] == pytest.approx(sum(ends) / (2 * np.linalg.norm(p[i] - p[j])), rel=1e-9)


def test_equilateral_triangles():
    mesh = platonic("icosahedron")
    length = mesh.edge_lengths[0]
    assert np.allclose(cotangent(mesh), 1 / np.sqrt(3))
    assert np.allclose(mean_value(mesh), 2 / np.sqrt(3) / length)
    assert np.array_equal(uniform(mesh), np.ones(60))


@pytest.mark.parametrize("name", WEIGHTS)
def test_coincident_vertices_are_seen_in_the_weights(name):
    mesh = platonic("octahedron")
    vertices = mesh.vertices.copy()
    vertices[1] = vertices[0]
    weights = WEIGHTS[name](mesh.with_vertices(vertices))
    assert np.isfinite(weights).all() == (name == "uniform")


@pytest.mark.parametrize("height", [1e-5, 1e-9])
def test_thin_triangles_have_accurate_mean_values(height):
    """A flat diamond: at its sharp ends half angles are h/2, at its blunt ones pi/2 - h up to h^3."""
    vertices = np.array([[1.0, 0, 0], [-1, 0, 0], [0, height, 0], [0, -height, 0]])
    mesh = Polyhedron.from_faces(vertices, [[0, 2, 3], [1, 3, 2], [0, 3, 1], [0, 1, 2]])
    long_edge = (mesh.tail == 0) & (mesh.head == 1)
    assert mean_value(mesh)[long_edge] == pytest.approx(4 * (height / 2) / (2 * 2), rel=1e-6)
