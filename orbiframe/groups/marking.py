"""Marking: a closed polyhedron cut open to a disc along short loops, which name its fundamental group (section 3.4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from orbiframe.compiled.decorator import compiled
from orbiframe.components.one_line import one_line
from orbiframe.errors import TopologyError
from orbiframe.meshes.edge_paths import joining_edges
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.words.word import Word, inverse_letters

Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Marking:
    """Generators of the fundamental group of a closed polyhedron, and for every halfedge the element that it carries.

    The faces, cut apart along a tree of edges and 2 - chi further edges, the sides, make a disc. With the tree shrunk
    to one point it is a polygon whose n sides `word` glues, with one vertex. A face corner lies at `position` p if p
    sides lie before it on the boundary of the disc, from corner 0 of the polygon on. So a halfedge is a chord of the
    polygon, and homotopic to the sides between its ends: no word is longer than n and none is ever reduced.

    polyhedron; word: n letters, letter k running along the edge of sides[k - 1]; position: (H,), one for every corner,
    0 to n - 1; sides: (2 - chi,) halfedges; loops: for every letter the vertices of a closed path from the base point
    along the tree, over the side and back. On a sphere there are no loops: the word is `aA`, every position is 0.
    """

    polyhedron: Polyhedron
    word: Word
    position: Ints
    sides: Ints
    loops: tuple[Ints, ...]

    __repr__ = one_line

    @property
    def transitions(self) -> tuple[Ints, Ints]:
        """The corners of the polygon, (H,) and (H,), between which every halfedge runs.

        From p to q it is homotopic to the letters p, p + 1, ... q - 1 (mod n) of the word; from p to p it is trivial.
        """
        return self.position, self.position[self.polyhedron.next]

    def subword(self, halfedge: int) -> tuple[int, ...]:
        """The letters that a halfedge carries from its tail to its head, along the shorter way round the polygon."""
        start, end = (int(place[halfedge]) for place in self.transitions)
        forward = _between(self.word.letters, start, end)
        backward = _between(self.word.letters, end, start)
        return forward if len(forward) <= len(backward) or start == end else inverse_letters(backward)

    @property
    def loop_length(self) -> float:
        """The length in space of all loops together."""
        points = self.polyhedron.vertices
        return float(sum(np.linalg.norm(np.diff(points[loop], axis=0), axis=1).sum() for loop in self.loops))


def _between(letters: tuple[int, ...], start: int, end: int) -> tuple[int, ...]:
    """The letters of a cyclic word from corner `start` to corner `end`."""
    return (letters[start:] + letters[:start])[: (end - start) % len(letters)]


def marking_along(polyhedron: Polyhedron, base: int, tree: Bools, cotree: Bools) -> Marking:
    """The marking by a tree of edges through all vertices and a tree of other edges that joins all faces.

    polyhedron: closed and connected; base: vertex at which the loops begin; tree, cotree: (H,), both halfedges of an
    edge alike. Letters are named in the order in which the boundary of the disc meets them, each positive at first.
    Edges are halfedges throughout, so vertices may share several edges and a face may meet itself. Raises
    TopologyError where the polyhedron is not closed or the edges are no such trees.
    """
    _require_trees(polyhedron, tree, cotree)
    turned = _turned_faces(polyhedron, cotree)[polyhedron.face]
    is_side = ~(tree | cotree)
    order, position = _boundary(polyhedron, turned, cotree, is_side)
    letters, sides = _letters(polyhedron, order, turned)
    word = Word(tuple(letters.tolist())) if len(letters) else Word((1, -1))
    ends = polyhedron.tail[sides], polyhedron.head[sides]
    start, end = np.where(turned[sides], ends[::-1], ends)
    return Marking(polyhedron, word, position, sides, _loops(polyhedron, base, tree, start, end))


def _letters(polyhedron: Polyhedron, order: Ints, turned: Bools) -> tuple[Ints, Ints]:
    """The letters (n,) of the side halfedges in their order, and the halfedge that comes first for every letter."""
    _, first, number = np.unique(polyhedron.edge[order], return_index=True, return_inverse=True)
    leading = order[first][number]
    # Is the arrow of a halfedge that of the first one on its edge? A turned face is run through against its arrows.
    arrow = (order == leading) | polyhedron.same[order]
    positive = arrow ^ turned[order] ^ turned[leading]
    label = np.empty(len(first), dtype=np.intp)
    label[np.argsort(first)] = 1 + np.arange(len(first))
    return np.where(positive, label[number], -label[number]), order[np.sort(first)]


def _require_trees(polyhedron: Polyhedron, tree: Bools, cotree: Bools) -> None:
    if not len(polyhedron.tail) or (polyhedron.twin < 0).any():
        raise TopologyError("only a closed polyhedron has a marking; close its open edges first")
    vertices = len(np.unique(polyhedron.tail))
    ends = polyhedron.tail, polyhedron.head, len(polyhedron.vertices)
    faces = polyhedron.face, polyhedron.face[polyhedron.twin], polyhedron.face_count
    for name, marked, nodes, (a, b, size) in (("tree", tree, vertices, ends), ("cotree", cotree, faces[2], faces)):
        chosen = np.flatnonzero(marked & polyhedron.representative)
        parts = nodes - int(joining_edges(size, a[chosen], b[chosen]).sum())
        if parts != 1 or len(chosen) != nodes - 1 or (marked[polyhedron.twin] != marked).any():
            raise TopologyError(
                f"the {name} of a marking has {len(chosen)} edges in {parts} parts; it needs {nodes - 1} in one"
            )
    if (tree & cotree).any():
        raise TopologyError("an edge lies in the tree and in the cotree of a marking; it may lie in one of them")


def _turned_faces(polyhedron: Polyhedron, cotree: Bools) -> Bools:
    """The faces (F,) to be turned over so that faces on both sides of every cotree edge are oriented alike."""
    return np.asarray(
        _turned(polyhedron.offsets, polyhedron.face, polyhedron.twin, polyhedron.same, cotree, polyhedron.face_count)
    )


@compiled
def _turned(offsets, face, twin, same, crossed, count):  # type: ignore[no-untyped-def]
    """From face 0 through the tree: of two faces that run the same way along their edge one is turned over."""
    turned, reached = np.zeros(count, dtype=np.bool_), np.zeros(count, dtype=np.bool_)
    reached[0] = True
    waiting = [0]
    while waiting:
        here = waiting.pop()
        for halfedge in range(offsets[here], offsets[here + 1]):
            there = face[twin[halfedge]]
            if crossed[halfedge] and not reached[there]:
                reached[there] = True
                turned[there] = turned[here] != same[halfedge]
                waiting.append(there)
    return turned


def _boundary(polyhedron: Polyhedron, turned: Bools, cotree: Bools, is_side: Bools) -> tuple[Ints, Ints]:
    """The side halfedges in the order in which the boundary of the disc passes them, (n,), and the positions (H,)."""
    size = len(polyhedron.tail)
    before = np.empty(size, dtype=np.intp)
    before[polyhedron.next] = np.arange(size)
    ahead = np.where(turned, before, polyhedron.next)
    corner = np.where(turned, np.arange(size), polyhedron.next)
    sides = np.flatnonzero(is_side)
    first = sides[0] if len(sides) else 0
    order, position = _walked(first, ahead, corner, polyhedron.twin, cotree, is_side, len(sides))
    return order, position


@compiled
def _walked(first, ahead, corner, twin, crossed, is_side, count):  # type: ignore[no-untyped-def]
    """One step for every corner: turn about it from one edge of its face to the next, and cross that in the disc."""
    order, position = np.empty(count, dtype=np.intp), np.empty(len(ahead), dtype=np.intp)
    passed, halfedge = 0, first
    for _ in range(len(ahead)):
        position[corner[halfedge]] = passed
        halfedge = ahead[halfedge]
        if crossed[halfedge]:
            halfedge = twin[halfedge]
        elif is_side[halfedge]:
            order[passed] = halfedge
            passed += 1
    return order, position


def _loops(polyhedron: Polyhedron, base: int, tree: Bools, start: Ints, end: Ints) -> tuple[Ints, ...]:
    """From the base along the tree to the start of every side, over it, and back along the tree."""
    edges, size = np.flatnonzero(tree & polyhedron.representative), len(polyhedron.vertices)
    ends = polyhedron.tail[edges], polyhedron.head[edges]
    graph = coo_array((np.ones(len(edges)), ends), shape=(size, size)).tocsr()
    parent = breadth_first_order(graph, base, directed=False)[1].astype(np.intp)
    paths = ((_path(parent, base, int(i)), _path(parent, base, int(j))) for i, j in zip(start, end, strict=True))
    return tuple(np.array(there[::-1] + back, dtype=np.intp) for there, back in paths)


def _path(parent: Ints, base: int, vertex: int) -> list[int]:
    """The vertices from a vertex up the tree to the base."""
    path = [vertex]
    while path[-1] != base:
        path.append(int(parent[path[-1]]))
    return path
