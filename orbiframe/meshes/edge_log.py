"""Edge log: flips and halvings of the edges of a triangle mesh, one after the other, and where its points have gone."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class EdgeLog:
    """A triangle mesh, and the steps that led from it to another one on the same surface.

    before: the mesh at the start; halfedge: (n, 2), the two halfedges of the edge of every step, as they were then;
    crossing: (n, 2), where the new edge of a flip crosses the old one, as shares of the old one from the tail of the
    first halfedge and of the new one from the corner opposite to it; halved: (n,), the steps that halve an edge instead
    of flipping it, none if not given. The crossing of such a step is (1/2, 0).

    The edge i-j lies between the triangles (i, j, k) and (j, i, m). A flip makes them (m, k, i) and (k, m, j). Halving
    makes them (i, v, k) and (j, v, m) and adds (v, j, k) and (v, i, m), with the new vertex v. An edge whose two
    triangles are (i, j, k) and (i, j, m) may be halved too, which makes (i, v, k), (i, v, m), (v, j, k) and (v, j, m).
    """

    before: Polyhedron
    halfedge: Ints
    crossing: Floats
    halved: Bools = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))

    def __post_init__(self) -> None:
        if not len(self.halved):
            object.__setattr__(self, "halved", np.zeros(len(self.halfedge), dtype=np.bool_))

    @property
    def after(self) -> Polyhedron:
        """The mesh at the end: its first vertices are those before, new ones lie on the surface of the mesh before."""
        return self._replayed[0]

    @property
    def is_sound(self) -> bool:
        """Whether the halfedges of every step were twins of two triangles then, and those of flips ran oppositely."""
        return self._replayed[1]

    @property
    def _new_vertices(self) -> int:
        return int(self.halved.sum())

    @cached_property
    def _replayed(self) -> tuple[Polyhedron, bool]:
        old, new = len(self.before.tail), 6 * self._new_vertices
        tail = np.concatenate([self.before.tail, np.zeros(new, dtype=np.intp)])
        twin = np.concatenate([self.before.twin, np.full(new, -1, dtype=np.intp)])
        same = np.concatenate([self.before.same, np.zeros(new, dtype=np.bool_)])
        count = len(self.before.vertices)
        if not _replay(tail, twin, same, self.halfedge, self.halved, old, count):
            return self.before, False
        offsets = 3 * np.arange(len(tail) // 3 + 1)
        return Polyhedron(self._vertices(), offsets, tail, twin, same), True

    def _vertices(self) -> Floats:
        """The vertices before, and the new ones where they lie on the mesh before."""
        old = self.before.vertices
        if not self._new_vertices:
            return old
        none = np.empty(0, dtype=np.intp)
        face, barycentric = self._led_back(none, np.empty((0, 3)), self._new_vertices)
        return np.concatenate([old, np.einsum("nc,nck->nk", barycentric, old[self.before.triangles[face]])])

    def locate(self, face: Ints, barycentric: Floats) -> tuple[Ints, Floats]:
        """Points (n,) of triangles before, with barycentric coordinates (n, 3), in the triangles after."""
        place, weights = np.arange(self.before.face_count)[face], np.array(barycentric, dtype=np.float64)
        _follow(place, weights, self.halfedge, self.crossing, self.halved, self.before.face_count)
        return place, weights

    def led_back(self, face: Ints, barycentric: Floats) -> tuple[Ints, Floats]:
        """Points (n,) of triangles after, with barycentric coordinates (n, 3), in the triangles before."""
        return self._led_back(face, barycentric, 0)

    def _led_back(self, face: Ints, barycentric: Floats, new: int) -> tuple[Ints, Floats]:
        """The same, and then the vertices that halving has made, if `new` is their number."""
        place = np.concatenate([np.asarray(face, dtype=np.intp), np.full(new, -1, dtype=np.intp)])
        weights = np.concatenate([np.array(barycentric, dtype=np.float64), np.zeros((new, 3))])
        faces = self.before.face_count + 2 * self._new_vertices
        _lead_back(place, weights, self.halfedge, self.crossing, self.halved, faces, new)
        return place, weights

    def carried_back(self, steps: Floats) -> Floats:
        """Matrices (H, k, k) along the halfedges before from those along the halfedges after; both are products."""
        carried = np.array(steps, dtype=np.float64)
        _take_back(carried, self.halfedge, self.halved, len(steps))
        return carried[: len(self.before.tail)]


@compiled(inline=True)
def after(h):  # type: ignore[no-untyped-def]
    """The next halfedge of a triangle."""
    return h + 1 if h % 3 < 2 else h - 2


@compiled
def flip(tail, twin, same, h, t):  # type: ignore[no-untyped-def]
    """Turn the edge of the halfedges h, t of two triangles; see `EdgeLog`."""
    hn, tn = after(h), after(t)
    hp, tp = after(hn), after(tn)
    i, j, k, m = tail[h], tail[t], tail[hp], tail[tp]
    _move(twin, same, (hp, tn, tp, hn), (hn, hp, tn, tp))
    tail[h], tail[hn], tail[hp] = m, k, i
    tail[t], tail[tn], tail[tp] = k, m, j


@compiled
def _move(twin, same, sources, targets):  # type: ignore[no-untyped-def]
    """Four halfedges get other numbers, and so do their twins."""
    partners, flags = np.empty(4, dtype=np.intp), np.empty(4, dtype=np.bool_)
    for n in range(4):
        partners[n], flags[n] = twin[sources[n]], same[sources[n]]
        for other in range(4):
            if twin[sources[n]] == sources[other]:
                partners[n] = targets[other]
    for n in range(4):
        twin[targets[n]], same[targets[n]] = partners[n], flags[n]
        twin[partners[n]] = targets[n]


@compiled
def halve(tail, twin, same, h, t, sides, v):  # type: ignore[no-untyped-def]
    """Put a vertex v on the edge of the halfedges h, t of two triangles; two more begin at `sides`; see `EdgeLog`."""
    hn, tn = after(h), after(t)
    hp, tp = after(hn), after(tn)
    f, g = sides, sides + 3
    j, i, k, m = tail[hn], tail[tn], tail[hp], tail[tp]
    _move(twin, same, (hn, tn, hp, tp), (f + 1, g + 1, hp, tp))
    tail[hn] = tail[tn] = v
    tail[f], tail[f + 1], tail[f + 2] = v, j, k
    tail[g], tail[g + 1], tail[g + 2] = v, i, m
    alike = same[h]
    first, second = (t, g) if alike else (g, t)
    for one, other in ((hn, f + 2), (tn, g + 2), (h, first), (f, second)):
        twin[one], twin[other] = other, one
        same[one] = same[other] = alike and one in (h, f)


@compiled
def _replay(tail, twin, same, halfedge, halved, sides, vertices):  # type: ignore[no-untyped-def]
    """Do all steps again; False, and no further, where two halfedges are no twins."""
    for n in range(len(halfedge)):
        h, t = halfedge[n]
        if not (0 <= h < sides and 0 <= t < sides) or twin[h] != t or h // 3 == t // 3 or (same[h] and not halved[n]):
            return False
        if halved[n]:
            halve(tail, twin, same, h, t, sides, vertices)
            sides, vertices = sides + 6, vertices + 1
        else:
            flip(tail, twin, same, h, t)
    return True


@compiled
def _put(place, weights, first, following, point, h, at_tail, at_head, opposite):  # type: ignore[no-untyped-def]
    """Put a point into the triangle of a halfedge, with weights at its tail, at its head and opposite to it."""
    weights[point, h % 3], weights[point, after(h) % 3], weights[point, after(after(h)) % 3] = (
        at_tail,
        at_head,
        max(opposite, 0.0),
    )
    place[point] = h // 3
    following[point], first[h // 3] = first[h // 3], point


@compiled
def _follow(place, weights, halfedge, crossing, halved, faces):  # type: ignore[no-untyped-def]
    """Points follow the steps: those of the two triangles of a step are spread anew over those that it makes.

    With (1 - s) i + s j = (1 - t) k + t m a point of (i, j, k) is one of (m, k, i) or of (k, m, j): a multiple of that
    relation takes away j or i, whichever leaves no weight negative.
    """
    first = np.full(faces + 2 * halved.sum(), -1, dtype=np.intp)
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
                later = following[point]
                i, j = weights[point, here % 3], weights[point, after(here) % 3]
                k = weights[point, after(after(here)) % 3]
                nearer = i * along >= j * (1 - along)
                amount = j / along if nearer else i / (1 - along)
                opposite, own = amount * across, k + amount * (1 - across)
                if halved[n] and nearer:
                    _put(place, weights, first, following, point, here, i - j, 2 * j, k)
                elif halved[n]:
                    _put(place, weights, first, following, point, 3 * (faces + side), 2 * i, j - i, k)
                elif nearer:
                    _put(place, weights, first, following, point, here, opposite, own, i - amount * (1 - along))
                else:
                    _put(place, weights, first, following, point, there, own, opposite, j - amount * along)
                point = later
        if halved[n]:
            faces += 2


@compiled
def _lead_back(place, weights, halfedge, crossing, halved, faces, births):  # type: ignore[no-untyped-def]
    """Points take the steps back, last first; the last `births` of them are the vertices that halving makes."""
    born = len(place) - 1
    first = np.full(faces, -1, dtype=np.intp)
    following = np.full(len(place), -1, dtype=np.intp)
    for point in range(len(place) - births):
        following[point], first[place[point]] = first[place[point]], point
    for n in range(len(halfedge) - 1, -1, -1):
        h, t = halfedge[n]
        if halved[n]:
            faces -= 2
        waiting = first[h // 3], first[t // 3]
        first[h // 3] = first[t // 3] = -1
        for side in range(2):
            here, there = halfedge[n, side], halfedge[n, 1 - side]
            # Seen from the other triangle k and m change places, and so do i and j: the shares run back.
            s, r = crossing[n, 0], crossing[n, 1]
            if side == 1:
                s, r = 1 - s, 1 - r
            point = waiting[side]
            while point >= 0:
                later = following[point]
                m, k = weights[point, here % 3], weights[point, after(here) % 3]
                i = weights[point, after(after(here)) % 3]
                if halved[n]:  # The triangle (m, k, i) is (i, v, k) then.
                    _put(place, weights, first, following, point, here, m + k / 2, k / 2, i)
                elif m * (1 - r) <= k * r:
                    amount = m / r if m > 0 else 0.0
                    i, j, rest = i + amount * (1 - s), amount * s, k - amount * (1 - r)
                    _put(place, weights, first, following, point, here, i, j, rest)
                else:
                    amount = k / (1 - r) if k > 0 else 0.0
                    i, j, rest = i + amount * (1 - s), amount * s, m - amount * r
                    _put(place, weights, first, following, point, there, j, i, rest)
                point = later
        if halved[n]:
            for side in range(2):
                point, here = first[faces + side], halfedge[n, side]
                first[faces + side] = -1
                while point >= 0:
                    later = following[point]
                    v, j, k = weights[point, 0], weights[point, 1], weights[point, 2]
                    _put(place, weights, first, following, point, here, v / 2, j + v / 2, k)
                    point = later
            if births:
                _put(place, weights, first, following, born, h, 0.5, 0.5, 0.0)
                born -= 1


@compiled
def _take_back(steps, halfedge, halved, sides):  # type: ignore[no-untyped-def]
    """Take the steps back, last first: the old edge gets the product along the edges that came in its place."""
    size = steps.shape[1]
    forth, back = np.empty((size, size)), np.empty((size, size))
    for n in range(len(halfedge) - 1, -1, -1):
        h, t = halfedge[n]
        hn, tn = after(h), after(t)
        hp, tp = after(hn), after(tn)
        if halved[n]:
            sides -= 6
        # After a flip along two sides of the quadrilateral, after halving along the two halves.
        there, on, home, off = (h, sides, t, sides + 3) if halved[n] else (hp, tn, tp, hn)
        for a in range(size):
            for b in range(size):
                forth[a, b] = back[a, b] = 0.0
                for c in range(size):
                    forth[a, b] += steps[there, a, c] * steps[on, c, b]
                    back[a, b] += steps[home, a, c] * steps[off, c, b]
        for a in range(size):
            for b in range(size):
                steps[h, a, b], steps[t, a, b] = forth[a, b], back[a, b]
                if halved[n]:
                    steps[hn, a, b], steps[tn, a, b] = steps[sides + 1, a, b], steps[sides + 4, a, b]
                else:
                    first, second, third, last = steps[hn, a, b], steps[hp, a, b], steps[tn, a, b], steps[tp, a, b]
                    steps[hp, a, b], steps[tn, a, b], steps[tp, a, b], steps[hn, a, b] = first, second, third, last
