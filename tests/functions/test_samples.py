"""Samples of the coordinate functions: weights are a quadrature rule, positions are those of the mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from orbiframe.functions.samples import coordinate_samples
from orbiframe.meshes.sizes import vector_areas
from orbiframe.testing.reference import RECIPES, reference_triangulations


@pytest.mark.parametrize("name", RECIPES)
def test_weights_integrate_quadratic_functions_over_the_polyhedron(name: str) -> None:
    """Against the rule of the edge midpoints, which is exact for quadratic functions too."""
    mesh = reference_triangulations()[name].polyhedron
    samples = coordinate_samples(reference_triangulations()[name])
    area = np.linalg.norm(vector_areas(mesh), axis=1)
    corners = mesh.vertices[mesh.triangles]
    middles = (corners + np.roll(corners, -1, axis=1)) / 2
    expected = np.einsum("f,fki,fkj->ij", area / 3, middles, middles)
    found = np.einsum("n,ni,nj->ij", samples.weights, samples.values, samples.values)
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())
    assert samples.weights.sum() == pytest.approx(area.sum(), rel=1e-12)


@pytest.mark.parametrize("name", RECIPES)
def test_samples_are_the_vertices_and_the_centroids(name: str) -> None:
    made = reference_triangulations()[name]
    mesh, samples = made.polyhedron, coordinate_samples(made)
    count = len(mesh.vertices)
    np.testing.assert_array_equal(samples.values[:count], mesh.vertices)
    np.testing.assert_allclose(samples.values[count:], mesh.vertices[mesh.triangles].mean(axis=1), atol=1e-14)
    np.testing.assert_array_equal(samples.points.x[:count], made.points)
    middle = made.locate(np.arange(mesh.face_count), np.full((mesh.face_count, 3), 1 / 3))
    np.testing.assert_array_equal(samples.points.x[count:], middle.x)
    np.testing.assert_array_equal(samples.points.patch[count:], middle.patch)


@pytest.mark.parametrize("name", RECIPES)
def test_stretch_is_area_in_x_per_area_in_space(name: str) -> None:
    made = reference_triangulations()[name]
    samples = coordinate_samples(made)
    assert samples.stretch @ samples.weights == pytest.approx(made.orbifold.area, rel=1e-9)
    count = len(made.polyhedron.vertices)
    ratio = made.areas / np.linalg.norm(vector_areas(made.polyhedron), axis=1)
    np.testing.assert_allclose(samples.stretch[count:], ratio, rtol=1e-12)
    for vertex in (0, 1, count - 1):
        faces = np.unique(made.polyhedron.face[made.polyhedron.tail == vertex])
        assert ratio[faces].min() * (1 - 1e-12) <= samples.stretch[vertex] <= ratio[faces].max() * (1 + 1e-12)


def test_places_without_area_are_no_samples() -> None:
    made = reference_triangulations()["torus"]
    mesh = made.polyhedron
    vertices = mesh.vertices.copy()
    a, b, _ = mesh.triangles[0]
    vertices[a] = vertices[b]
    samples = coordinate_samples(replace(made, polyhedron=mesh.with_vertices(vertices)))
    assert len(samples.weights) == len(vertices) + mesh.face_count - 2
    assert (samples.weights > 0).all()
    assert np.isfinite(samples.stretch).all()


@pytest.mark.parametrize("name", RECIPES)
def test_some_stand_for_all(name: str) -> None:
    """The area of all, second moments nearly so, no part of the surface without a sample, and some of the old ones."""
    made = reference_triangulations()[name]
    whole = coordinate_samples(made)
    most = len(whole.weights) // 4
    some = coordinate_samples(made, most)
    assert most / 2 < len(some.weights) < 1.6 * most
    assert some.weights.sum() == pytest.approx(whole.weights.sum(), rel=1e-12)
    moments = [np.einsum("n,ni,nj->ij", s.weights, s.values, s.values) for s in (whole, some)]
    np.testing.assert_allclose(moments[1], moments[0], atol=0.2 * np.abs(moments[0]).max())
    away = np.linalg.norm(whole.values[:, None] - some.values, axis=2)
    assert (away.min(axis=0) == 0).all()
    assert away.min(axis=1).max() < 6 * np.sqrt(whole.weights.sum() / most)
    assert len(coordinate_samples(made, len(whole.weights)).weights) == len(whole.weights)
