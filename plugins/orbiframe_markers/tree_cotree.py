"""Tree-cotree: short loops that cut a closed polyhedron open to a disc (Erickson and Whittlesey 2005)."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import Ge
from numpy.typing import NDArray

from orbiframe import Marking, Polyhedron
from orbiframe.groups import marking_along
from orbiframe.meshes import Graph, dijkstra_forest, edge_graph, farthest_points, first_largest, joining_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


class _Cut(NamedTuple):
    """The length of all loops, their base, and the halfedges (H,) of the tree and the cotree."""

    length: float
    base: int
    tree: Bools
    cotree: Bools


def tree_cotree(polyhedron: Polyhedron, *, bases: Annotated[int, Ge(1)] = 8) -> Marking:
    """The marking with the shortest loops from one of a few base points.

    The tree has the shortest paths from the base. Among the other edges the cotree is the maximum spanning tree of the
    faces, where an edge counts as the loop over it is long; the 2 - chi edges that are left give the shortest system of
    loops at this base. bases: how many vertices, spread evenly, are tried as the base. Raises TopologyError where the
    polyhedron is not closed.
    """
    graph = edge_graph(polyhedron)
    spread = farthest_points(graph, bases, first=_outermost(polyhedron)).chosen
    cut = min((_cut(polyhedron, graph, int(base)) for base in spread), key=lambda cut: cut.length)
    return marking_along(polyhedron, cut.base, cut.tree, cut.cotree)


def _outermost(polyhedron: Polyhedron) -> int:
    """The vertex farthest from the mean of all corners: the same one however vertices and faces are numbered."""
    points = polyhedron.vertices[polyhedron.tail]
    return int(polyhedron.tail[first_largest(np.linalg.norm(points - points.mean(axis=0), axis=1))])


def _cut(polyhedron: Polyhedron, graph: Graph, base: int) -> _Cut:
    forest = dijkstra_forest(graph, [base])
    tree = _both(polyhedron, graph.halfedge[forest.link[forest.link >= 0]])
    far = forest.distance
    loop = far[polyhedron.tail] + polyhedron.edge_lengths + far[polyhedron.head]
    cotree = _both(polyhedron, _spanning(polyhedron, np.flatnonzero(polyhedron.representative & ~tree), loop))
    sides = polyhedron.representative & ~tree & ~cotree
    return _Cut(float(loop[sides].sum()), base, tree, cotree)


def _both(polyhedron: Polyhedron, halfedges: Ints) -> Bools:
    """Marks (H,) on halfedges and their twins."""
    marked = np.zeros(len(polyhedron.tail), dtype=np.bool_)
    marked[halfedges] = marked[polyhedron.twin[halfedges]] = True
    return marked


def _spanning(polyhedron: Polyhedron, edges: Ints, weight: Floats) -> Ints:
    """Those of the edges, given by a halfedge each, that make the maximum spanning tree of the faces."""
    edges = edges[np.argsort(-weight[edges], kind="stable")]
    ends = polyhedron.face[edges], polyhedron.face[polyhedron.twin[edges]]
    return edges[joining_edges(polyhedron.face_count, *ends)]
