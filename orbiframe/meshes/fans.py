"""Fans: the runs of faces round a vertex; one of them where the polyhedron is a surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.meshes.polyhedron import Polyhedron

Ints = NDArray[np.intp]


def fan_labels(polyhedron: Polyhedron) -> tuple[int, Ints]:
    """The number of fans (runs of faces round a vertex) and the fan of every corner, (H,)."""
    glued = np.flatnonzero(polyhedron.twin >= 0)
    twin = polyhedron.twin[glued]
    same = polyhedron.same[glued]
    start = np.where(same, twin, polyhedron.next[twin])
    size = len(polyhedron.tail)
    graph = coo_array((np.ones(len(glued)), (glued, start)), shape=(size, size)).tocsr()
    ends = np.where(same, polyhedron.next[twin], twin)
    graph = graph + coo_array((np.ones(len(glued)), (polyhedron.next[glued], ends)), shape=(size, size)).tocsr()
    count, label = connected_components(graph, directed=False)
    return int(count), label.astype(np.intp)


def fans_at_vertices(polyhedron: Polyhedron) -> Ints:
    """The number of fans at every vertex, (V,); 1 at the vertices of a surface, 0 where there is no face."""
    count, label = fan_labels(polyhedron)
    owner = np.empty(count, dtype=np.intp)
    owner[label] = polyhedron.tail
    return np.bincount(owner, minlength=len(polyhedron.vertices))
