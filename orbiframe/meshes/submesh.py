"""Submesh: some of the faces of a mesh, with open edges where their neighbours are gone."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.polyhedron import Polyhedron

Ints = NDArray[np.intp]


class Submesh(NamedTuple):
    """A mesh of some faces of another, and which of its vertices those are, (V,), in their order."""

    mesh: Polyhedron
    vertices: Ints


def submesh(mesh: Polyhedron, faces: NDArray[np.bool_]) -> Submesh:
    """The marked faces (F,), glued to one another as before, with the vertices that they have; tables go along."""
    corner = faces[mesh.face]
    number = np.cumsum(corner) - 1
    twin = mesh.twin[corner]
    kept = (twin >= 0) & corner[twin]
    used = np.zeros(len(mesh.vertices), dtype=np.bool_)
    used[mesh.tail[corner]] = True
    normals, colors = (None if table is None else table[used] for table in (mesh.normals, mesh.colors))
    found = replace(
        mesh,
        vertices=mesh.vertices[used],
        offsets=np.concatenate([[0], np.cumsum(mesh.face_sizes[faces])]),
        tail=(np.cumsum(used) - 1)[mesh.tail[corner]],
        twin=np.where(kept, number[twin], -1),
        same=mesh.same[corner] & kept,
        normals=normals,
        colors=colors,
        face_colors=None if mesh.face_colors is None else mesh.face_colors[faces],
        corner_uv=None if mesh.corner_uv is None else mesh.corner_uv[corner],
        corner_normals=None if mesh.corner_normals is None else mesh.corner_normals[corner],
        marked=None if mesh.marked is None else mesh.marked.renumbered(np.where(used, np.cumsum(used) - 1, -1)),
    )
    return Submesh(found, np.flatnonzero(used))
