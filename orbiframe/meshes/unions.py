"""Disjoint union: several meshes as one, side by side."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.polyhedron import Polyhedron


def disjoint_union(meshes: Sequence[Polyhedron]) -> Polyhedron:
    """The faces of all meshes one after the other, nothing glued; normals are kept where all meshes have some.

    If a mesh has normals of corners, the corners of the others get those of their vertices. Unit squares of texture
    coordinates, where all meshes have some, are put side by side into one.
    """
    vertices = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    halfedges = np.cumsum([0, *(len(mesh.tail) for mesh in meshes)])
    normals = [mesh.normals for mesh in meshes if mesh.normals is not None]
    twins = [np.where(mesh.twin < 0, -1, mesh.twin + first) for mesh, first in zip(meshes, halfedges, strict=False)]
    return Polyhedron(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.cumsum([0, *np.concatenate([mesh.face_sizes for mesh in meshes])]),
        np.concatenate([mesh.tail + first for mesh, first in zip(meshes, vertices, strict=False)]),
        np.concatenate(twins),
        np.concatenate([mesh.same for mesh in meshes]),
        np.concatenate(normals) if len(normals) == len(meshes) else None,
        corner_normals=_corner_normals(meshes) if len(normals) == len(meshes) else None,
        corner_uv=_corner_uv(meshes),
    )


def _corner_normals(meshes: Sequence[Polyhedron]) -> NDArray[np.float64] | None:
    if all(mesh.corner_normals is None for mesh in meshes):
        return None
    own = [mesh.normals[mesh.tail] if mesh.normals is not None else np.zeros((len(mesh.tail), 3)) for mesh in meshes]
    given = [mesh.corner_normals for mesh in meshes]
    return np.concatenate([a if b is None else b for a, b in zip(own, given, strict=True)])


def _corner_uv(meshes: Sequence[Polyhedron]) -> NDArray[np.float64] | None:
    given = [mesh.corner_uv for mesh in meshes if mesh.corner_uv is not None]
    if len(given) < len(meshes):
        return None
    across = math.ceil(math.sqrt(len(given)))
    places = [np.array([number % across, number // across]) for number in range(len(given))]
    return np.concatenate([(uv + place) / across for uv, place in zip(given, places, strict=True)])
