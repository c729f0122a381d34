"""Flat flips: edges between coplanar triangles turned until none is opposite to obtuse angles; the surface stays.

A file from CAD cuts plane faces into needles, some without any height. Their angles say nothing of the surface, but a
map is made from angles. So edges inside plane parts are flipped first (Lawson 1977), and the log of the flips tells
where the points and the edges of the triangles before have gone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

_FLAT = 1e-9  # how far the two diagonals of a plane quadrilateral may pass one another, of the box's diagonal
_TIE = 1e-6  # corners on one circle up to this keep the edge that they have: a file rounds its coordinates
_FLIPS_PER_HALFEDGE = 20


@dataclass(frozen=True, eq=False)
class FlatFlips:
    """A triangle mesh, and the flips of edges that led from it to another on the same vertices and the same surface.

    before: the mesh at the start; halfedge: (n, 2), the two halfedges of every edge when it was flipped; crossing:
    (n, 2), where the new edge crosses the old one, as shares of the old one from the tail of the first halfedge and of
    the new one from the corner opposite to it.

    A flip of the edge i-j between triangles (i, j, k) and (j, i, m) makes them (m, k, i) and (k, m, j).
    """

    before: Polyhedron
    halfedge: Ints
    crossing: Floats

    @property
    def after(self) -> Polyhedron:
        """The mesh at the end."""
        return self._replayed[0]

    @property
    def is_sound(self) -> bool:
        """Whether the two halfedges of every flip were twins that run in opposite directions when it was made."""
        return self._replayed[1]

    @cached_property
    def _replayed(self) -> tuple[Polyhedron, bool]:
        tail, twin, same = self.before.tail.copy(), self.before.twin.copy(), self.before.same.copy()
        sound = bool(_replay(tail, twin, same, self.halfedge))
        return Polyhedron(self.before.vertices, self.before.offsets, tail, twin, same), sound

    def locate(self, face: Ints, barycentric: Floats) -> tuple[Ints, Floats]:
        """Points (n,) of triangles before, with barycentric coordinates (n, 3), in the triangles after."""
        place, weights = np.arange(self.before.face_count)[face], np.array(barycentric, dtype=np.float64)
        _follow(place, weights, self.halfedge, self.crossing, self.before.face_count)
        return place, weights

    def carried_back(self, steps: Floats) -> Floats:
        """Matrices (H, k, k) along the halfedges before from those along the halfedges after; both are products."""
        carried = np.array(steps, dtype=np.float64)
        _take_back(carried, self.halfedge)
        return carried


def flat_flips(mesh: Polyhedron) -> FlatFlips:
    """The flips that make the plane parts of a closed triangle mesh Delaunay.

    An edge is flipped if the sum of the two angles opposite to it is more than pi, if its two triangles lie in a plane
    up to 1e-9 of the box's diagonal, and if they make a convex quadrilateral. Edges whose twin runs the same way stay.
    """
    tail, twin = mesh.tail.copy(), mesh.twin.copy()
    limit = _FLIPS_PER_HALFEDGE * len(tail)
    flat = _FLAT * mesh.diagonal
    halfedge, crossing = _flip_all(np.ascontiguousarray(mesh.vertices), tail, twin, mesh.same.copy(), flat, limit)
    return FlatFlips(mesh, halfedge, crossing)


@compiled(inline=True)
def _next(h):  # type: ignore[no-untyped-def]
    return h + 1 if h % 3 < 2 else h - 2


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
def _flip(tail, twin, same, h, t):  # type: ignore[no-untyped-def]
    """Turn the edge of the halfedges h, t of two triangles; see `FlatFlips`."""
    hn, tn = _next(h), _next(t)
    hp, tp = _next(hn), _next(tn)
    i, j, k, m = tail[h], tail[t], tail[hp], tail[tp]
    sources, targets = (hp, tn, tp, hn), (hn, hp, tn, tp)
    partners, flags = np.empty(4, dtype=np.intp), np.empty(4, dtype=np.bool_)
    for n in range(4):
        partners[n], flags[n] = twin[sources[n]], same[sources[n]]
        for other in range(4):
            if twin[sources[n]] == sources[other]:
                partners[n] = targets[other]
    for n in range(4):
        twin[targets[n]], same[targets[n]] = partners[n], flags[n]
        twin[partners[n]] = targets[n]
    tail[h], tail[hn], tail[hp] = m, k, i
    tail[t], tail[tn], tail[tp] = k, m, j


@compiled
def _flip_all(p, tail, twin, same, flat, limit):  # type: ignore[no-untyped-def]
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
        k, m = tail[_next(_next(h))], tail[_next(_next(t))]
        if h // 3 == t // 3 or same[h] or k == m:
            continue
        wanted, old, new = _crossing(p, tail[h], tail[t], k, m, flat)
        if not wanted:
            continue
        _flip(tail, twin, same, h, t)
        pairs.append((h, t))
        shares.append((old, new))
        for outer in (_next(h), _next(_next(h)), _next(t), _next(_next(t))):
            edge = min(outer, twin[outer])
            if not waiting[edge]:
                waiting[edge] = True
                stack.append(edge)
    halfedge, crossing = np.empty((len(pairs), 2), dtype=np.intp), np.empty((len(pairs), 2))
    for n in range(len(pairs)):
        halfedge[n, 0], halfedge[n, 1] = pairs[n]
        crossing[n, 0], crossing[n, 1] = shares[n]
    return halfedge, crossing


@compiled
def _replay(tail, twin, same, halfedge):  # type: ignore[no-untyped-def]
    """Flip again; False, and no further, where two halfedges are no twins."""
    for n in range(len(halfedge)):
        h, t = halfedge[n]
        if twin[h] != t or same[h] or h // 3 == t // 3:
            return False
        _flip(tail, twin, same, h, t)
    return True


@compiled
def _follow(place, weights, halfedge, crossing, faces):  # type: ignore[no-untyped-def]
    """Points follow the flips: those of the two triangles of a flip are spread anew over the two that it makes.

    With (1 - s) i + s j = (1 - t) k + t m a point of (i, j, k) is one of (m, k, i) or of (k, m, j): a multiple of that
    relation takes away j or i, whichever leaves no weight negative.
    """
    first = np.full(faces, -1, dtype=np.intp)
    following = np.full(len(place), -1, dtype=np.intp)
    for point in range(len(place)):
        following[point], first[place[point]] = first[place[point]], point
    for n in range(len(halfedge)):
        s, t = crossing[n]
        waiting = first[halfedge[n, 0] // 3], first[halfedge[n, 1] // 3]
        first[halfedge[n, 0] // 3] = first[halfedge[n, 1] // 3] = -1
        for side in range(2):
            here, there = halfedge[n, side], halfedge[n, 1 - side]
            # Seen from the other triangle the tail is j, the corner opposite to the edge m, and the shares run back.
            along, across = (s, t) if side == 0 else (1 - s, 1 - t)
            point = waiting[side]
            while point >= 0:
                after = following[point]
                i, j = weights[point, here % 3], weights[point, _next(here) % 3]
                k = weights[point, _next(_next(here)) % 3]
                nearer = i * along >= j * (1 - along)
                amount = j / along if nearer else i / (1 - along)
                rest = i - amount * (1 - along) if nearer else j - amount * along
                # (m, k, i) has the slots of `here`, (k, m, j) those of `there`.
                target = here if nearer else there
                opposite, own = amount * across, k + amount * (1 - across)
                new = (opposite, own) if nearer else (own, opposite)
                weights[point, target % 3] = new[0]
                weights[point, _next(target) % 3] = new[1]
                weights[point, _next(_next(target)) % 3] = max(rest, 0.0)
                place[point] = target // 3
                following[point], first[target // 3] = first[target // 3], point
                point = after


@compiled
def _take_back(steps, halfedge):  # type: ignore[no-untyped-def]
    """Take the flips back, last first: the old edge gets the product along two sides of its quadrilateral."""
    size = steps.shape[1]
    forth, back = np.empty((size, size)), np.empty((size, size))
    for n in range(len(halfedge) - 1, -1, -1):
        h, t = halfedge[n]
        hn, tn = _next(h), _next(t)
        hp, tp = _next(hn), _next(tn)
        for a in range(size):
            for b in range(size):
                forth[a, b] = back[a, b] = 0.0
                for c in range(size):
                    forth[a, b] += steps[hp, a, c] * steps[tn, c, b]
                    back[a, b] += steps[tp, a, c] * steps[hn, c, b]
        for a in range(size):
            for b in range(size):
                steps[h, a, b], steps[t, a, b] = forth[a, b], back[a, b]
                first, second, third, last = steps[hn, a, b], steps[hp, a, b], steps[tn, a, b], steps[tp, a, b]
                steps[hp, a, b], steps[tn, a, b], steps[tp, a, b], steps[hn, a, b] = first, second, third, last
