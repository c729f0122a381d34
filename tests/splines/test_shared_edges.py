"""Normals of edges that both of their triangles share."""

from __future__ import annotations

import numpy as np
import pytest
import spline_checks

from orbiframe.splines.shared_edges import along_reference, shared_normals


@pytest.mark.parametrize("name", spline_checks.MAKERS)
def test_gluings_take_the_normal_of_the_twin_to_the_own_one(name: str) -> None:
    domain = spline_checks.domain(name)
    normals = shared_normals(domain)
    moved = domain.geometry.act(domain.gluing, normals[domain.twin])
    np.testing.assert_allclose(moved, normals, atol=1e-12 * np.abs(normals).max())


@pytest.mark.parametrize("name", spline_checks.MAKERS)
def test_normals_are_tangent_at_both_ends_across_the_edge_and_as_long(name: str) -> None:
    domain = spline_checks.domain(name)
    geometry, normals = domain.geometry, shared_normals(domain).reshape(-1, 3, 3)
    heads = np.roll(domain.corners, -1, axis=1)
    form = np.array([1.0, geometry.curvature, geometry.curvature])
    along = geometry.log(domain.corners, heads)
    for end in (domain.corners, heads):
        np.testing.assert_allclose((form * end * normals).sum(axis=-1), 0, atol=1e-12)
    np.testing.assert_allclose(geometry.inner(domain.corners, along, normals), 0, atol=1e-12)
    np.testing.assert_allclose(geometry.norm(domain.corners, normals).ravel(), domain.edge_lengths, rtol=1e-12)


@pytest.mark.parametrize("name", spline_checks.MAKERS)
def test_halfedges_run_along_their_reference_where_the_gluing_takes_start_to_start(name: str) -> None:
    domain = spline_checks.domain(name)
    halfedge = np.arange(3 * domain.face_count)
    same_start = domain.start == domain.twin
    np.testing.assert_array_equal(along_reference(domain), (halfedge < domain.twin) | same_start)
