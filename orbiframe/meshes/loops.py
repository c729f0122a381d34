"""Boundary loops: the closed chains of open edges of a mesh, in the order in which one walks along them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import TopologyError
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


class Loop(NamedTuple):
    """A boundary loop: edge k runs from vertex k to vertex k + 1, and is the open halfedge k, which runs either way."""

    vertices: Ints
    halfedges: Ints

    def points(self, mesh: Polyhedron) -> Floats:
        """Where the vertices lie, (n, 3)."""
        return np.asarray(mesh.vertices[self.vertices])

    def length(self, mesh: Polyhedron) -> float:
        """The length of the loop in space."""
        return float(mesh.edge_lengths[self.halfedges].sum())

    def forward(self, mesh: Polyhedron) -> NDArray[np.bool_]:
        """Which of the halfedges run the way of the loop, (n,)."""
        return np.asarray(mesh.tail[self.halfedges] == self.vertices)


def boundary_loops(mesh: Polyhedron) -> list[Loop]:
    """The loops of a mesh in which at most two open edges meet at a vertex, each from its first halfedge on.

    Raises TopologyError where more meet: the loops touch there, and where one goes on is not known.
    """
    open_ = np.flatnonzero(mesh.twin < 0)
    ends = np.stack([mesh.tail[open_], mesh.head[open_]], axis=1)
    order = np.argsort(ends.ravel(), kind="stable")
    vertex, first, count = np.unique(ends.ravel()[order], return_index=True, return_counts=True)
    crowded = vertex[count != 2]
    if len(crowded):
        raise TopologyError(f"boundary loops touch at vertex {crowded[0]}; try again with --split-nonmanifold-vertices")
    # Side 2k + s is end s of open edge k; its partner is the other side at the same vertex.
    partner = np.empty(ends.size, dtype=np.intp)
    partner[order[first]], partner[order[first + 1]] = order[first + 1], order[first]
    return [_walked(ends, open_, sides) for sides in _chains(partner)]


def _chains(partner: Ints) -> list[list[int]]:
    """The sides at which the edges of each loop are entered."""
    ahead = partner.tolist()
    seen = [False] * (len(ahead) // 2)
    chains = []
    for edge in range(len(seen)):
        chain, side = [], 2 * edge
        while not seen[side // 2]:
            seen[side // 2] = True
            chain.append(side)
            side = ahead[side ^ 1]
        if chain:
            chains.append(chain)
    return chains


def _walked(ends: Ints, open_: Ints, sides: list[int]) -> Loop:
    edge, end = np.divmod(np.array(sides, dtype=np.intp), 2)
    return Loop(ends[edge, end], open_[edge])
