"""Seams: where the plane faces of a shape end in something curved without an edge, as a plane does in a round."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.meshes.bending import bending
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Triangles that bend by less are one plane.
_FLAT = np.radians(0.5)
# A plane face is so many times as wide as what most of its border that is no crease runs along.
_WIDE, _MOST = 3.0, 0.8
# To what it runs along it bends by at most this share of the bends beyond: half of them where a round is even.
_AS_MUCH = 1.2


def seams(mesh: Polyhedron, crease: Bools) -> Bools:
    """The borders of the plane faces of a triangle mesh as far as they are no creases, (H,).

    crease: (H,), the sharp edges.
    """
    region, plane = plane_faces(mesh, crease)
    own, other = region[mesh.face], region[mesh.face[mesh.twin]]
    return np.asarray((own != other) & ~crease & (plane[own] | plane[other]))


def plane_faces(mesh: Polyhedron, crease: Bools) -> tuple[Ints, Bools]:
    """The region of every triangle of a mesh, (F,), and whether each region is a plane face, (R,).

    crease: (H,), the sharp edges. Triangles in one plane are one region, whose width is twice its area over its
    perimeter. The strips of which a round is made are regions as well. A region is a plane face if most of its border
    that is no crease runs along narrower ones, to which it bends no more than these do to those beyond: a wide strip of
    a round among narrow ones bends more.
    """
    angle = bending(mesh).angle
    region = _regions(mesh, (angle < _FLAT) & ~crease)
    border = region[mesh.face] != region[mesh.face[mesh.twin]]
    area = np.bincount(region, weights=np.linalg.norm(vector_areas(mesh), axis=1))
    perimeter = np.bincount(region[mesh.face], weights=mesh.edge_lengths * border, minlength=len(area))
    width = 2 * area / np.maximum(perimeter, np.finfo(float).tiny)
    soft, own, other = border & ~crease, region[mesh.face], region[mesh.face[mesh.twin]]
    much = mesh.edge_lengths * soft
    tangent = angle <= _AS_MUCH * _beyond(np.where(soft, angle, 0.0), own, other)
    narrow = np.bincount(own, weights=much * (tangent & (width[own] > _WIDE * width[other])), minlength=len(area))
    return region, np.asarray(narrow > _MOST * np.bincount(own, weights=much, minlength=len(area)))


def _beyond(angle: Floats, own: Ints, other: Ints) -> Floats:
    """For every halfedge the largest angle by which the region beyond it bends to a third one, (H,)."""
    order = np.lexsort((angle, own))
    last = order[np.append(np.flatnonzero(np.diff(own[order])), len(order) - 1)]
    largest, neighbour = np.zeros(int(own.max()) + 1), np.full(int(own.max()) + 1, -1)
    largest[own[last]], neighbour[own[last]] = angle[last], other[last]
    second, third = np.zeros(len(largest)), other != neighbour[own]
    np.maximum.at(second, own[third], angle[third])
    return np.asarray(np.where(neighbour[other] == own, second[other], largest[other]))


def _regions(mesh: Polyhedron, joined: Bools) -> Ints:
    """The number of the region of every triangle, (F,); joined: (H,), the edges inside of regions."""
    links = mesh.face[joined], mesh.face[mesh.twin[joined]]
    graph = coo_array((np.ones(len(links[0])), links), shape=(mesh.face_count, mesh.face_count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.intp)
