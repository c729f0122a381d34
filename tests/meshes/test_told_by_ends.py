"""Meshes that a file can hold: refined ones, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_polyhedra import polyhedra_with_doubled_edges

from orbiframe.errors import TopologyError
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import area
from orbiframe.meshes.subdivision import refine
from orbiframe.meshes.surface_type import surface_type
from orbiframe.meshes.told_by_ends import as_in_a_file, refined_by_ends, require_told_by_ends
from orbiframe.testing.polyhedra import reference_polyhedra


def pillow() -> Polyhedron:
    """Two triangles on the same three corners: a sphere."""
    return Polyhedron.from_faces(np.eye(3), [[0, 1, 2], [2, 1, 0]])


def assert_refined(mesh: Polyhedron, density: int) -> None:
    fine = refined_by_ends(mesh, density)
    require_told_by_ends(fine.polyhedron, surface_type(mesh))
    corners = mesh.vertices[mesh.triangles[fine.face]]
    np.testing.assert_allclose(np.einsum("nc,nci->ni", fine.barycentric, corners), fine.polyhedron.vertices, atol=1e-12)
    assert fine.coarse is mesh
    assert area(fine.polyhedron) == pytest.approx(area(mesh), rel=1e-12)


@settings(max_examples=40, deadline=None)
@given(polyhedra_with_doubled_edges(), st.integers(1, 3))
def test_doubled_edges_are_halved_until_ends_tell_them(mesh: Polyhedron, density: int) -> None:
    assert_refined(triangulated(mesh), density)


@pytest.mark.parametrize("density", [1, 2, 3, 7])
def test_two_triangles_are_a_sphere_in_a_file_too(density: int) -> None:
    assert_refined(pillow(), density)


@pytest.mark.parametrize("name", sorted(reference_polyhedra()))
def test_other_meshes_are_refined_as_ever(name: str) -> None:
    mesh = triangulated(reference_polyhedra()[name])
    ours, plain = refined_by_ends(mesh, 2), refine(mesh, 2)
    np.testing.assert_array_equal(ours.polyhedron.tail, plain.polyhedron.tail)
    np.testing.assert_array_equal(ours.barycentric, plain.barycentric)


def test_a_mesh_that_a_file_reads_otherwise_is_refused() -> None:
    mesh = refine(pillow(), 3).polyhedron
    assert surface_type(mesh).closed
    assert not surface_type(as_in_a_file(mesh)).closed
    with pytest.raises(TopologyError, match=r"is in a file not closed, .* nothing is written"):
        require_told_by_ends(mesh, surface_type(mesh))


def test_another_surface_is_refused() -> None:
    cube, torus = (reference_polyhedra()[name] for name in ("cube", "torus"))
    with pytest.raises(TopologyError, match="genus 0"):
        require_told_by_ends(cube, surface_type(torus))
