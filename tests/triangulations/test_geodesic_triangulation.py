"""Geodesic triangulations: counts, gluings, areas, corner frames and refinement."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import spline_checks as checks

from orbiframe import MapError
from orbiframe.testing.reference import RECIPES, reference_triangulations
from orbiframe.triangulations import GeodesicTriangulation

each_domain = pytest.mark.parametrize("name", list(checks.MAKERS))
each_map = pytest.mark.parametrize("name", list(RECIPES))


def check(domain: GeodesicTriangulation) -> None:
    assert domain.euler_characteristic == domain.orbifold.euler_characteristic
    assert domain.area_defect < 1e-11
    assert domain.gluing_defect < 1e-11
    assert domain.vertex_defect < 1e-10
    assert (domain.areas > 0).all()
    assert (np.linalg.det(domain.corners) > 0).all()
    halfedge = np.arange(3 * domain.face_count)
    np.testing.assert_array_equal(domain.twin[domain.twin], halfedge)
    np.testing.assert_array_equal(domain.same[domain.twin], domain.same)
    np.testing.assert_array_equal(np.linalg.det(domain.gluing) < 0, domain.same)
    assert domain.geometry.isometry_defect(domain.gluing).max() < 1e-11


@each_domain
def test_domains_are_surfaces(name: str) -> None:
    domain = checks.domain(name)
    check(domain)
    if domain.orbifold.orientable:
        assert not domain.same.any()


@each_domain
def test_refined_domains_are_the_same_surfaces(name: str) -> None:
    domain = checks.domain(name)
    fine = domain.refined()
    check(fine)
    assert fine.face_count == 4 * domain.face_count
    assert fine.vertex_count == domain.vertex_count + domain.edge_count
    np.testing.assert_allclose(fine.areas.reshape(-1, 4).sum(axis=1), domain.areas, rtol=1e-11)


@each_map
def test_maps_of_meshes(name: str) -> None:
    triangulation = reference_triangulations()[name]
    domain = GeodesicTriangulation.of_map(triangulation)
    check(domain)
    assert domain.face_count == triangulation.polyhedron.face_count
    assert domain.vertex_count == len(triangulation.points)


def test_folded_maps_are_refused() -> None:
    triangulation = reference_triangulations()["torus"]
    points = triangulation.points.copy()
    points[0] += [0, 0.9, 0]
    with pytest.raises(MapError, match="folded"):
        GeodesicTriangulation.of_map(replace(triangulation, points=points))


@each_domain
def test_corner_frames_carry_vertices_to_corners(name: str) -> None:
    domain = checks.domain(name)
    first = domain.corners.reshape(-1, 3)[domain.vertex_corner][domain.vertex]
    carried = np.einsum("fcij,fcj->fci", domain.corner_frame, first)
    np.testing.assert_allclose(carried, domain.corners, atol=1e-10)


@each_domain
def test_every_edge_has_two_halfedges_of_one_length(name: str) -> None:
    domain = checks.domain(name)
    np.testing.assert_array_equal(np.bincount(domain.edge), 2)
    np.testing.assert_array_equal(domain.edge[domain.twin], domain.edge)
    assert domain.reference.sum() == domain.edge_count
    np.testing.assert_allclose(domain.edge_lengths[domain.twin], domain.edge_lengths, rtol=1e-12)


@each_domain
def test_the_angles_at_every_vertex_add_up_to_a_full_turn(name: str) -> None:
    domain, x = checks.domain(name), checks.domain(name).corners
    angle = domain.geometry.angle(x, np.roll(x, -1, axis=1), np.roll(x, 1, axis=1))
    total = np.bincount(domain.vertex.ravel(), angle.ravel())
    np.testing.assert_allclose(total, 2 * np.pi, rtol=1e-10)
