"""Nearest points of surfaces: as near as any of a fine tessellation, and feet of perpendiculars."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import fitted

from orbiframe.meshes.nearest_points import NearestPoints


@pytest.mark.parametrize("name", ["torus.off", "klein_bottle.off"])
def test_no_point_of_a_fine_tessellation_is_nearer(name):
    """Targets near ridges too, where the nearest vertex of the triangulation may lie on the wrong flank."""
    surface = fitted(name, 300).surface
    fine = surface.tessellate(24)
    rng = np.random.default_rng(2)
    corners = fine.vertices[fine.triangles[rng.integers(0, fine.face_count, 3000)]]
    diagonal = float(np.linalg.norm(np.ptp(fine.vertices, axis=0)))
    targets = corners.mean(axis=1) + 0.01 * diagonal * rng.normal(size=(3000, 3))
    points, distance = surface.nearest(targets)
    there = NearestPoints(fine).distance(targets)
    assert (distance > there + 1e-4 * diagonal).sum() <= 6
    np.testing.assert_allclose(np.linalg.norm(surface.evaluate(points) - targets, axis=1), distance, atol=1e-12)
    across = np.einsum("ni,ni->n", surface.normals(points), targets - surface.evaluate(points))
    assert (np.abs(np.abs(across) - distance) > 1e-6 * diagonal).sum() <= 3
