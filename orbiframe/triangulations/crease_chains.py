"""Crease chains: the marked edges of a mapped mesh as curves between stops, and where they run in X."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.edge_paths import Graph, edge_graph
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Where a crease turns by more in space, it has a corner.
_TURN = np.radians(20)
# Barycentric coordinates below this are those of points of an edge.
_ON_EDGE = 1e-9


class Chain(NamedTuple):
    """A curve along edges: its vertices (m + 1,), the transitions from the frame of each to the next one (m,), and the
    first halfedge of the mesh that it runs along.
    """

    vertices: Ints
    steps: Ints
    first: int

    def frames(self, triangulation: Triangulation) -> Floats:
        """The isometries from the patches of all vertices to that of the first one, (m + 1, 3, 3)."""
        isometry, found = triangulation.orbifold.atlas.isometry, [np.eye(3)]
        for step in self.steps:
            found.append(found[-1] @ isometry[step])
        return np.array(found)

    def lifted(self, triangulation: Triangulation) -> Floats:
        """The vertices in the frame of the patch of the first one, (m + 1, 3)."""
        frames = self.frames(triangulation)
        return triangulation.orbifold.geometry.act(frames, triangulation.points[self.vertices])


class CreaseGraph(NamedTuple):
    """The creases of a mesh as a graph: its links (see `Graph`), and the vertices where curves begin and end."""

    mesh: Polyhedron
    graph: Graph
    links: Bools
    stops: Ints

    @classmethod
    def of(cls, mesh: Polyhedron, crease: Bools, stops: Ints | None = None, seam: Bools | None = None) -> CreaseGraph:
        """The graph of marked halfedges (H,), with the stops given, or the corners and ends of creases.

        seam: (H,), those of another kind; a curve is of one kind, and stops where it changes.
        """
        graph = edge_graph(mesh)
        links = crease[graph.halfedge]
        if stops is None:
            stops = _corners(mesh, graph, links)
            if seam is not None:
                smooth, sharp = (np.union1d(mesh.tail[kind], mesh.head[kind]) for kind in (seam, crease & ~seam))
                stops = np.union1d(stops, np.intersect1d(smooth, sharp))
        return cls(mesh, graph, links, np.asarray(stops))

    def chains(self, triangulation: Triangulation) -> Iterator[Chain]:
        """The curves from stop to stop, each once, and closed curves without a stop from their first vertex on.

        One that ends where no stop is ends there.
        """
        graph, done = self.graph, ~self.links
        stop = np.zeros(len(self.mesh.vertices), dtype=np.bool_)
        stop[self.stops] = True
        owner = np.repeat(np.arange(len(stop)), np.diff(graph.start))
        for first in np.concatenate([np.flatnonzero(self.links & stop[owner]), np.flatnonzero(self.links)]):
            if not done[first]:
                yield self._chain(triangulation, int(first), int(owner[first]), stop, done)

    def _chain(self, triangulation: Triangulation, link: int, begin: int, stop: Bools, done: Bools) -> Chain:
        graph, vertices, steps = self.graph, [begin], []
        first = int(graph.halfedge[link])
        while True:
            halfedge, back = graph.halfedge[link], graph.backward[link]
            step = triangulation.transition[halfedge]
            steps.append(triangulation.orbifold.atlas.inverse[step] if back else step)
            vertices.append(int(graph.neighbour[link]))
            done[link] = done[self._reverse(link, vertices[-1])] = True
            if stop[vertices[-1]] or vertices[-1] == begin:
                return Chain(np.array(vertices), np.array(steps), first)
            here = np.arange(graph.start[vertices[-1]], graph.start[vertices[-1] + 1])
            ahead = here[~done[here]]
            if not len(ahead):
                return Chain(np.array(vertices), np.array(steps), first)
            link = int(ahead[0])

    def _reverse(self, link: int, vertex: int) -> int:
        """The same edge seen from its other end."""
        graph = self.graph
        here = np.arange(graph.start[vertex], graph.start[vertex + 1])
        same = (graph.halfedge[here] == graph.halfedge[link]) & (graph.backward[here] != graph.backward[link])
        return int(here[same][0])


def on_crease(triangulation: Triangulation, face: Ints, barycentric: Floats) -> Bools:
    """Whether points at barycentric coordinates (n, 3) in triangles (n,) of the mesh lie on creases, (n,)."""
    assert triangulation.crease is not None
    mesh, crease = triangulation.polyhedron, triangulation.crease
    vertex = np.zeros(len(mesh.vertices), dtype=np.bool_)
    vertex[mesh.tail[crease]] = vertex[mesh.head[crease]] = True
    zero = barycentric < _ON_EDGE
    on_edge = (np.roll(zero, 1, axis=1) & crease.reshape(-1, 3)[face]).any(axis=1)
    at_vertex = vertex[mesh.triangles[face, barycentric.argmax(axis=1)]] & (zero.sum(axis=1) == 2)
    return np.asarray(on_edge | at_vertex)


def _corners(mesh: Polyhedron, graph: Graph, links: Bools) -> Ints:
    """The vertices where other than two creases meet, or where two meet at an angle."""
    owner = np.repeat(np.arange(len(mesh.vertices)), np.diff(graph.start))[links]
    degree = np.bincount(owner, minlength=len(mesh.vertices))
    way = mesh.vertices[graph.neighbour[links]] - mesh.vertices[owner]
    way /= np.maximum(np.linalg.norm(way, axis=1), np.finfo(float).tiny)[:, None]
    total = np.stack([np.bincount(owner, weights=way[:, i], minlength=len(degree)) for i in range(3)], axis=1)
    bent = np.linalg.norm(total, axis=1) > 2 * np.sin(_TURN / 2)
    return np.flatnonzero((degree > 0) & ((degree != 2) | bent))
