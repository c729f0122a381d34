"""Spacing: shortest paths along the edges of a polyhedron, vertices spread evenly by them, points sorted by place.

Lengths that agree to nine digits count as equal, so that on symmetric meshes the numbers of vertices decide, and never
rounding, which is another one on every processor.
"""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# A length is less than another one if it is less than this times that one; otherwise they count as equal.
_SHORTER = 1 - 1e-9
# Steps that put a zero bit between any two of the 32 lowest bits of a number.
_SPREAD_BITS = (
    (16, 0x0000FFFF0000FFFF),
    (8, 0x00FF00FF00FF00FF),
    (4, 0x0F0F0F0F0F0F0F0F),
    (2, 0x3333333333333333),
    (1, 0x5555555555555555),
)


class Graph(NamedTuple):
    """The edges of a polyhedron seen from its vertices.

    The links of vertex i are start[i] to start[i + 1] - 1. Link k leads to vertex neighbour[k], has length[k] >= 0 and
    runs along halfedge[k]; backward[k] says that it runs from the head of that halfedge to its tail. Every edge is two
    links, one each way. start: (V + 1,); the others: (2 edges,).
    """

    start: Ints
    neighbour: Ints
    length: Floats
    halfedge: Ints
    backward: Bools


class Spacing(NamedTuple):
    """Chosen vertices (k,); for every vertex (V,) the number of the nearest chosen one and the distance to it."""

    chosen: Ints
    owner: Ints
    distance: Floats


class Forest(NamedTuple):
    """Shortest paths from sources: distance (V,), number of the source (V,), last link of the path (V,).

    `link` indexes the links of the graph and is -1 at sources; `order` lists the vertices from near to far, so that
    every vertex stands after the one before it on its path. Vertices that no source reaches have distance inf and
    owner -1 and are missing from `order`. `parent` is the vertex before each on its path, -1 at sources.
    """

    distance: Floats
    owner: Ints
    link: Ints
    parent: Ints
    order: Ints


def edge_graph(polyhedron: Polyhedron, lengths: ArrayLike | None = None) -> Graph:
    """The graph of the edges of a polyhedron; lengths: one per halfedge, (H,), by default the lengths in space."""
    per_halfedge = polyhedron.edge_lengths if lengths is None else np.asarray(lengths, dtype=np.float64)
    edges = np.flatnonzero(polyhedron.representative)
    tail, head = polyhedron.tail[edges], polyhedron.head[edges]
    order = np.argsort(np.concatenate([tail, head]), kind="stable")
    degree = np.bincount(np.concatenate([tail, head]), minlength=len(polyhedron.vertices))
    halfedge = np.concatenate([edges, edges])[order]
    return Graph(
        start=np.concatenate([[0], np.cumsum(degree)]).astype(np.intp),
        neighbour=np.concatenate([head, tail])[order],
        length=np.ascontiguousarray(per_halfedge[halfedge], dtype=np.float64),
        halfedge=halfedge,
        backward=order >= len(edges),
    )


def farthest_points(graph: Graph, count: int, *, first: int = 0, radius: float = 0.0) -> Spacing:
    """Vertices spread evenly: each next one is the vertex farthest from all before it, the lowest of equals.

    Those that are equally far are taken one after the other, but for those that the ones before them come nearer to.
    Stops at `count` vertices, or as soon as every vertex lies closer than `radius` to a chosen one, or coincides with
    one. By incremental Dijkstra: a new vertex only searches the part of the graph that becomes its own.
    """
    return Spacing(*_farthest(graph.start, graph.neighbour, graph.length, count, first, radius))


def outermost_vertex(polyhedron: Polyhedron) -> int:
    """The vertex farthest from the mean of all vertices, the lowest of equals: where farthest points may begin."""
    x = polyhedron.vertices
    return first_largest(np.linalg.norm(x - x.mean(axis=0), axis=1))


def first_largest(values: Floats) -> int:
    """The index of the largest of some numbers that are not negative, (n,), and the lowest of those that equal it."""
    return int(np.argmax(values >= _SHORTER * values.max()))


def covering_points(graph: Graph, radius: float) -> Ints:
    """Vertices at least `radius` from each other, with all other vertices nearer than that to one of them.

    The first vertex, and then each next one that is still too far from all before it: as many as `farthest_points`
    takes, about, and several times faster, because nothing beyond the radius is searched.
    """
    return np.asarray(_covering(graph.start, graph.neighbour, graph.length, radius))


def dijkstra_forest(graph: Graph, sources: ArrayLike) -> Forest:
    """The shortest path from the nearest source to every vertex; of equal ones that of the lowest source and vertex."""
    return Forest(*_forest(graph.start, graph.neighbour, graph.length, np.asarray(sources, dtype=np.intp)))


def joining_edges(count: int, tail: Ints, head: Ints) -> Bools:
    """Which of the edges (E,) join parts of `count` vertices that the edges before them leave apart.

    They make a spanning forest; where the edges are sorted by length, the shortest one (Kruskal 1956).
    """
    return np.asarray(_joining(count, tail, head))


def curve_order(x: Floats) -> Ints:
    """Points of X in one frame, (n, 3), sorted along a space-filling curve, so that neighbours in the list are near.

    Morton's curve in (x1, x2) on a grid of 2^31 by 2^31 squares over the points, one half of S^2 after the other.
    """
    if len(x) == 0:
        return np.zeros(0, dtype=np.intp)
    plane = x[:, 1:] - x[:, 1:].min(axis=0)
    square = (plane * ((2**31 - 1) / (plane.max() or 1.0))).astype(np.uint64)
    for shift, mask in _SPREAD_BITS:
        square = (square | square << np.uint64(shift)) & np.uint64(mask)
    half = (x[:, 0] < 0).astype(np.uint64) << np.uint64(62)
    return np.argsort(square[:, 0] | square[:, 1] << np.uint64(1) | half, kind="stable")


@compiled
def _claim(start, neighbour, length, vertex, number, distance, owner):  # type: ignore[no-untyped-def]
    """Give a vertex all vertices that are nearer to it than they are now: their distance and owner."""
    distance[vertex], owner[vertex] = 0.0, number
    queue = [(0.0, vertex)]
    while queue:
        near, i = heapq.heappop(queue)
        if near > distance[i]:
            continue
        for k in range(start[i], start[i + 1]):
            j, far = neighbour[k], near + length[k]
            if far < _SHORTER * distance[j]:
                distance[j], owner[j] = far, number
                heapq.heappush(queue, (far, j))


@compiled
def _farthest(start, neighbour, length, count, first, radius):  # type: ignore[no-untyped-def]
    size = len(start) - 1
    distance, owner = np.full(size, np.inf), np.full(size, -1)
    chosen = np.empty(min(count, size), dtype=np.intp)
    # distances only fall: the top of `waiting` is the farthest vertex unless its entry is out of date
    waiting = [(-np.inf, vertex) for vertex in range(size)]
    found, farthest = 0, np.inf
    equals = [first]
    while True:
        while equals:
            vertex = heapq.heappop(equals)
            if found < len(chosen) and distance[vertex] >= _SHORTER * farthest:
                chosen[found] = vertex
                _claim(start, neighbour, length, vertex, found, distance, owner)
                found += 1
            else:
                heapq.heappush(waiting, (-distance[vertex], vertex))
        if found == len(chosen):
            break
        farthest = _farthest_left(waiting, distance, equals)
        if farthest < _SHORTER * radius or farthest == 0.0:
            break
    return chosen[:found].copy(), owner, distance


@compiled
def _farthest_left(waiting, distance, equals):  # type: ignore[no-untyped-def]
    """The greatest distance, and in the heap `equals` all vertices that are as far, which wait no longer."""
    farthest = 0.0
    while waiting:
        top, vertex = waiting[0]
        if -top != distance[vertex]:
            heapq.heapreplace(waiting, (-distance[vertex], vertex))
            continue
        if len(equals) and -top < _SHORTER * farthest:
            break
        farthest = max(farthest, -top)
        heapq.heappush(equals, vertex)
        heapq.heappop(waiting)
    return farthest


@compiled
def _covering(start, neighbour, length, radius):  # type: ignore[no-untyped-def]
    distance, owner = np.full(len(start) - 1, radius), np.full(len(start) - 1, -1)
    chosen = [np.intp(0) for _ in range(0)]
    for vertex in range(len(start) - 1):
        if distance[vertex] < _SHORTER * radius:
            continue
        chosen.append(np.intp(vertex))
        _claim(start, neighbour, length, vertex, vertex, distance, owner)
    return np.array(chosen)


@compiled
def _top(above, i):  # type: ignore[no-untyped-def]
    """The first of the part that i belongs to; the way there becomes half as long."""
    while above[i] != i:
        above[i] = above[above[i]]
        i = above[i]
    return i


@compiled
def _joining(count, tail, head):  # type: ignore[no-untyped-def]
    above = np.arange(count)
    joins = np.zeros(len(tail), dtype=np.bool_)
    for edge in range(len(tail)):
        i, j = _top(above, tail[edge]), _top(above, head[edge])
        if i != j:
            above[max(i, j)] = min(i, j)
            joins[edge] = True
    return joins


@compiled
def _forest(start, neighbour, length, sources):  # type: ignore[no-untyped-def]
    size = len(start) - 1
    distance, owner = np.full(size, np.inf), np.full(size, -1)
    link, parent, done = np.full(size, -1), np.full(size, -1), np.zeros(size, dtype=np.bool_)
    order = np.empty(size, dtype=np.intp)
    queue = [(0.0, np.intp(0)) for _ in range(0)]
    for number, vertex in enumerate(sources):
        if owner[vertex] < 0:
            distance[vertex], owner[vertex] = 0.0, number
            heapq.heappush(queue, (0.0, vertex))
    reached = 0
    while queue:
        _, i = heapq.heappop(queue)
        if done[i]:
            continue
        done[i], near = True, distance[i]
        order[reached] = i
        reached += 1
        for k in range(start[i], start[i + 1]):
            j, far = neighbour[k], near + length[k]
            if done[j]:
                continue
            equal = link[j] >= 0 and _SHORTER * far <= distance[j]
            if far < _SHORTER * distance[j] or (equal and (owner[i], i) < (owner[j], parent[j])):
                distance[j], owner[j], link[j], parent[j] = far, owner[i], k, i
                heapq.heappush(queue, (far, j))
    return distance, owner, link, parent, order[:reached].copy()
