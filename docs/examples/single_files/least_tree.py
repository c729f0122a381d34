"""Least tree: a marker that cuts along the shortest tree of edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import Marking, Polyhedron
from orbiframe.groups import marking_along
from orbiframe.meshes import joining_edges, outermost_vertex
from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The marker of this file."""
    return [Component("marker", "least-tree", "least_tree:least_tree", "loops along the shortest tree of edges")]


def least_tree(polyhedron: Polyhedron) -> Marking:
    """The marking by the shortest tree of edges through all vertices, and the longest one across all faces."""
    edges = np.flatnonzero(polyhedron.representative)
    edges = edges[np.argsort(polyhedron.edge_lengths[edges], kind="stable")]
    in_tree = joining_edges(len(polyhedron.vertices), polyhedron.tail[edges], polyhedron.head[edges])
    tree = _marked(polyhedron, edges[in_tree])
    rest = edges[~in_tree][::-1]
    across = polyhedron.face[rest], polyhedron.face[polyhedron.twin[rest]]
    cotree = _marked(polyhedron, rest[joining_edges(polyhedron.face_count, *across)])
    return marking_along(polyhedron, outermost_vertex(polyhedron), tree, cotree)


def _marked(polyhedron: Polyhedron, halfedges: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Marks (H,) on halfedges and their twins."""
    marks = np.zeros(len(polyhedron.tail), dtype=np.bool_)
    marks[halfedges] = marks[polyhedron.twin[halfedges]] = True
    return marks
