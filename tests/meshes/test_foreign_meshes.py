"""Meshes of other libraries are told by what they have, and come back with the same faces."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from orbiframe import PluginError, Polyhedron, TopologyError, UsageError
from orbiframe.meshes import foreign_meshes, triangulated
from orbiframe.testing.polyhedra import reference_polyhedra

POLYHEDRA = reference_polyhedra()
LIBRARIES = ("trimesh", "pyvista", "meshio", "open3d")


def faces(mesh: Polyhedron) -> list[list[int]]:
    return sorted(mesh.face_corners(face).tolist() for face in range(mesh.face_count))


def corners(mesh: Polyhedron) -> set[frozenset[tuple[float, ...]]]:
    """The faces as sets of points, whatever their numbers."""
    return {frozenset(map(tuple, mesh.vertices[face].tolist())) for face in faces(mesh)}


@pytest.mark.parametrize("name", ["cube", "prism", "Klein bottle"])
@pytest.mark.parametrize("library", LIBRARIES)
def test_a_mesh_given_to_a_library_comes_back(library, name):
    pytest.importorskip(library, exc_type=ImportError)
    mesh = POLYHEDRA[name]
    wanted = triangulated(mesh) if library in ("trimesh", "open3d") else mesh
    given = getattr(mesh, f"to_{library}")()
    assert type(given).__module__.split(".")[0] == library
    found = Polyhedron.of(given)
    assert np.array_equal(found.vertices, mesh.vertices)
    assert faces(found) == faces(wanted)


@pytest.mark.parametrize("library", LIBRARIES)
def test_normals_go_with_it(library):
    pytest.importorskip(library, exc_type=ImportError)
    mesh = POLYHEDRA["tetrahedron"]
    up = np.tile([0.0, 0.6, 0.8], (len(mesh.vertices), 1))
    given = getattr(mesh.with_vertices(mesh.vertices, up), f"to_{library}")()
    found = given.point_data["Normals"] if library in ("pyvista", "meshio") else given.vertex_normals
    assert np.allclose(found, up)


def test_more_kinds_of_meshes():
    pyvista, o3d = (pytest.importorskip(name, exc_type=ImportError) for name in ("pyvista", "open3d"))
    grid = POLYHEDRA["cube"].to_pyvista().cast_to_unstructured_grid()
    assert corners(Polyhedron.of(grid)) == corners(POLYHEDRA["cube"])
    assert Polyhedron.of(pyvista.Icosahedron()).face_count == 20
    tensors = o3d.t.geometry.TriangleMesh.from_legacy(POLYHEDRA["cube"].to_open3d())
    assert faces(Polyhedron.of(tensors)) == faces(triangulated(POLYHEDRA["cube"]))


def test_a_mesh_is_told_by_what_it_has():
    """No library is needed for that."""
    points, corners = np.eye(3).tolist(), [[0, 1, 2]]
    blocks = [SimpleNamespace(type="line", data=[[0, 1]]), SimpleNamespace(type="triangle", data=corners)]
    for mesh in (
        (points, corners),
        [np.array(points), np.array(corners)],
        SimpleNamespace(vertices=points, faces=corners),
        SimpleNamespace(vertices=points, triangles=np.array(corners)),
        SimpleNamespace(points=points, faces=np.array([3, 0, 1, 2])),
        SimpleNamespace(points=points, cells=blocks),
    ):
        found = Polyhedron.of(mesh)
        assert faces(found) == [[0, 1, 2]]
        assert np.array_equal(found.vertices, np.eye(3))


def test_faces_of_any_sizes():
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]]
    assert faces(Polyhedron.of((square, [[0, 1, 2, 3], [1, 4, 2]]))) == [[0, 1, 2, 3], [1, 4, 2]]


def test_what_is_given_is_not_shared():
    points = np.eye(3)
    found = Polyhedron.of((points, np.array([[0, 1, 2]])))
    points[0] = 7
    assert np.array_equal(found.vertices, np.eye(3))


@pytest.mark.parametrize(
    ("mesh", "error", "said"),
    [
        ("shape.off", UsageError, "builtins.str is no mesh that is known; give the name of a file, a Polyhedron"),
        (7, UsageError, "builtins.int is no mesh"),
        (([[0, 0]], [[0, 0, 0]]), TopologyError, r"vertices of the shape \(1, 2\); they must be \(V, 3\)"),
        (([[0, 0, np.nan]], [[0, 0, 0]]), TopologyError, "vertex 0 is"),
        ((np.eye(3), np.array([[0.0, 1.0, 2.0]])), TopologyError, r"faces: float64 .* whole numbers \(F, n\)"),
        ((np.eye(3), [[0, 1, 2.5]]), TopologyError, "face 0: float64"),
        ((Polyhedron.from_faces(np.eye(3), [[0, 1, 2]]), 1), TopologyError, "vertices: a Polyhedron that is no table"),
        (([[0, 0, 0], [1, 0]], [[0, 1, 1]]), TopologyError, "vertices: a list that is no table of numbers"),
        ((np.eye(3), 7), TopologyError, "faces: int; they must be an array"),
        ((np.eye(3), [[0, [1, 2]]]), TopologyError, "face 0: a list that is no table of numbers"),
        ((np.eye(3), [[0, 1, 3]]), TopologyError, "face 0 names vertex 3, but the vertices are 0 to 2"),
        (SimpleNamespace(points=np.eye(3), cells=[SimpleNamespace(type="tetra", data=[])]), TopologyError, "'tetra'"),
    ],
)
def test_what_is_no_mesh_is_refused(mesh, error, said):
    with pytest.raises(error, match=said):
        Polyhedron.of(mesh)


def test_a_library_that_is_not_there_is_named(monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(foreign_meshes.importlib, "import_module", missing)
    with pytest.raises(PluginError, match=r'needs the package open3d.*pip install "orbiframe\[open3d\]"'):
        POLYHEDRA["cube"].to_open3d()
