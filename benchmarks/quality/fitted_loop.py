"""A Loop surface fitted to a mesh by least squares, its parameters corrected again and again."""

from __future__ import annotations

import igl
import numpy as np
import pymeshlab
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from orbiframe import Polyhedron
from orbiframe.meshes import bisected, triangulated
from orbiframe.meshes.bisection import edge_length_for
from quality import subdivision
from quality.face_points import points_of_faces
from quality.foot_points import foot_points
from quality.skins import Skin

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

ROUNDS = 10
FAIRING = {"smooth": 1e-2, "scan": 1.0, "faces": 1e-4}  # each the best of some powers of ten
_DATA = 15_000


def fitted_loop(mesh: Polyhedron, meant: str, controls: int, faces: int) -> tuple[Floats, Ints]:
    """A fine mesh on the Loop surface that is nearest to the vertices, or to the faces where meant says so.

    Every round finds the nearest points on the surface and solves for the control points, with a little of the squared
    Laplacian of the Laplacian for fairness.
    """
    triangles = triangulated(mesh)
    start, corners = control_mesh(triangles, meant, controls)
    fine, limit = _limit(corners, len(start), faces)
    data = triangles.vertices
    if meant == "faces":
        data = np.concatenate([data, points_of_faces(triangles.vertices, triangles.triangles, _DATA)[1]])
    rough = _laplacian(corners, len(start))
    energy = FAIRING[meant] * len(data) / limit.shape[1] * (rough.T @ rough) @ (rough.T @ rough)
    control = start
    for _ in range(ROUNDS):
        control = _solved(data, control, fine, limit, energy)
    return limit @ control, fine


def control_mesh(mesh: Polyhedron, meant: str, controls: int) -> tuple[Floats, Ints]:
    """The mesh with at most about so many vertices.

    Edges are collapsed where it has more. Where it has fewer, it is subdivided by Loop's scheme as long as that leaves
    it small enough if its vertices are meant; if its faces are, long edges are halved.
    """
    if len(mesh.vertices) > 1.2 * controls:
        return _collapsed(mesh, controls)
    if meant == "faces":
        fine = bisected(mesh, edge_length_for(mesh, controls), True).polyhedron
        return fine.vertices, fine.triangles
    points, corners = mesh.vertices, mesh.triangles
    while len(corners) < controls / 2:
        step = subdivision.loop(corners, len(points))
        points, corners = step.matrix @ points, step.faces
    return points, corners


def _collapsed(mesh: Polyhedron, controls: int) -> tuple[Floats, Ints]:
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.triangles))
    faces = mesh.face_count - 2 * (len(mesh.vertices) - controls)
    meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=faces, preservetopology=True, qualitythr=0.5)
    found = meshes.current_mesh()
    return found.vertex_matrix(), found.face_matrix().astype(np.intp)


def _limit(corners: Ints, count: int, faces: int) -> tuple[Ints, csr_array]:
    """The faces of a fine mesh, and its vertices on the limit surface by the control points."""
    matrix = diags_array(np.ones(count))
    while len(corners) < faces:
        step = subdivision.loop(corners, count)
        matrix, corners, count = step.matrix @ matrix, step.faces, step.matrix.shape[0]
    return corners, csr_array(subdivision.loop_limit(corners, count) @ matrix)


def _laplacian(corners: Ints, count: int) -> csr_array:
    near = subdivision.neighbours(subdivision.edges_of(corners), count)
    return csr_array(diags_array(1 / near.sum(axis=1)) @ near - diags_array(np.ones(count)))


def _solved(data: Floats, control: Floats, fine: Ints, limit: csr_array, energy: csr_array) -> Floats:
    """The next control points. The bend of the surface inside of fine triangles is kept from the last ones."""
    foot = foot_points(Skin(limit @ control, fine, *_normals(limit @ control, fine)), data)
    rows = csr_array(
        (foot.barycentric.ravel(), fine[foot.face].ravel(), 3 * np.arange(len(data) + 1)),
        shape=(len(data), len(limit @ control)),
    )
    matrix = csr_array(rows @ limit)
    bend = foot.points - matrix @ control
    return splu(csc_array(matrix.T @ matrix + energy)).solve(matrix.T @ (data - bend))


def _normals(vertices: Floats, fine: Ints) -> tuple[Floats, Floats]:
    normals = igl.per_vertex_normals(vertices, fine)
    return normals, np.zeros(len(vertices))
