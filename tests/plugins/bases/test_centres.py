"""Centres and supports of bumps: where the first one lies, and how supports are smoothed, by brute force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import reference_surfaces as surfaces
from orbiframe_bases.gaussian import Gaussian
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from orbiframe import Triangulation


def uneven(name: str) -> Triangulation:
    """A triangulation whose vertices in space are moved, so that no two distances are equal."""
    made = surfaces.triangulated(name, 3)
    mesh = made.polyhedron
    moved = mesh.vertices + np.random.default_rng(8).normal(scale=0.03, size=mesh.vertices.shape)
    return replace(made, polyhedron=mesh.with_vertices(moved))


@pytest.mark.parametrize("name", list(surfaces.ALL))
def test_the_first_centre_is_the_vertex_farthest_from_the_centroid(name: str) -> None:
    made = uneven(name)
    vertices = made.polyhedron.vertices
    farthest = np.argmax(np.linalg.norm(vertices - vertices.mean(axis=0), axis=1))
    basis = Gaussian(made.orbifold, made, size=1)
    np.testing.assert_array_equal(basis.centres.x, made.points[[farthest]])


@pytest.mark.parametrize("name", ["torus", "octagon"])
def test_supports_are_geometric_means_over_neighbouring_parts(name: str) -> None:
    """Twice half of the logarithm itself and half of the mean of its neighbours; the parts by Dijkstra's method."""
    made, reach, width = uneven(name), 3.0, 2.0
    basis = Gaussian(made.orbifold, made, size=12, reach=reach, width=width, grading=0.0)
    mesh, count = made.polyhedron, len(made.points)
    chosen = [int(np.abs(made.points - x).max(axis=1).argmin()) for x in basis.centres.x]
    length = np.linalg.norm(mesh.vertices[mesh.head] - mesh.vertices[mesh.tail], axis=1)
    graph = coo_array((length, (mesh.tail, mesh.head)), shape=(count, count)).tocsr()
    owner = dijkstra(graph, indices=chosen).argmin(axis=0)
    share = np.zeros(12)
    for face, area in zip(mesh.triangles, made.areas, strict=True):
        for corner in face:
            share[owner[corner]] += area / 3
    linked = np.zeros((12, 12))
    linked[owner[mesh.tail], owner[mesh.head]] = 1
    np.fill_diagonal(linked, 0)
    mean = (np.eye(12) + linked / linked.sum(axis=1, keepdims=True)) / 2
    smoothed = np.exp(mean @ mean @ np.log(share))
    assert np.ptp(np.log(share)) > 1.5 * np.ptp(np.log(smoothed))
    np.testing.assert_allclose(basis.support, (reach * width) ** 2 / 2 * smoothed, rtol=1e-9)
