"""Curving: how much what triangles stand for is curved, from the bends of their edges that are no creases."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.bending import bending
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

# A triangle so many times as wide as its neighbour does not belong to the same arc.
WIDE = 3.0


def curvatures(mesh: Polyhedron, crease: Bools) -> Floats:
    """One over the radius of the arc that each triangle stands for, (F,): 0 where it is flat.

    An edge that bends by an angle lies between two pieces of an arc, whose length is the mean height of its triangles.
    crease: (H,), the edges that do not count. Neither does an edge for a triangle that is much wider than the other
    one, which is the plane in which a round ends.
    """
    area = np.linalg.norm(vector_areas(mesh), axis=1)
    height = 2 * area[mesh.face] / np.maximum(mesh.edge_lengths, np.finfo(float).tiny)
    other = height[mesh.twin]
    angle = np.where(crease | (height > WIDE * other), 0.0, bending(mesh).angle)
    length = np.minimum((height + other) / 2, height)
    return np.asarray((angle / np.maximum(length, np.finfo(float).tiny)).reshape(-1, 3).max(axis=1))
