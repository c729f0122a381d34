"""Foreign meshes: those of NumPy, trimesh, PyVista, meshio and Open3D, told by what they have, and back to them.

None of these libraries is imported before a mesh is given back to it.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import PluginError, TopologyError, UsageError
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

ACCEPTED = "the name of a file, a Polyhedron, a pair (vertices, faces), or a mesh of trimesh, PyVista, meshio or Open3D"


def polyhedron_of(mesh: object) -> Polyhedron:
    """A mesh of another library, or arrays, as a polyhedron; a polyhedron itself.

    A pair has vertices (V, 3) and faces (F, n), or a list of faces of any sizes. Objects are told by what they have, so
    that no library need be installed: `vertices` and `faces` (trimesh) or `triangles` (Open3D), `vertex` and `triangle`
    (tensors of Open3D), `points` and `faces` (PyVista, or what has `extract_surface`), `points` and `cells` (meshio).
    Raises UsageError for any other object, TopologyError for arrays of a wrong shape, type or range.
    """
    if isinstance(mesh, Polyhedron):
        return mesh
    if isinstance(mesh, tuple | list) and len(mesh) == 2:
        return _of_faces(mesh[0], mesh[1])
    for told_by, reader in _READERS:
        if all(hasattr(mesh, name) for name in told_by):
            return reader(mesh)
    raise UsageError(f"a {type(mesh).__module__}.{type(mesh).__name__} is no mesh that is known; give {ACCEPTED}")


def _of_faces(vertices: Any, faces: Any) -> Polyhedron:
    points = _points(vertices)
    if isinstance(faces, np.ndarray) and faces.dtype != object:
        return Polyhedron.from_faces(points, _whole(faces, 2, "faces"))
    if not isinstance(faces, Iterable):
        raise TopologyError(f"faces: {type(faces).__name__}; they must be an array (F, n) or a list of faces")
    rows = [_whole(_table(face, f"face {number}"), 1, f"face {number}") for number, face in enumerate(faces)]
    return Polyhedron.from_faces(points, [row.tolist() for row in rows])


def _points(vertices: Any) -> Floats:
    points = np.array(_table(vertices, "vertices", np.float64))
    if points.ndim != 2 or points.shape[1] != 3:
        raise TopologyError(f"vertices of the shape {points.shape}; they must be (V, 3), a row for each")
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise TopologyError(f"vertex {bad[0]} is {points[bad[0]].tolist()}; coordinates must be finite")
    return points


def _table(given: Any, name: str, kind: type[np.float64] | None = None) -> NDArray[Any]:
    """What is given as an array of numbers."""
    try:
        return np.asarray(given, dtype=kind)
    except (TypeError, ValueError) as error:
        raise TopologyError(f"{name}: a {type(given).__name__} that is no table of numbers ({error})") from error


def _whole(numbers: NDArray[Any], axes: int, name: str) -> Ints:
    if numbers.ndim != axes or numbers.dtype.kind not in "iu":
        wanted = "(F, n)" if axes == 2 else "(n,)"
        raise TopologyError(f"{name}: {numbers.dtype} of the shape {numbers.shape}; must be whole numbers {wanted}")
    return np.asarray(numbers, dtype=np.intp)


# ---- from other libraries -----------------------------------------------------------------------------------------


def _of_trimesh(mesh: Any) -> Polyhedron:
    return _of_faces(mesh.vertices, np.asarray(mesh.faces))


def _of_open3d(mesh: Any) -> Polyhedron:
    return _of_faces(np.asarray(mesh.vertices), np.asarray(mesh.triangles))


def _of_open3d_tensors(mesh: Any) -> Polyhedron:
    return _of_faces(mesh.vertex.positions.cpu().numpy(), mesh.triangle.indices.cpu().numpy())


def _of_surface(mesh: Any) -> Polyhedron:
    """A mesh of PyVista whose faces are those of its cells on the outside, glued as the points are."""
    return _of_pyvista(mesh.extract_surface(algorithm="dataset_surface"))


def _of_pyvista(mesh: Any) -> Polyhedron:
    """PolyData: its faces in one list, each with its number of corners before it."""
    flat, faces, start = np.asarray(mesh.faces), [], 0
    while start < len(flat):
        end = start + 1 + int(flat[start])
        faces.append(flat[start + 1 : end])
        start = end
    return _of_faces(mesh.points, faces)


def _of_meshio(mesh: Any) -> Polyhedron:
    """The cells that are faces; vertices and lines beside them are left out."""
    faces: list[Any] = []
    for block in mesh.cells:
        if block.type in ("vertex", "line"):
            continue
        if block.type not in ("triangle", "quad") and not block.type.startswith("polygon"):
            raise TopologyError(f"the mesh has cells of the type '{block.type}'; give the surface alone, in polygons")
        faces += list(block.data)
    points = np.asarray(mesh.points)
    flat = points.shape[1:] == (2,)
    return _of_faces(np.pad(points, ((0, 0), (0, 1))) if flat else points, [np.asarray(face) for face in faces])


# What an object must have, and who reads it; the first that fits.
_READERS = (
    (("vertices", "faces"), _of_trimesh),
    (("vertices", "triangles"), _of_open3d),
    (("vertex", "triangle"), _of_open3d_tensors),
    (("points", "faces"), _of_pyvista),
    (("points", "extract_surface"), _of_surface),
    (("points", "cells"), _of_meshio),
)


# ---- to other libraries -------------------------------------------------------------------------------------------


def to_trimesh(mesh: Polyhedron) -> Any:
    """A trimesh.Trimesh of triangles, with the normals if there are some; vertices keep their numbers."""
    library = _library("trimesh", "trimesh")
    fine = triangulated(mesh)
    return library.Trimesh(fine.vertices, fine.triangles, vertex_normals=fine.normals, process=False)


def to_pyvista(mesh: Polyhedron) -> Any:
    """A pyvista.PolyData of the polygons, with the normals as the array "Normals" if there are some."""
    library = _library("pyvista", "orbiframe[pictures]")
    padded = np.insert(mesh.tail, mesh.offsets[:-1], mesh.face_sizes)
    made = library.PolyData(mesh.vertices.copy(), padded)
    if mesh.normals is not None:
        made.point_data["Normals"] = mesh.normals
    return made


def to_meshio(mesh: Polyhedron) -> Any:
    """A meshio.Mesh, a block of cells for every size of faces, with the normals as "Normals" if there are some."""
    library = _library("meshio", "meshio")
    cells = []
    for size in np.unique(mesh.face_sizes):
        chosen = np.flatnonzero(mesh.face_sizes == size)
        corners = mesh.tail[mesh.offsets[chosen][:, None] + np.arange(size)]
        cells.append(({3: "triangle", 4: "quad"}.get(int(size), "polygon"), corners))
    return library.Mesh(mesh.vertices, cells, point_data={} if mesh.normals is None else {"Normals": mesh.normals})


def to_open3d(mesh: Polyhedron) -> Any:
    """An open3d.geometry.TriangleMesh, with the normals if there are some."""
    library = _library("open3d", "orbiframe[open3d]")
    fine = triangulated(mesh)
    vectors = library.utility.Vector3dVector
    made = library.geometry.TriangleMesh(vectors(fine.vertices), library.utility.Vector3iVector(fine.triangles))
    if fine.normals is not None:
        made.vertex_normals = vectors(fine.normals)
    return made


def _library(name: str, requirement: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise PluginError(
            f'this needs the package {name}, which is not installed: pip install "{requirement}"'
        ) from error
