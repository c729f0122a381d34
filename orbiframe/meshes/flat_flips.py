"""Flat flips: edges between coplanar triangles turned until none is opposite to obtuse angles; the surface stays.

A file from CAD cuts plane faces into needles, some without any height. Their angles say nothing of the surface, but a
map is made from angles. So edges inside plane parts are flipped first (Lawson 1977), and the log of the flips tells
where the points and the edges of the triangles before have gone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.meshes.edge_log import EdgeLog, after, flip
from orbiframe.meshes.polyhedron import Polyhedron

_FLAT = 1e-9  # how far the two diagonals of a plane quadrilateral may pass one another, of the box's diagonal
_TIE = 1e-6  # corners on one circle up to this keep the edge that they have: a file rounds its coordinates
_FLIPS_PER_HALFEDGE = 20


def flat_flips(mesh: Polyhedron, inside: NDArray[np.bool_] | None = None) -> EdgeLog:
    """The flips that make the plane parts of a closed triangle mesh Delaunay.

    An edge is flipped if the sum of the two angles opposite to it is more than pi, if its two triangles lie in a plane
    up to 1e-9 of the box's diagonal, and if they make a convex quadrilateral. Edges whose twin runs the same way stay.
    So do those between faces that are marked as inside, (F,), and others.
    """
    tail, twin = mesh.tail.copy(), mesh.twin.copy()
    limit = _FLIPS_PER_HALFEDGE * len(tail)
    flat = _FLAT * mesh.diagonal
    part = np.zeros(mesh.face_count, dtype=np.bool_) if inside is None else inside
    halfedge, crossing = _flip_all(np.ascontiguousarray(mesh.vertices), tail, twin, mesh.same.copy(), part, flat, limit)
    return EdgeLog(mesh, halfedge, crossing)


@compiled
def _cross(a, b):  # type: ignore[no-untyped-def]
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def _minus(p, i, j):  # type: ignore[no-untyped-def]
    return p[i, 0] - p[j, 0], p[i, 1] - p[j, 1], p[i, 2] - p[j, 2]


@compiled
def _length(a):  # type: ignore[no-untyped-def]
    return np.sqrt(_dot(a, a))


@compiled
def _crossing(p, i, j, k, m, flat):  # type: ignore[no-untyped-def]
    """Whether the edge i-j should become k-m, and where they cross: shares of i-j and of k-m."""
    no = False, 0.0, 0.0
    e, d = _minus(p, j, i), _minus(p, m, k)
    ki, kj, mi, mj = _minus(p, i, k), _minus(p, j, k), _minus(p, i, m), _minus(p, j, m)
    above, below = _cross(ki, kj), _cross(mj, mi)
    sine_k, sine_m, cosine_k, cosine_m = _length(above), _length(below), _dot(ki, kj), _dot(mi, mj)
    thin = flat * _length(e)
    if sine_k <= thin and sine_m <= thin:  # four points of one line: the needles become shorter, or stay
        if cosine_k >= 0 or cosine_m >= 0:
            return no
        return _shares(p, i, k, e, d, 0.5, 0.5)
    # cot k + cot m < 0, without a division: a triangle without height has an infinite one.
    first, second = cosine_k * sine_m, cosine_m * sine_k
    if not first + second < -_TIE * (abs(first) + abs(second)):
        return no
    normal = _cross(e, d)
    size = _length(normal)
    if size == 0 or not abs(_dot(normal, ki)) <= flat * size:
        return no
    up = above[0] + below[0], above[1] + below[1], above[2] + below[2]
    # Twice the areas of the new triangles (m, k, i) and (k, m, j), and of the old ones, with the sign of their side.
    near, far = _dot(_cross(ki, d), up), _dot(_cross(d, kj), up)
    top, bottom = _dot(above, up), _dot(below, up)
    if not (near > 0 and far > 0 and min(top, bottom) >= -thin * _length(up)):
        return no
    return _shares(p, i, k, e, d, near / (near + far), max(top, 0.0) / (max(top, 0.0) + max(bottom, 0.0)))


@compiled
def _shares(p, i, k, e, d, old, new):  # type: ignore[no-untyped-def]
    """That the edges cross, and where: between thin triangles their directions tell little, so that the share of the

    longer one is read off where the point of the shorter one lies beside it.
    """
    apart = _minus(p, k, i)
    if _dot(e, e) > _dot(d, d):
        old = (_dot(apart, e) + new * _dot(d, e)) / _dot(e, e)
    else:
        new = (old * _dot(e, d) - _dot(apart, d)) / _dot(d, d)
    return 0 < old < 1, old, min(max(new, 0.0), 1.0)


@compiled
def _flip_all(p, tail, twin, same, part, flat, limit):  # type: ignore[no-untyped-def]
    """Flip until no edge should be flipped; the halfedges of every flip and where its edges cross."""
    stack = [h for h in range(len(tail)) if h < twin[h]]
    waiting = np.zeros(len(tail), dtype=np.bool_)
    for h in stack:
        waiting[h] = True
    pairs = [(0, 0) for _ in range(0)]
    shares = [(0.0, 0.0) for _ in range(0)]
    while len(stack) and len(pairs) < limit:
        h = stack.pop()
        waiting[h] = False
        t = twin[h]
        k, m = tail[after(after(h))], tail[after(after(t))]
        if h // 3 == t // 3 or same[h] or k == m or part[h // 3] != part[t // 3]:
            continue
        wanted, old, new = _crossing(p, tail[h], tail[t], k, m, flat)
        if not wanted:
            continue
        flip(tail, twin, same, h, t)
        pairs.append((h, t))
        shares.append((old, new))
        for outer in (after(h), after(after(h)), after(t), after(after(t))):
            edge = min(outer, twin[outer])
            if not waiting[edge]:
                waiting[edge] = True
                stack.append(edge)
    halfedge, crossing = np.empty((len(pairs), 2), dtype=np.intp), np.empty((len(pairs), 2))
    for n in range(len(pairs)):
        halfedge[n, 0], halfedge[n, 1] = pairs[n]
        crossing[n, 0], crossing[n, 1] = shares[n]
    return halfedge, crossing
