"""Self-intersections and Hausdorff distances of the report beside those of PyMeshLab and libigl."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from orbiframe import Polyhedron, fit, read
from orbiframe.meshes import triangulated
from orbiframe.meshes.self_intersections import self_intersecting
from orbiframe.meshes.subdivision import refine

DATASETS = Path(__file__).parents[2] / "datasets"
# All of the house but three_crosscaps, whose edges meet edges exactly: there it hangs on rounding what passes through.
MESHES = [
    *("cube", "dodecahedron", "klein_bottle", "plate_genus2", "plate_genus2_coarse"),
    *("plate_genus3", "plate_genus5", "projective_plane", "sphere", "torus"),
]
_POINTS = 60_000
# PyMeshLab counts triangles that come as near as its rounding otherwise than we do: so large a share at most.
_TOUCHING = 0.01


def selected(mesh: Polyhedron) -> list[int]:
    pymeshlab = pytest.importorskip("pymeshlab", reason="PyMeshLab is not installed: pip install pymeshlab")
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.triangles.astype(np.int32)))
    meshes.compute_selection_by_self_intersections_per_face()
    return np.flatnonzero(meshes.current_mesh().face_selection_array()).tolist()


@pytest.mark.parametrize("name", MESHES)
def test_self_intersections_are_those_of_pymeshlab(name):
    mesh = triangulated(read(DATASETS / f"{name}.off"))
    assert self_intersecting(mesh).tolist() == selected(mesh)


@pytest.mark.parametrize("name", MESHES)
def test_self_intersections_of_a_crumpled_mesh_are_those_of_pymeshlab(name):
    mesh = refine(triangulated(read(DATASETS / f"{name}.off")), 3).polyhedron
    noise = np.random.default_rng(5).standard_normal(mesh.vertices.shape)
    crumpled = mesh.with_vertices(mesh.vertices + 0.5 * float(np.median(mesh.edge_lengths)) * noise)
    found = self_intersecting(crumpled).tolist()
    assert len(found) > 10
    assert len({*found} ^ {*selected(crumpled)}) <= _TOUCHING * len(found)


@pytest.mark.long
@pytest.mark.parametrize("name", MESHES)
def test_the_hausdorff_distance_is_that_of_libigl_and_the_output_passes_through_itself_as_pymeshlab_says(name):
    igl = pytest.importorskip("igl", reason="libigl is not installed: pip install libigl")
    found = fit(DATASETS / f"{name}.off", fast=True, size=200, progress=False)
    assert found.report["shape"]["self_intersections"]["output"] == pytest.approx(
        len(selected(found.output)), rel=_TOUCHING
    )
    triangles, surface, distance = triangulated(found.input), found.surface, found.report["distance"]
    fine = surface.tessellate(_density(surface.triangulation.polyhedron), bisected=True)
    points = refine(triangles, _density(triangles)).polyhedron.vertices

    def largest(of: np.ndarray, to: Polyhedron) -> float:
        square = igl.point_mesh_squared_distance(of, to.vertices, to.triangles.astype(np.int64))[0]
        return float(np.sqrt(square.max())) / surface.scale

    there, back = largest(points, fine), largest(fine.vertices, triangles)
    assert distance["mesh_to_surface"]["max"] == pytest.approx(there, rel=0.01)
    assert distance["surface_to_mesh"]["max"] == pytest.approx(back, rel=0.1)  # at the points of samples only
    assert distance["hausdorff"] == pytest.approx(max(there, back), rel=0.01)


def _density(mesh: Polyhedron) -> int:
    return max(1, round((_POINTS / mesh.face_count) ** 0.5))
