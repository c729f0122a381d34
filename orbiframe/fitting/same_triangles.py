"""Same triangles: whether two meshes are connected alike, and polygons cut by the diagonals of a triangle mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.polyhedron import Polyhedron

Ints = NDArray[np.intp]


def glued_alike(mesh: Polyhedron, other: Polyhedron) -> bool:
    """Whether two meshes have the same vertices, faces and gluings by their numbers, wherever the vertices lie."""
    names = ("offsets", "tail", "twin", "same")
    same = all(np.array_equal(getattr(mesh, name), getattr(other, name)) for name in names)
    return same and len(mesh.vertices) == len(other.vertices)


def cut_like(mesh: Polyhedron, triangles: Polyhedron) -> Polyhedron:
    """The mesh, or its faces cut as `triangles` are, if those are its faces cut by other diagonals than its own."""
    if mesh.is_triangular or glued_alike(triangulated(mesh), triangles) or not _cut_of(mesh, triangles):
        return mesh
    return replace(triangles, vertices=mesh.vertices, unit=mesh.unit)


def _cut_of(mesh: Polyhedron, triangles: Polyhedron) -> bool:
    """Whether triangles are the faces of a mesh, in their order, cut by diagonals without a new vertex."""
    sizes = mesh.face_sizes
    if len(mesh.vertices) != len(triangles.vertices) or int((sizes - 2).sum()) != triangles.face_count:
        return False
    face = np.repeat(np.arange(mesh.face_count), sizes - 2)[triangles.face]
    place = _places(_sides(face, triangles), _sides(mesh.face, mesh))
    if place is None:
        return False
    number = np.full(len(triangles.tail) + 1, -2)
    number[-1] = -1
    number[place] = np.arange(len(place))
    inner = np.ones(len(triangles.tail), dtype=np.bool_)
    inner[place] = False
    beside = face[triangles.twin[inner]] == face[inner]
    outer = number[triangles.twin[place]] == mesh.twin
    return bool((triangles.twin[inner] >= 0).all() and beside.all() and outer.all() and _same(mesh, triangles, place))


def _same(mesh: Polyhedron, triangles: Polyhedron, place: Ints) -> bool:
    return np.array_equal(triangles.same[place], mesh.same)


def _sides(face: Ints, mesh: Polyhedron) -> Ints:
    """The face and the two ends of every halfedge, (H, 3)."""
    return np.stack([face, mesh.tail, mesh.head], axis=1)


def _places(rows: Ints, wanted: Ints) -> Ints | None:
    """Which of the rows each of the wanted rows is; None unless each is one of them."""
    both = np.concatenate([rows, wanted])
    kind = np.unique(both, axis=0, return_inverse=True)[1].ravel()
    place = np.full(kind.max() + 1, -1, dtype=np.intp)
    place[kind[: len(rows)]] = np.arange(len(rows))
    found = place[kind[len(rows) :]]
    return found if (found >= 0).all() and len(np.unique(found)) == len(found) else None
