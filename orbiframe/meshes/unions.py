"""Disjoint union: several meshes as one, side by side."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from orbiframe.meshes.polyhedron import Polyhedron


def disjoint_union(meshes: Sequence[Polyhedron]) -> Polyhedron:
    """The faces of all meshes one after the other, nothing glued; normals are kept where all meshes have some."""
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
    )
