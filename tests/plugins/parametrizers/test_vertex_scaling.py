"""Vertex scaling: angle sums, convergence, and independence of how a metric is triangulated."""

from __future__ import annotations

import numpy as np
import pytest
from orbiframe_parametrizers.vertex_scaling import scaled

from orbiframe import MapError, Polyhedron
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.subdivision import refine
from orbiframe.meshes.surface_type import surface_type
from orbiframe.testing.polyhedra import reference_polyhedra

HYPERBOLIC = sorted(name for name, p in reference_polyhedra().items() if surface_type(p).euler_characteristic < 0)
SQUARES = [name for name in HYPERBOLIC if (reference_polyhedra()[name].face_sizes == 4).all()]


def mesh_of(name: str, density: int = 3) -> Polyhedron:
    return refine(triangulated(reference_polyhedra()[name]), density).polyhedron


@pytest.mark.parametrize("name", HYPERBOLIC)
@pytest.mark.parametrize("stretch", [1.0, 8.0])
def test_angle_sums_are_full_and_the_area_is_that_of_gauss_and_bonnet(name: str, stretch: float) -> None:
    mesh = mesh_of(name)
    mesh = mesh.with_vertices(mesh.vertices * [stretch, 1.0, 1.0])
    made = scaled(mesh)
    sums = np.bincount(made.triangulation.tail, weights=made.angles, minlength=len(mesh.vertices))
    np.testing.assert_allclose(sums, 2 * np.pi, atol=1e-9)
    area = (np.pi - made.angles.reshape(-1, 3).sum(axis=1)).sum()
    assert area == pytest.approx(-2 * np.pi * surface_type(mesh).euler_characteristic, rel=1e-9)
    assert made.steps <= 20


@pytest.mark.parametrize("name", HYPERBOLIC)
def test_angles_obey_the_hyperbolic_law_of_cosines(name: str) -> None:
    made = scaled(mesh_of(name))
    a, b, c = made.lengths.reshape(-1, 3).T
    # Side k runs from corner k to corner k + 1: the corner between sides 0 and 2 is corner 0, opposite to side 1.
    cosine = (np.cosh(a) * np.cosh(c) - np.cosh(b)) / (np.sinh(a) * np.sinh(c))
    np.testing.assert_allclose(np.cos(made.angles.reshape(-1, 3)[:, 0]), cosine, atol=1e-7)


@pytest.mark.parametrize("shear", [0.0, 0.9])
@pytest.mark.parametrize("name", SQUARES)
def test_metric_does_not_depend_on_the_diagonals_of_flat_faces(name: str, shear: float) -> None:
    """Faces cut either way have the same metric, hence the same lengths between neighbours (discrete uniqueness).

    Sheared squares are no rectangles: only their shorter diagonal is one of the Delaunay triangulation.
    """
    quads = reference_polyhedra()[name]
    quads = quads.with_vertices(quads.vertices @ np.array([[1, 0, 0], [shear, 1, 0], [0, shear, 1]]))
    turned = np.roll(quads.tail.reshape(-1, 4), 1, axis=1)
    ways = [turned[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3), turned[:, [1, 2, 3, 1, 3, 0]].reshape(-1, 3)]
    known = []
    for faces in ways:
        mesh = Polyhedron.from_faces(quads.vertices, faces)
        made = scaled(mesh)
        head = np.roll(made.triangulation.triangles, -1, axis=1).ravel()
        ends = zip(made.triangulation.tail.tolist(), head.tolist(), made.lengths.tolist(), strict=True)
        known.append({frozenset((i, j)): length for i, j, length in ends})
    shared = known[0].keys() & known[1].keys()
    assert len(shared) >= quads.edge_count
    first, second = (np.array([one[edge] for edge in shared]) for one in known)
    np.testing.assert_allclose(first, second, rtol=1e-7)


def test_edges_without_length_are_refused() -> None:
    mesh = mesh_of(HYPERBOLIC[0])
    vertices = mesh.vertices.copy()
    vertices[mesh.head[0]] = vertices[mesh.tail[0]]
    with pytest.raises(MapError, match="positive length"):
        scaled(mesh.with_vertices(vertices))
