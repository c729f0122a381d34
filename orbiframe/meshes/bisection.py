"""Bisection: a triangle mesh refined until no edge is too long, and points found in it again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.one_line import one_line
from orbiframe.errors import TopologyError
from orbiframe.meshes.edge_log import EdgeLog
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.meshes.surface_type import doubled_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Meshes without thousands of equal edges round a vertex are refined in 5 to 35 rounds.
_PATIENCE = 50
# Triangles for each vertex that is aimed at.
_MOST = 20


@dataclass(frozen=True, eq=False)
class Bisection:
    """A triangle mesh and its refinement by halving edges, as a forest of triangles.

    coarse, polyhedron: the mesh before and after; its first vertices are the coarse ones. side: (N,), the side across
    which node n of the forest is halved, -1 at a leaf; child: (N,), the first half, the second one follows it, or at
    a leaf the triangle of the refined mesh. log: of the edges of the coarse mesh that were flipped or halved before;
    None for none. The first nodes are the triangles after these steps.
    """

    coarse: Polyhedron
    polyhedron: Polyhedron
    side: Ints
    child: Ints
    log: EdgeLog | None = None

    __repr__ = one_line

    @property
    def facets(self) -> Polyhedron:
        """The coarse mesh after the steps of the log: its triangles are those that are halved."""
        return self.coarse if self.log is None else self.log.after

    def locate(self, face: Ints, barycentric: Floats) -> tuple[Ints, Floats]:
        """The fine triangle (n,) and the barycentric coordinates in it (n, 3) of points of coarse triangles."""
        if self.log is not None:
            face, barycentric = self.log.locate(face, barycentric)
        node = np.array(face, dtype=np.intp)
        weights = np.array(barycentric, dtype=np.float64)
        active = np.flatnonzero(self.side[node] >= 0)
        while len(active):
            side = self.side[node[active]]
            rows = np.arange(len(active))
            a, b, c = (weights[active][rows, (side + k) % 3] for k in range(3))
            second = b > a
            # Halves are (a, middle, c) and (middle, b, c); the middle takes twice the smaller of the two weights.
            first_half = np.stack([a - b, 2 * b, c], axis=1)
            second_half = np.stack([2 * a, b - a, c], axis=1)
            weights[active] = np.where(second[:, None], second_half, first_half)
            node[active] = self.child[node[active]] + second
            active = active[self.side[node[active]] >= 0]
        return self.child[node], weights

    def in_facets(self) -> Ints:
        """One of the fine triangles of each facet, (F,)."""
        node = np.arange(self.facets.face_count)
        while (inner := self.side[node] >= 0).any():
            node[inner] = self.child[node[inner]]
        return np.asarray(self.child[node])

    def composed(self, steps: Floats) -> Floats:
        """Products along the halfedges of the coarse mesh, (3F, k, k), of matrices on those of the fine one.

        steps: (H, k, k), such as the isometry from the frame at the head of a halfedge to that at its tail.
        """
        node = np.zeros((len(self.side), 3, *steps.shape[1:]))
        leaf = np.flatnonzero(self.side < 0)
        node[leaf] = steps.reshape(-1, 3, *steps.shape[1:])[self.child[leaf]]
        for parents in reversed(self._levels()):
            side, first = self.side[parents], node[self.child[parents]]
            second = node[self.child[parents] + 1]
            node[parents, side] = first[:, 0] @ second[:, 0]
            node[parents, (side + 1) % 3] = second[:, 1]
            node[parents, (side + 2) % 3] = first[:, 2]
        products = node[: self.facets.face_count].reshape(-1, *steps.shape[1:])
        return products if self.log is None else self.log.carried_back(products)

    def spread(self, corners: Floats) -> Floats:
        """Values at the corners of the facets, (F, 3, k), linearly at the corners of the fine triangles."""
        node = np.zeros((len(self.side), 3, corners.shape[2]))
        node[: len(corners)] = corners
        for parents in self._levels():
            side = self.side[parents]
            a, b, c = (node[parents, (side + k) % 3] for k in range(3))
            middle = (a + b) / 2
            node[self.child[parents]] = np.stack([a, middle, c], axis=1)
            node[self.child[parents] + 1] = np.stack([middle, b, c], axis=1)
        leaf = np.flatnonzero(self.side < 0)
        fine = np.empty((len(leaf), 3, corners.shape[2]))
        fine[self.child[leaf]] = node[leaf]
        return fine

    def origins(self) -> tuple[Ints, Floats]:
        """A coarse triangle (V,) that holds each vertex of the fine mesh, and barycentric coordinates in it (V, 3)."""
        count = self.facets.face_count
        corners = np.zeros((count, 3, 4))
        corners[:, :, 0], corners[:, :, 1:] = np.arange(count)[:, None], np.eye(3)
        fine = self.spread(corners).reshape(-1, 4)
        first = np.unique(self.polyhedron.tail, return_index=True)[1]
        facet, barycentric = fine[first, 0].round().astype(np.intp), fine[first, 1:]
        return (facet, barycentric) if self.log is None else self.log.led_back(facet, barycentric)

    def _levels(self) -> list[Ints]:
        """The nodes of the forest that are halved, those of each depth together, roots first."""
        levels = []
        node = np.flatnonzero(self.side[: self.facets.face_count] >= 0)
        while len(node):
            levels.append(node)
            below = np.concatenate([self.child[node], self.child[node] + 1])
            node = below[self.side[below] >= 0]
        return levels


def bisected(polyhedron: Polyhedron, longest: float, simplicial: bool = False, log: EdgeLog | None = None) -> Bisection:
    """The triangle mesh with edges halved until none is longer than `longest`; flat, watertight, same surface.

    log: of edges of the mesh that are flipped or halved first.

    simplicial: loops are halved too, and edges that share both ends with another one, until none is left; a map to X/H
    that is linear on each triangle needs that (see `doubled_edges`).

    An edge is halved when it is the longest of both its triangles, so that long thin triangles become rounder and no
    angle falls below half the least one of the mesh (Rivara 1984, 1997: longest-edge propagation). Deterministic:
    of equal edges the one with the larger index is halved first. Where that takes many rounds, as round a vertex of
    thousands of equal edges, edges count as equal that differ by less than a fifth, and a fixed mixture of the indices
    decides. A face that meets itself along an edge is halved across its third side first. Raises TopologyError for an
    open mesh, or a length that is not positive.
    """
    if not longest > 0:
        raise TopologyError(f"edges no longer than {longest} were asked for; the length must be positive")
    if (polyhedron.twin < 0).any():
        raise TopologyError("only a closed mesh is refined; `orbiframe info` lists its open edges")
    state = _State(polyhedron if log is None else log.after, simplicial)
    rounds = 0
    while len(edges := state.edges_to_halve(longest, rounds > _PATIENCE)):
        state.halve(edges)
        rounds += 1
    return Bisection(polyhedron, state.mesh(), state.side, state.child, log)


def edge_length_for(polyhedron: Polyhedron, vertices: int) -> float:
    """The longest edge that gives about so many vertices by bisection, spread evenly over the surface.

    Needle-like triangles need more: the length is doubled until about ten times as many are enough.
    """
    return affordable_length(polyhedron, even_edge_length(polyhedron, vertices), vertices)


def affordable_length(polyhedron: Polyhedron, longest: float, vertices: int) -> float:
    """A length, doubled until bisection to it adds no more than about ten times as many vertices as are aimed at."""
    while triangles_made(polyhedron, longest) > _MOST * vertices + polyhedron.face_count:
        longest *= 2
    return longest


def even_edge_length(polyhedron: Polyhedron, vertices: int) -> float:
    """The longest edge of triangles of about the same size and shape, with so many vertices, over the surface."""
    area = float(np.linalg.norm(vector_areas(polyhedron), axis=1).sum())
    # Edges end up between half the longest and the longest: a vertex holds about 0.42 of its square.
    return max(float(np.sqrt(area / (0.42 * vertices))), 1e-9 * float(polyhedron.edge_lengths.max()))


def triangles_made(polyhedron: Polyhedron, longest: float) -> float:
    """About how many triangles bisection makes of a triangle mesh until no edge is longer than `longest`.

    A needle becomes three triangles of half its longest side; once they are round, each becomes four.
    """
    areas = np.linalg.norm(vector_areas(polyhedron), axis=1)
    sides = polyhedron.edge_lengths.reshape(-1, 3).max(axis=1)
    halvings = np.log2(np.maximum(sides / longest, 1))
    heights = np.maximum(2 * areas / longest, np.finfo(float).tiny)
    with np.errstate(over="ignore"):
        slender = np.minimum(np.log2(np.maximum(sides**2 / (longest * heights), 1)), halvings)
    return float((3**slender * 4 ** (halvings - slender)).sum())


def _mixed(index: Ints) -> NDArray[np.uint64]:
    """Numbers in an order that has nothing to do with theirs (the finaliser of splitmix64)."""
    z = index.astype(np.uint64)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        z = (z ^ (z >> np.uint64(shift))) * np.uint64(factor)
    return z ^ (z >> np.uint64(31))


class _State:
    """The mesh while it is being refined: vertices, triangles, twins, and the forest."""

    def __init__(self, mesh: Polyhedron, simplicial: bool) -> None:
        self.made_simplicial = simplicial
        self.vertices = mesh.vertices
        self.triangles = mesh.triangles.copy()
        self.twin, self.same = mesh.twin.copy(), mesh.same.copy()
        self.node = np.arange(mesh.face_count)
        self.side = np.full(mesh.face_count, -1, dtype=np.intp)
        self.child = np.arange(mesh.face_count)

    def edges_to_halve(self, longest: float, roughly: bool = False) -> Ints:
        """One halfedge of each edge that must be halved and comes first in both its triangles.

        roughly: by steps of the length and in mixed order, so that many come first at once.
        """
        head = np.roll(self.triangles, -1, axis=1)
        length = np.linalg.norm(self.vertices[head] - self.vertices[self.triangles], axis=2).ravel()
        index = np.arange(len(length))
        edge = np.minimum(index, self.twin)
        # Both halfedges of an edge must compare alike, down to the last bit.
        length = length[edge]
        doubled = self._doubled()
        wanted = (length > longest) | doubled
        if not wanted.any():
            return index[:0]
        folded = index // 3 == self.twin // 3
        first = self._third_sides(folded & wanted)
        wanted = (wanted & ~folded) | first
        # Loops go before other doubled edges: without them no face has a vertex twice, and the doubled edges die out.
        loop = head.ravel() == self.triangles.ravel()
        urgency = np.where(folded, -1, 4 * first + 2 * (doubled & loop) + doubled)
        rank = np.empty(len(length), dtype=np.intp)
        size, order = (np.rint(4 * np.log2(np.maximum(length, 1e-300))), _mixed(edge)) if roughly else (length, edge)
        rank[np.lexsort((edge, order, size, urgency))] = index
        rank = np.maximum(rank, rank[self.twin])
        top = np.zeros(len(length), dtype=np.bool_)
        top[3 * np.arange(len(self.triangles)) + rank.reshape(-1, 3).argmax(axis=1)] = True
        return np.flatnonzero(top & top[self.twin] & (index == edge) & wanted)

    def _doubled(self) -> Bools:
        """The halfedges that must go from a simplicial complex; once it is one, halving keeps it so."""
        if not self.made_simplicial:
            return np.zeros(len(self.twin), dtype=np.bool_)
        doubled = doubled_edges(self.mesh())
        self.made_simplicial = bool(doubled.any()) or len(self.triangles) == 2
        return doubled

    def _third_sides(self, folded: Bools) -> Bools:
        """The halfedges, with their twins, of the third sides of faces whose other two are one edge, as marked."""
        index = np.flatnonzero(folded)
        sides = np.zeros(len(folded), dtype=np.bool_)
        sides[3 * (index // 3) + 3 - index % 3 - self.twin[index] % 3] = True
        return sides | sides[self.twin]

    def halve(self, edges: Ints) -> None:
        """Put a vertex in the middle of each edge and halve the two triangles beside it."""
        count, faces = len(self.vertices), len(self.triangles)
        halves = np.concatenate([edges, self.twin[edges]])
        middle = np.tile(count + np.arange(len(edges)), 2)
        face, side = halves // 3, halves % 3
        second = faces + np.arange(len(halves))
        a, b, c = (self.triangles[face, (side + k) % 3] for k in range(3))
        ends = self.triangles.ravel()[edges], np.roll(self.triangles, -1, axis=1).ravel()[edges]
        self.vertices = np.concatenate([self.vertices, (self.vertices[ends[0]] + self.vertices[ends[1]]) / 2])
        self._grow_forest(face, side, second)
        self._glue(edges, halves, face, side, second)
        self.triangles = np.concatenate([self.triangles, np.stack([middle, b, c], axis=1)])
        self.triangles[face] = np.stack([a, middle, c], axis=1)

    def _grow_forest(self, face: Ints, side: Ints, second: Ints) -> None:
        node = self.node[face]
        children = len(self.side) + 2 * np.arange(len(face))
        self.side[node], self.child[node] = side, children
        self.side = np.concatenate([self.side, np.full(2 * len(face), -1, dtype=np.intp)])
        self.child = np.concatenate([self.child, np.stack([face, second], axis=1).ravel()])
        self.node = np.concatenate([self.node, children + 1])
        self.node[face] = children

    def _glue(self, edges: Ints, halves: Ints, face: Ints, side: Ints, second: Ints) -> None:
        """Twins after halving: outer sides keep theirs, the cuts pair up, and so do the four half edges."""
        place = np.arange(len(self.twin))
        place[3 * face + (side + 1) % 3] = 3 * second + 1
        place[3 * face + (side + 2) % 3] = 3 * face + 2
        size = len(self.twin) + 3 * len(second)
        twin, same = np.full(size, -1, dtype=np.intp), np.zeros(size, dtype=np.bool_)
        outer = np.ones(len(self.twin), dtype=np.bool_)
        outer[halves] = False
        twin[place[outer]] = place[self.twin[outer]]
        same[place[outer]] = self.same[outer]
        twin[3 * face + 1], twin[3 * second + 2] = 3 * second + 2, 3 * face + 1
        n = len(edges)
        parallel = self.same[edges]
        near, far = 3 * face[:n], 3 * second[:n]
        other_near, other_far = 3 * face[n:], 3 * second[n:]
        for mine, alike, opposite in ((near, other_near, other_far), (far, other_far, other_near)):
            theirs = np.where(parallel, alike, opposite)
            twin[mine], twin[theirs] = theirs, mine
            same[mine] = same[theirs] = parallel
        self.twin, self.same = twin, same

    def mesh(self) -> Polyhedron:
        offsets = np.arange(len(self.triangles) + 1) * 3
        return Polyhedron(self.vertices, offsets, self.triangles.ravel(), self.twin, self.same)
