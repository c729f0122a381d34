"""Triangles: Open3D's meshes to polyhedra and back; to be called in a process of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, PluginError, Polyhedron
from orbiframe_open3d.links import require_own_files

SYSTEM = "apt-get install libusb-1.0-0 libgl1 libegl1 libx11-6 libudev1"


def polyhedron_of(path: Path) -> Polyhedron:
    """The triangles of a file; what Open3D splits for normals and pictures is joined again where it coincides."""
    require_own_files(path)
    o3d = _open3d()
    try:
        mesh = o3d.t.io.read_triangle_mesh(str(path))
    except (RuntimeError, IndexError, ValueError) as error:
        raise FormatError(f"{path}: Open3D cannot read this file, though it may be of this format: {error}") from error
    if "positions" not in mesh.vertex or "indices" not in mesh.triangle or not len(mesh.triangle.indices):
        raise FormatError(f"{path}: Open3D finds no triangles; is the file what its suffix says?")
    points = mesh.vertex.positions.numpy()
    tail = mesh.triangle.indices.numpy().ravel().astype(np.intp)
    if not np.isfinite(points).all() or tail.min() < 0 or tail.max() >= len(points):
        raise FormatError(f"{path}: a coordinate is not finite, or a face names a vertex that is not there")
    # Adding 0 makes -0 the same as 0.
    vertices, place = np.unique(points.astype(np.float64) + 0.0, axis=0, return_inverse=True)
    made = Polyhedron.from_faces(vertices, place.ravel()[tail].reshape(-1, 3))
    return made.with_vertices(vertices, _normals(mesh, place.ravel(), len(vertices)))


def _normals(mesh: Any, place: NDArray[np.intp], count: int) -> NDArray[np.float64] | None:
    """The normals of the joined vertices; None where there are none, or where a vertex has several, as on an edge."""
    if "normals" not in mesh.vertex:
        return None
    given = mesh.vertex.normals.numpy().astype(np.float64)
    normals = np.empty((count, 3))
    normals[place] = given
    return normals if np.allclose(normals[place], given, atol=1e-6) else None


def save(path: Path, polyhedron: Polyhedron) -> None:
    """Write a file. Raises FormatError where Open3D says that it did not."""
    o3d = _open3d()
    vertices = o3d.core.Tensor(polyhedron.vertices.astype(np.float32))
    mesh = o3d.t.geometry.TriangleMesh(vertices, o3d.core.Tensor(polyhedron.triangles.astype(np.int64)))
    if polyhedron.normals is not None:
        mesh.vertex.normals = o3d.core.Tensor(polyhedron.normals.astype(np.float32))
    if not o3d.t.io.write_triangle_mesh(str(path), mesh):
        raise FormatError(f"{path}: Open3D cannot write this file; it writes glb, gltf, fbx, ply, obj, off and stl")


def _open3d() -> Any:
    if isinstance(_LOADED, ModuleNotFoundError):
        raise PluginError('this format needs the package open3d: pip install "orbiframe[open3d]"') from _LOADED
    if isinstance(_LOADED, Exception):
        raise PluginError(
            f"open3d cannot be loaded ({_LOADED}); it needs system libraries: on Debian, {SYSTEM}"
        ) from _LOADED
    return _LOADED


def _loaded() -> Any:
    """Open3D, or the reason why it cannot be loaded."""
    try:
        import open3d
    except (ImportError, OSError) as error:
        return error
    return open3d


# Loaded with this module, before the process is confined: Open3D looks at files of its own.
_LOADED = _loaded()
