"""Flips: a triangulation made Delaunay by flipping edges, every flip logged so that it can be undone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import MapError, Polyhedron
from orbiframe.compiled import compiled, copy, exchange, multiply

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

_FLIPS_PER_SLOT = 40


class Flippable:
    """A closed triangulation as a Delta-complex: three slots a face, each a halfedge with a length x.

    x: (H,), sinh(l/2) in H^2 and l in E^2, on which Ptolemy's relation holds. log: the moves so far, (n, 2): slot and
    0 for a flip of the edge in that slot, face and 1 for a face whose orientation was reversed.
    """

    def __init__(self, mesh: Polyhedron, x: Floats) -> None:
        self.start = mesh
        self.tail, self.twin, self.same = mesh.tail.copy(), mesh.twin.copy(), mesh.same.copy()
        self.x = x.copy()
        self.log = np.zeros((0, 2), dtype=np.intp)

    @property
    def triangles(self) -> Ints:
        """The vertices of every face, (F, 3)."""
        return self.tail.reshape(-1, 3)

    def copy(self) -> Flippable:
        """The same state in arrays of its own."""
        other = object.__new__(Flippable)
        other.start, other.log = self.start, self.log
        other.tail, other.twin = self.tail.copy(), self.twin.copy()
        other.same, other.x = self.same.copy(), self.x.copy()
        return other

    def scaled(self, u: Floats) -> Flippable:
        """x_ij times exp((u_i + u_j) / 2), made Delaunay."""
        other = self.copy()
        head = np.roll(self.triangles, -1, axis=1).ravel()
        other.x = self.x * np.exp((u[self.tail] + u[head]) / 2)
        other.make_delaunay()
        return other

    def make_delaunay(self, *, flat: bool = False) -> None:
        """Flip until every edge is Delaunay by the two angles opposite to it; ends since each flip lowers an energy.

        flat: the triangles are Euclidean and a new edge is the diagonal of their flat quadrilateral, so that the
        polyhedral metric stays; otherwise Ptolemy's relation gives it, so that the discrete conformal class stays.
        Raises MapError where triangles are so thin that rounding would flip for ever.
        """
        limit = _FLIPS_PER_SLOT * len(self.tail)
        moves = _make_delaunay(self.tail, self.twin, self.same, self.x, flat, limit)
        if len(moves) >= limit:
            raise MapError("the triangles are too thin to flip their edges in double precision; use circle packing")
        self.log = np.concatenate([self.log, moves])

    def mesh(self) -> Polyhedron:
        """The present triangulation with the vertices in space (only its connectivity means anything)."""
        return Polyhedron(self.start.vertices, self.start.offsets, self.tail, self.twin, self.same)

    def undone(self, steps: Floats, inverse: Floats) -> Floats:
        """Edge isometries (H, 3, 3) of the present triangulation carried back to the first one.

        steps: for every slot the isometry from the frame at its head to the frame at its tail; inverse: those the
        other way. A flipped edge gets the product of two sides of its triangle: no error but rounding.
        """
        forth, back = steps.copy(), inverse.copy()
        _undo(self.tail.copy(), self.twin.copy(), self.same.copy(), self.log, forth, back)
        return forth


@compiled(may_divide_by_zero=True)
def _following(h: int) -> int:
    return h + 1 if h % 3 < 2 else h - 2


@compiled(may_divide_by_zero=True)
def _cosine_sum(x: Floats, h: int, t: int) -> float:
    """Twice the sum of the two opposite cosines in terms of x; negative where the edge is not Delaunay."""
    e, a, b = x[h], x[_following(h)], x[_following(_following(h))]
    c, d = x[_following(t)], x[_following(_following(t))]
    return float((a * a + b * b - e * e) / (a * b) + (c * c + d * d - e * e) / (c * d))


@compiled(may_divide_by_zero=True)
def _reverse_face(tail: Ints, twin: Ints, same: Bools, x: Floats, face: int) -> None:
    """Run through a face the other way: slot 0 keeps its edge, slots 1 and 2 exchange theirs."""
    s, first, second = 3 * face, 3 * face + 1, 3 * face + 2
    tail[s], tail[first] = tail[first], tail[s]
    x[first], x[second] = x[second], x[first]
    partners = twin[s], twin[second], twin[first]
    flags = same[s], same[second], same[first]
    for k in range(3):
        partner = partners[k]
        if partner // 3 == face:  # glued to itself: both ends turn, the flag stays
            twin[s + k] = s + (3 - partner % 3) % 3
            same[s + k] = flags[k]
        else:
            twin[s + k] = partner
            twin[partner] = s + k
            same[s + k] = not flags[k]
            same[partner] = not flags[k]


@compiled(may_divide_by_zero=True)
def _flat_diagonal(e: float, ik: float, jk: float, im: float, jm: float) -> float:
    """The distance of k and m on both sides of an edge i-j of length e in the plane."""
    along_k, along_m = (ik * ik - jk * jk + e * e) / (2 * e), (im * im - jm * jm + e * e) / (2 * e)
    above, below = max(ik * ik - along_k**2, 0.0), max(im * im - along_m**2, 0.0)
    return float(np.hypot(along_k - along_m, np.sqrt(above) + np.sqrt(below)))


@compiled(may_divide_by_zero=True)
def _flip(tail: Ints, twin: Ints, same: Bools, x: Floats, h: int, flat: bool) -> None:
    """Replace the edge i-j in slot h by k-m: faces (i, j, k) and (j, i, m) become (m, k, i) and (k, m, j)."""
    t = twin[h]
    hn, hp = _following(h), _following(_following(h))
    tn, tp = _following(t), _following(_following(t))
    j, i, k, m = tail[hn], tail[h], tail[hp], tail[tp]
    x_new = (x[hn] * x[tn] + x[hp] * x[tp]) / x[h]
    if flat:
        x_new = _flat_diagonal(x[h], x[hp], x[hn], x[tn], x[tp])
    sources = (hp, tn, tp, hn)
    targets = (hn, hp, tn, tp)
    partners = np.empty(4, dtype=np.intp)
    flags = np.empty(4, dtype=np.bool_)
    sides = np.empty(4)
    for n in range(4):
        partner = twin[sources[n]]
        for other in range(4):
            if twin[sources[n]] == sources[other]:
                partner = targets[other]
        partners[n], flags[n], sides[n] = partner, same[sources[n]], x[sources[n]]
    for n in range(4):
        twin[targets[n]], same[targets[n]], x[targets[n]] = partners[n], flags[n], sides[n]
        twin[partners[n]] = targets[n]
    tail[h], tail[hn], tail[hp] = m, k, i
    tail[t], tail[tn], tail[tp] = k, m, j
    x[h] = x[t] = x_new


@compiled(may_divide_by_zero=True)
def _make_delaunay(tail: Ints, twin: Ints, same: Bools, x: Floats, flat: bool, limit: int) -> Ints:
    size = len(tail)
    queue = [h for h in range(size) if h < twin[h]]
    waiting = np.zeros(size, dtype=np.bool_)
    for h in queue:
        waiting[h] = True
    log = [(0, 0) for _ in range(0)]
    while queue and len(log) < limit:
        h = queue.pop()
        waiting[h] = False
        t = twin[h]
        if h // 3 == t // 3 or not _cosine_sum(x, h, t) < -1e-12:
            continue
        if same[h]:
            face = t // 3
            _reverse_face(tail, twin, same, x, face)
            log.append((face, 1))
            # The edges of the face have other slots now: all of them are looked at again.
            t = twin[h]
        _flip(tail, twin, same, x, h, flat)
        log.append((h, 0))
        for s in (3 * (h // 3), 3 * (t // 3)):
            for k in range(3):
                edge = min(s + k, twin[s + k])
                if not waiting[edge]:
                    waiting[edge] = True
                    queue.append(edge)
    moves = np.empty((len(log), 2), dtype=np.intp)
    for n in range(len(log)):
        moves[n, 0], moves[n, 1] = log[n]
    return moves


@compiled(may_divide_by_zero=True)
def _undo(tail: Ints, twin: Ints, same: Bools, log: Ints, forth: Floats, back: Floats) -> None:
    """Undo the moves, last first; the matrices follow their halfedges, and each new one is a product of two."""
    idle = np.ones(len(tail))
    product, reverse = np.empty((3, 3)), np.empty((3, 3))
    for n in range(len(log) - 1, -1, -1):
        if log[n, 1] == 1:
            face = log[n, 0]
            _reverse_face(tail, twin, same, idle, face)
            for s in range(3 * face, 3 * face + 3):
                exchange(forth[s], back[s])
            exchange(forth[3 * face + 1], forth[3 * face + 2])
            exchange(back[3 * face + 1], back[3 * face + 2])
            continue
        h = log[n, 0]
        t = twin[h]
        hn, hp = _following(h), _following(_following(h))
        tn, tp = _following(t), _following(_following(t))
        multiply(forth[hp], forth[tn], product)
        multiply(back[tn], back[hp], reverse)
        _unflip(tail, twin, same, forth, back, h, t, hn, hp, tn, tp)
        copy(product, forth[h])
        copy(reverse, back[h])
        copy(reverse, forth[t])
        copy(product, back[t])


@compiled(may_divide_by_zero=True)
def _unflip(
    tail: Ints, twin: Ints, same: Bools, forth: Floats, back: Floats, h: int, t: int, hn: int, hp: int, tn: int, tp: int
) -> None:
    """The inverse of `_flip`, with the matrices of the four outer sides."""
    k, i, j, m = tail[hn], tail[hp], tail[tp], tail[h]
    sources = (hn, hp, tn, tp)
    targets = (hp, tn, tp, hn)
    partners = np.empty(4, dtype=np.intp)
    flags = np.empty(4, dtype=np.bool_)
    a, b = np.empty((4, 3, 3)), np.empty((4, 3, 3))
    for n in range(4):
        partner = twin[sources[n]]
        for other in range(4):
            if twin[sources[n]] == sources[other]:
                partner = targets[other]
        partners[n], flags[n] = partner, same[sources[n]]
        copy(forth[sources[n]], a[n])
        copy(back[sources[n]], b[n])
    for n in range(4):
        s = targets[n]
        twin[s], same[s] = partners[n], flags[n]
        twin[partners[n]] = s
        copy(a[n], forth[s])
        copy(b[n], back[s])
    tail[h], tail[hn], tail[hp] = i, j, k
    tail[t], tail[tn], tail[tp] = j, i, m
