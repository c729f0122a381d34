"""Other ways to a smooth surface: subdivision, Poisson reconstruction, Loop surfaces fitted by least squares."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pymeshlab
from numpy.typing import NDArray

from orbiframe import Polyhedron, surface_type
from orbiframe.meshes import triangulated
from quality import subdivision
from quality.face_points import points_of_faces
from quality.fitted_loop import fitted_loop
from quality.skins import Skin, measured_skin

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

FACES = 30_000
CONTROLS = 1000
_POINTS = 20_000


class Task(NamedTuple):
    """A mesh, and what is meant by it: "smooth", the vertices are on a smooth shape; "scan", near one; "faces"."""

    mesh: Polyhedron
    meant: str


class Refused(Exception):
    """A method that has no surface for a mesh, with the reason."""


def loop(task: Task) -> tuple[Floats, Ints]:
    """Loop's limit surface, the vertices as control points."""
    mesh = triangulated(task.mesh)
    points, faces = _subdivided(subdivision.loop, mesh.vertices, mesh.triangles)
    return subdivision.loop_limit(faces, len(points)) @ points, faces


def butterfly(task: Task) -> tuple[Floats, Ints]:
    """The modified butterfly surface through the vertices."""
    mesh = triangulated(task.mesh)
    return _subdivided(subdivision.butterfly, mesh.vertices, mesh.triangles)


def catmull_clark(task: Task) -> tuple[Floats, Ints]:
    """The limit surface of Catmull and Clark; the first step takes faces of any size."""
    points, faces = _quadrilaterals(task.mesh)
    points, faces = _subdivided(subdivision.catmull_clark, points, faces, FACES // 2)
    limit = subdivision.catmull_clark_limit(faces, len(points)) @ points
    return limit, np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])


def _quadrilaterals(mesh: Polyhedron) -> tuple[Floats, Ints]:
    """The faces, if all have four corners; else those after one step of the scheme."""
    if (mesh.face_sizes == 4).all():
        return mesh.vertices, mesh.tail.reshape(-1, 4)
    step = subdivision.catmull_clark_of_polygons(mesh.tail, mesh.face_sizes, len(mesh.vertices))
    return step.matrix @ mesh.vertices, step.faces


def _subdivided(
    scheme: Callable[[Ints, int], subdivision.Step], points: Floats, faces: Ints, least: int = FACES
) -> tuple[Floats, Ints]:
    while len(faces) < least:
        step = scheme(faces, len(points))
        points, faces = step.matrix @ points, step.faces
    return points, faces


def ls3(task: Task) -> tuple[Floats, Ints]:
    """Least squares subdivision of Boye, Guennebaud and Schlick (2010), with the weights of Loop, by MeshLab."""
    mesh = triangulated(task.mesh)
    _require_sides(mesh)
    steps = int(np.ceil(np.log(FACES / mesh.face_count) / np.log(4)))
    return _by_meshlab(
        mesh, "meshing_surface_subdivision_ls3_loop", iterations=max(steps, 1), threshold=pymeshlab.PercentageValue(0)
    )


def poisson(task: Task) -> tuple[Floats, Ints]:
    """Screened Poisson reconstruction of Kazhdan and Hoppe (2013) from points with normals, by MeshLab.

    Of the vertices of a smooth shape; else of 20,000 points of its faces.
    """
    mesh = triangulated(task.mesh)
    _require_sides(mesh)
    normal = np.cross(*np.moveaxis(np.diff(mesh.vertices[mesh.triangles], axis=1), 1, 0))
    if task.meant != "faces":
        points, normals = mesh.vertices, _at_vertices(mesh, normal)
    else:
        face, points = points_of_faces(mesh.vertices, mesh.triangles, _POINTS)
        normals = normal[face]
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    cloud = pymeshlab.Mesh(points, v_normals_matrix=normals)
    return _run_meshlab(cloud, "generate_surface_reconstruction_screened_poisson", depth=8, threads=1)


def _at_vertices(mesh: Polyhedron, normal: Floats) -> Floats:
    total = np.zeros(mesh.vertices.shape)
    np.add.at(total, mesh.triangles.ravel(), np.repeat(normal, 3, axis=0))
    return total


def _require_sides(mesh: Polyhedron) -> None:
    if not surface_type(mesh).orientable:
        raise Refused("the surface has one side only")


def _by_meshlab(mesh: Polyhedron, name: str, **options: object) -> tuple[Floats, Ints]:
    return _run_meshlab(pymeshlab.Mesh(mesh.vertices, mesh.triangles), name, **options)


def _run_meshlab(mesh: pymeshlab.Mesh, name: str, **options: object) -> tuple[Floats, Ints]:
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(mesh)
    try:
        getattr(meshes, name)(**options)
    except pymeshlab.PyMeshLabException as error:
        raise Refused(str(error)) from error
    found = meshes.current_mesh()
    return found.vertex_matrix(), found.face_matrix().astype(np.intp)


def loop_fit(task: Task) -> tuple[Floats, Ints]:
    """A Loop surface of about 1000 control points, fitted by least squares."""
    return fitted_loop(task.mesh, task.meant, CONTROLS, FACES)


METHODS: dict[str, Callable[[Task], tuple[Floats, Ints]]] = {
    "Loop": loop,
    "Catmull-Clark": catmull_clark,
    "butterfly": butterfly,
    "LS3": ls3,
    "Poisson": poisson,
    "Loop fitted": loop_fit,
}


def skin(found: tuple[Floats, Ints]) -> Skin:
    """The surface of a peer with measured normals and curvature."""
    return measured_skin(*found)
