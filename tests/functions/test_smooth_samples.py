"""Samples of smooth and half smooth shapes: the arcs over curved facets, against a cylinder."""

from __future__ import annotations

import numpy as np
import pytest

from orbiframe.functions.smooth_samples import sagittas
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas


def prism(sides: int, radius: float, height: float) -> Polyhedron:
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=1)
    k = np.arange(sides)
    walls = np.stack([k, (k + 1) % sides, (k + 1) % sides + sides, k + sides], axis=1).tolist()
    ends = [k[::-1].tolist(), (k + sides).tolist()]
    return Polyhedron.from_faces(np.concatenate([ring, ring + np.array([0, 0, height])]), [*walls, *ends])


@pytest.mark.parametrize(("sides", "curved"), [(24, True), (12, True), (8, False), (150, False)])
def test_the_sagitta_of_walls_is_that_of_the_arc(sides: int, curved: bool) -> None:
    """Bends of 15 and 30 degrees mean an arc; one of 45 is an edge, and one of 2.4 counts as flat."""
    mesh = triangulated(prism(sides, 2.0, 0.3))
    area = np.linalg.norm(vector_areas(mesh), axis=1)
    found = sagittas(mesh, area)
    walls = np.ptp(mesh.vertices[mesh.triangles][..., 2], axis=1) > 0
    expected = 2.0 * (1 - np.cos(np.pi / sides)) if curved else 0.0
    np.testing.assert_allclose(found[walls], expected, rtol=0.03)
    assert (found[~walls] == 0).all()
