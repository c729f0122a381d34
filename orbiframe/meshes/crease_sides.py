"""Sides of creases: the corners of a mesh about each vertex, parted by marked edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


def corner_sides(mesh: Polyhedron, crease: Bools) -> Ints:
    """The side that every corner of a closed mesh lies on, (H,): corners of one vertex that no marked edge parts.

    crease: (H,), the marked halfedges. A vertex with none or one of them, where a crease ends, has one side.
    """
    inner = np.flatnonzero(~crease)
    twin, same = mesh.twin[inner], mesh.same[inner]
    start, end = np.where(same, twin, mesh.next[twin]), np.where(same, mesh.next[twin], twin)
    links = np.concatenate([inner, mesh.next[inner]]), np.concatenate([start, end])
    graph = coo_array((np.ones(len(links[0])), links), shape=(len(mesh.tail), len(mesh.tail)))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.intp)


def side_normals(mesh: Polyhedron, side: Ints, angles_of: Floats | None = None) -> Floats:
    """The normal of every side of a triangle mesh up to its sign, (S, 3): the direction nearest to those of its faces.

    Faces count by their area, or by their angle at the vertex, where the vertices (V, 3) are given again: as a fan of
    triangles or as one polygon alike.
    """
    vectors = vector_areas(mesh)[mesh.face]
    size = np.linalg.norm(vectors, axis=1)
    unit = vectors / np.maximum(size, np.finfo(float).tiny)[:, None]
    if angles_of is not None:
        size = _angles(mesh, angles_of)
    moment = np.zeros((int(side.max()) + 1, 3, 3))
    np.add.at(moment, side, (size[:, None] * unit)[:, :, None] * unit[:, None, :])
    return np.asarray(np.linalg.eigh(moment)[1][:, :, 2])


def _angles(mesh: Polyhedron, x: Floats) -> Floats:
    """The angles of triangles at their corners, (H,)."""
    ahead, back = x[mesh.head] - x[mesh.tail], x[mesh.head[mesh.next]] - x[mesh.tail]
    across = np.linalg.norm(np.cross(ahead, back), axis=1)
    return np.asarray(np.arctan2(across, np.einsum("hi,hi->h", ahead, back)))
