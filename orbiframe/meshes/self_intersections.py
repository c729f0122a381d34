"""Self-intersections: which triangles of a mesh pass through others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.triangle_boxes import LEAF, TriangleBoxes

Ints = NDArray[np.intp]


def self_intersecting(mesh: Polyhedron) -> Ints:
    """The triangles, in order, that meet another one beyond a common vertex or edge.

    Two triangles that share an edge are not tried, and of two that share a vertex only the sides opposite to it, so
    that a fold along an edge is no intersection.
    """
    return intersections(mesh)[0]


def intersections(mesh: Polyhedron) -> tuple[Ints, int]:
    """The triangles that meet others, and how many pairs of an edge and a triangle were tried."""
    corners = mesh.vertices[mesh.triangles]
    boxes = TriangleBoxes.of(corners)
    triangles, edges = mesh.triangles[boxes.order], np.flatnonzero(mesh.representative)
    sorted_ = np.ascontiguousarray(corners[boxes.order]), np.ascontiguousarray(triangles)
    ends = mesh.vertices[mesh.tail[edges]], mesh.vertices[mesh.head[edges]]
    edge_of = mesh.tail[edges], mesh.head[edges]
    common = boxes.common_vertices(mesh.triangles)
    passing, passed, tried = _search(*ends, *edge_of, *sorted_, *boxes[1:], common)
    twins = mesh.twin[edges[passing]]
    found = np.zeros(mesh.face_count, dtype=np.bool_)
    found[mesh.face[edges[passing]]] = found[mesh.face[twins[twins >= 0]]] = True
    found[boxes.order[passed]] = True
    return np.flatnonzero(found), int(tried)


@compiled
def _search(start, end, tail, head, corners, triangles, axes, low, high, common):  # type: ignore[no-untyped-def]
    """Which edges pass through triangles, which triangles are passed through, and how many pairs were tried.

    An edge is not tried with triangles that have one of its ends as a corner, nor with boxes all of whose triangles do:
    at a vertex of thousands of triangles all of their boxes meet.
    """
    passing, passed = np.zeros(len(tail), dtype=np.bool_), np.zeros(len(corners), dtype=np.bool_)
    stack, first_leaf, tried = np.empty(64, dtype=np.intp), len(low) // 2, 0
    for e in range(len(tail)):
        i, j, p, q = tail[e], head[e], start[e], end[e]
        stack[0], size = 0, 1
        while size:
            size -= 1
            box = stack[size]
            if _all_at(i, j, common[box]) or _apart(p, q, axes[box], low[box], high[box]):
                continue
            if box < first_leaf:
                stack[size], stack[size + 1] = 2 * box + 1, 2 * box + 2
                size += 2
                continue
            for k in range(LEAF * (box - first_leaf), min(LEAF * (box - first_leaf + 1), len(corners))):
                tried += 1
                if not _all_at(i, j, triangles[k]) and _passes(p, q, corners[k]):
                    passing[e] = passed[k] = True
    return passing, passed, tried


@compiled(inline=True)
def _all_at(i, j, corners):  # type: ignore[no-untyped-def]
    """Whether one of two vertices is among three."""
    at_i = corners[0] == i or corners[1] == i or corners[2] == i
    return at_i or corners[0] == j or corners[1] == j or corners[2] == j


@compiled(inline=True)
def _apart(p, q, axes, low, high):  # type: ignore[no-untyped-def]
    """Whether a segment lies on one side of a box."""
    for k in range(3):
        a = axes[k, 0] * p[0] + axes[k, 1] * p[1] + axes[k, 2] * p[2]
        b = axes[k, 0] * q[0] + axes[k, 1] * q[1] + axes[k, 2] * q[2]
        margin = 1e-12 * (abs(low[k]) + abs(high[k]))
        if max(a, b) < low[k] - margin or min(a, b) > high[k] + margin:
            return True
    return False


@compiled(inline=True)
def _volume(a, b, c, d):  # type: ignore[no-untyped-def]
    u0, u1, u2 = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    v0, v1, v2 = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    w0, w1, w2 = d[0] - a[0], d[1] - a[1], d[2] - a[2]
    return u0 * (v1 * w2 - v2 * w1) + u1 * (v2 * w0 - v0 * w2) + u2 * (v0 * w1 - v1 * w0)


@compiled(inline=True)
def _passes(p, q, y):  # type: ignore[no-untyped-def]
    """Whether the segment from p to q passes through the inside of triangle y."""
    a, b = _volume(y[0], y[1], y[2], p), _volume(y[0], y[1], y[2], q)
    if a * b >= 0:
        return False
    s, t, u = _volume(p, q, y[0], y[1]), _volume(p, q, y[1], y[2]), _volume(p, q, y[2], y[0])
    return (s > 0 and t > 0 and u > 0) or (s < 0 and t < 0 and u < 0)
