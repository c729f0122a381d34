"""Unrolled: X/H cut open, every triangle of a triangulation once in X."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# So many triangles are tried as the middle.
_TRIED = 16
# What a step within a group of triangles counts, against the shortest step between two.
_INSIDE = 1e-9


class Unrolled(NamedTuple):
    """A fundamental domain of triangles in one frame of X.

    placement: (F, 3, 3), takes coordinates in the frame of the first corner of each triangle to that frame, whose
    origin lies in the middle of the domain; joined: (H,), the halfedges across which two triangles lie side by side in
    it; the others are the sides of the domain, glued in pairs by elements of H.
    """

    placement: Floats
    joined: NDArray[np.bool_]


def unrolled(triangulation: Triangulation, group: Ints | None = None) -> Unrolled:
    """X/H cut open along edges: each triangle lies where the shortest way to it from the middle ends.

    Ways run from triangle to triangle, and their lengths are those of the geodesics between the centres; so the domain
    is about that of Dirichlet, and its points lie no farther from the origin than its radius. group: (F,), triangles
    of a connected group, of the same number, are not cut apart. Of sixteen triangles the one is the middle from which
    the farthest is nearest. No two triangles overlap where those of the map do not: copies of X/H tile X.

    Ways of a mesh with a boundary leave it only for the triangles that close it, which are joined to none.
    """
    geometry, p = triangulation.orbifold.geometry, triangulation.polyhedron
    here = np.arange(len(p.tail))
    twin_corner = np.where(p.same, p.twin, p.next[p.twin])
    frames = triangulation.orbifold.atlas.isometry[triangulation.corner_transitions].reshape(-1, 3, 3)
    step = frames[here] @ geometry.inverse(frames[twin_corner])  # from the frame of the neighbour to that of the face
    a, b = p.face, p.face[p.twin]
    centre = geometry.project(triangulation.lifts.sum(axis=1))
    length = geometry.distance(centre[a], geometry.act(step, centre[b]))
    if group is not None:
        inside = group[a] == group[b]
        length = np.where(inside, _INSIDE * length[~inside].min(initial=np.inf, where=length[~inside] > 0), length)
    own = np.isin(np.arange(p.face_count), triangulation.own_faces)
    length = np.where(own[a] & own[b], length, length + length.sum())
    ways = _shortest_edges(a, b, length, p.face_count)
    middle, before = _shortest_ways(a[ways], b[ways], length[ways], own)
    ways = ways[before[b[ways]] == a[ways]]
    placement = _placed(before, b[ways], step[ways], middle)
    placement = geometry.inverse(geometry.carry(centre[middle])) @ placement
    return Unrolled(placement, own[a] & own[b] & _joined(triangulation, placement))


def _shortest_edges(a: Ints, b: Ints, length: Floats, count: int) -> Ints:
    """One halfedge from each triangle to each of its neighbours, the shortest where they share several."""
    order = np.lexsort((length, b, a))
    return order[np.flatnonzero(np.diff(a[order] * count + b[order], prepend=-1))]


def _shortest_ways(a: Ints, b: Ints, length: Floats, own: NDArray[np.bool_]) -> tuple[int, Ints]:
    """The middle, and for every triangle the one before it on the shortest way from there (negative for the middle)."""
    graph = coo_array((np.maximum(length, np.finfo(float).tiny), (a, b)), (len(own), len(own))).tocsr()
    faces = np.flatnonzero(own)
    tried = faces[np.unique(np.linspace(0, len(faces) - 1, min(_TRIED, len(faces))).astype(np.intp))]
    middle = int(tried[np.argmin(dijkstra(graph, indices=tried)[:, own].max(axis=1))])
    before = dijkstra(graph, indices=np.array([middle]), return_predecessors=True)[1]
    return middle, before[0].astype(np.intp)


def _placed(before: Ints, after: Ints, step: Floats, middle: int) -> Floats:
    """The placement of every triangle in the frame of the middle one, level by level of the tree of shortest ways.

    step: (n, 3, 3), from the frame of the triangle after[k] to that of the one before it.
    """
    count = len(before)
    steps, placement = np.zeros((count, 3, 3)), np.zeros((count, 3, 3))
    steps[after], placement[middle] = step, np.eye(3)
    order = np.argsort(before, kind="stable")
    start = np.searchsorted(before[order], np.arange(count + 1))
    level = np.array([middle])
    while len(level):
        level = np.concatenate([order[start[k] : start[k + 1]] for k in level.tolist()])
        if len(level):
            placement[level] = placement[before[level]] @ steps[level]
    return placement


def _joined(triangulation: Triangulation, placement: Floats) -> NDArray[np.bool_]:
    """The halfedges whose ends lie at the same places of X as those of their twins."""
    geometry, p = triangulation.orbifold.geometry, triangulation.polyhedron
    corners = np.einsum("fij,fcj->fci", placement, triangulation.lifts)
    ends = corners.reshape(-1, 3), corners[p.face, (np.arange(len(p.tail)) + 1) % 3]
    twin_ends = [end[p.twin] for end in ends]
    tails = np.where(p.same[:, None], twin_ends[0], twin_ends[1])
    heads = np.where(p.same[:, None], twin_ends[1], twin_ends[0])
    long = geometry.distance(*ends)
    apart = np.maximum(geometry.distance(ends[0], tails), geometry.distance(ends[1], heads))
    return np.asarray(apart < 0.5 * long)
