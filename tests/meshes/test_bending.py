"""Bends of edges against dihedral angles that are known."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import grid

from orbiframe.meshes.bending import bending
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.testing.polyhedra import reference_polyhedra


def test_a_cube_bends_by_right_angles_at_its_edges_alone() -> None:
    found = bending(triangulated(reference_polyhedra()["cube"]))
    angles = np.degrees(found.angle)
    assert set(angles.round(6)) == {0.0, 90.0}
    assert (angles > 1).sum() == 24
    assert found.share == 1


def test_a_tetrahedron() -> None:
    found = bending(reference_polyhedra()["tetrahedron"])
    np.testing.assert_allclose(found.angle, np.pi - np.arccos(1 / 3), rtol=1e-9)


@pytest.mark.parametrize(("across", "share"), [(8, 1.0), (12, 0.0)])
def test_a_long_cylinder_is_sharp_up_to_eight_sides(across: int, share: float) -> None:
    """Angles of 45 and of 30 degrees across the tube of a torus so large that it hardly bends the other way."""

    def place(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        ring = 1000 + np.cos(v)
        return np.stack([ring * np.cos(u), ring * np.sin(u), np.sin(v)], axis=1)

    assert bending(triangulated(grid(400, across, place))).share == pytest.approx(share, abs=0.05)


def test_a_nonorientable_mesh_bends_as_its_faces_do() -> None:
    """Twins that run the same way have normals that look to opposite sides."""
    mesh = triangulated(reference_polyhedra()["Klein bottle"])
    found = bending(mesh).angle
    np.testing.assert_allclose(found, found[mesh.twin])
    corners = mesh.vertices[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    cosine = np.abs(np.einsum("hi,hi->h", normal[mesh.face], normal[mesh.face[mesh.twin]]))
    np.testing.assert_allclose(np.abs(np.cos(found)), cosine, atol=1e-9)
