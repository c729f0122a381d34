"""Double cover: the orientable surface that covers a nonorientable one twice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe.meshes import fan_labels, reversed_faces

Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class DoubleCover:
    """The oriented double cover and the way down.

    polyhedron: 2V vertices, 2F faces; below: (2V,), the vertex under each; mate: (2V,), the other vertex over the same
    one; chosen: (V,), one vertex over each; tail, head: (H,), the ends in the first sheet of every halfedge below.
    """

    polyhedron: Polyhedron
    below: Ints
    mate: Ints
    chosen: Ints
    tail: Ints
    head: Ints


def double_cover(mesh: Polyhedron) -> DoubleCover:
    """Every face twice, once in each orientation; an edge whose twin runs the same way changes the sheet."""
    size, count = len(mesh.tail), mesh.face_count
    other = np.where(mesh.same, size, 0)
    twin = np.concatenate([mesh.twin + other, mesh.twin + size - other])
    offsets = np.concatenate([mesh.offsets, mesh.offsets[1:] + size])
    sheets = Polyhedron(mesh.vertices, offsets, np.tile(mesh.tail, 2), twin, np.tile(mesh.same, 2))
    total, label = fan_labels(sheets)
    below = np.empty(total, dtype=np.intp)
    below[label] = sheets.tail
    mate = np.empty(total, dtype=np.intp)
    mate[label[:size]], mate[label[size:]] = label[size:], label[:size]
    chosen = np.empty(len(mesh.vertices), dtype=np.intp)
    chosen[below[::-1]] = np.arange(total)[::-1]
    cover = Polyhedron(mesh.vertices[below], offsets, label, twin, sheets.same)
    flip = np.arange(2 * count) >= count
    return DoubleCover(reversed_faces(cover, flip), below, mate, chosen, label[:size], label[:size][mesh.next])
