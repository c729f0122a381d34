"""Curving: the arcs that triangles stand for, from the bends of their edges that are no creases."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.bending import bending
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.seams import plane_faces
from orbiframe.meshes.sizes import vector_areas

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# A triangle so many times as wide as its neighbour does not belong to the same arc.
WIDE = 3.0
# Bends up to this are none.
FLAT = np.radians(3)


class Curving(NamedTuple):
    """Of a triangle mesh with creases: bend: (F, 3), the curvature across the edge opposite each corner, positive where
    the mesh is convex; height: (F, 3), of each triangle over that edge; normals: (F, 3), of the triangles.

    A surface that crosses the edges of a triangle with these curvatures has the second fundamental form
    sum of bend_k m_k m_k^T, with the unit vectors m_k across the edges in the plane of the triangle.
    """

    bend: Floats
    height: Floats
    normals: Floats

    @classmethod
    def of(cls, mesh: Polyhedron, crease: Bools) -> Curving:
        """That of a triangle mesh; crease: (H,), the edges that do not count.

        A normal turns by the angle at an edge over the mean height of its two triangles. Plane faces (see `seams`), and
        triangles much wider than their neighbour, are planes in which a round ends: there the arc turns by all of the
        angle within the neighbour, and the plane not at all.
        """
        vectors = vector_areas(mesh)
        area = np.linalg.norm(vectors, axis=1)
        tiny = np.finfo(float).tiny
        normals = vectors / np.maximum(area, tiny)[:, None]
        height = 2 * area[mesh.face] / np.maximum(mesh.edge_lengths, tiny)
        other = height[mesh.twin]
        angle = bending(mesh).angle
        region, plane = plane_faces(mesh, crease)
        flat = plane[region[mesh.face]]
        length = np.where(flat[mesh.twin] | (other > WIDE * height), height, height + other) / 2
        none = crease | (angle <= FLAT) | flat | (height > WIDE * other) & ~flat[mesh.twin]
        bend = np.where(none, 0.0, angle / np.maximum(length, tiny))
        opposite = mesh.next[mesh.next]
        apex = mesh.vertices[mesh.tail[opposite[mesh.twin]]] - mesh.vertices[mesh.tail]
        rises = np.einsum("hi,hi->h", apex, normals[mesh.face]) > 0
        # The edge opposite corner k is halfedge k + 1.
        over = np.roll((np.where(rises, -bend, bend)).reshape(-1, 3), -1, axis=1)
        return cls(over, np.roll(height.reshape(-1, 3), -1, axis=1), normals)

    @property
    def curvatures(self) -> Floats:
        """The largest across an edge of each triangle, (F,)."""
        return np.asarray(np.abs(self.bend).max(axis=1))

    @property
    def sagittas(self) -> Floats:
        """The height of the largest arc over each triangle, (F,)."""
        return np.asarray(np.abs(self.bend * self.height**2).max(axis=1) / 8)

    def lifts(self, face: Ints, barycentric: Floats) -> Floats:
        """From points of triangles (n,) to the arcs over them, (n, 3): exact to second order."""
        arc = self.bend[face] * self.height[face] ** 2
        above = (arc * barycentric * (1 - barycentric)).sum(axis=1) / 2
        return np.asarray(above[:, None] * self.normals[face])
