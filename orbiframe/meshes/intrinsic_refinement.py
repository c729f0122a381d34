"""Intrinsic refinement: edges halved on a surface that is Delaunay all the time, for meshes with thousands of needles.

Bisection cuts every needle of a fan for itself. Where edges may be flipped meanwhile, lengths being measured along the
surface, a new vertex takes over many needles at once (Sharp, Soliman and Crane 2019; longest edges first, as Rivara
1997): a fan of n needles needs a few vertices for its area, not a few for each of the n.
"""

from __future__ import annotations

import numpy as np

from orbiframe.compiled.decorator import compiled
from orbiframe.meshes.bending import SHARP, bending
from orbiframe.meshes.edge_log import EdgeLog, after, flip, halve

_TIE = 1e-6
_STEP = 1.5  # edges longer than a bound are halved, and the bound falls by so much
_FLIPS_PER_HALFEDGE = 40
_NOTHING = 1e-9


def intrinsic_refinement(log: EdgeLog, longest: float, most: int) -> EdgeLog:
    """More steps for the log of a closed triangle mesh, until it is Delaunay and no edge is longer than `longest`.

    Lengths are those of geodesics on the mesh. Sharp edges are halved but not flipped, and so are edges whose twin runs
    the same way. most: so many edges are halved at most. The new vertices lie on the mesh before; the triangles of the
    mesh after are spanned by chords. Nothing is done where a triangle meets itself along an edge.
    """
    if (log.after.face == log.after.face[log.after.twin]).any():
        return log
    mesh, room = log.after, np.zeros(6 * most, dtype=np.intp)
    tail, twin = np.concatenate([mesh.tail, room]), np.concatenate([mesh.twin, room - 1])
    same, fixed = (
        np.concatenate([flags, room > 0]) for flags in (mesh.same, mesh.same | (bending(mesh).angle > SHARP))
    )
    length = np.concatenate([mesh.edge_lengths, np.zeros(len(room))])
    sides, vertices = len(mesh.tail), len(mesh.vertices)
    limit = _FLIPS_PER_HALFEDGE * len(tail)
    halfedge, crossing, halved = _refine(tail, twin, same, fixed, length, sides, vertices, longest, limit)
    return EdgeLog(
        log.before,
        np.concatenate([log.halfedge, halfedge]),
        np.concatenate([log.crossing, crossing]),
        np.concatenate([log.halved, halved]),
    )


@compiled
def _corner(e, a, b):  # type: ignore[no-untyped-def]
    """The third corner of a triangle over its side from 0 to e, at the distances a and b from its ends (Kahan)."""
    long, short = max(a, b), min(a, b)
    first, second, third = max(e, long), max(min(e, long), short), min(e, short)
    product = (first + (second + third)) * (third - (first - second)) * (third + (first - second))
    area = np.sqrt(max(product * (first + (second - third)), 0.0)) / 4
    return (e + (a - b) * ((a + b) / e)) / 2, 2 * area / e


@compiled
def _unfolded(length, h, t):  # type: ignore[no-untyped-def]
    """An edge of two triangles, laid along an axis of the plane, and the corners opposite to it, each on its side."""
    e = length[h]
    x, y = _corner(e, length[after(after(h))], length[after(h)])
    u, v = _corner(e, length[after(t)], length[after(after(t))])
    return e, x, y, u, v


@compiled
def _crossing(length, h, t):  # type: ignore[no-untyped-def]
    """Whether the edge should be flipped, the shares at which the two cross, and the length of the new one."""
    e, x, y, u, v = _unfolded(length, h, t)
    # Cotangents of the angles at the corners, times the heights.
    first, second = (x * (x - e) + y * y) * v, (u * (u - e) + v * v) * y
    if not first + second < -_TIE * (abs(first) + abs(second)) or y + v == 0:
        return False, 0.0, 0.0, 0.0
    new = y / (y + v)
    old = (x + new * (u - x)) / e
    return 0 < old < 1, old, new, np.hypot(u - x, y + v)


@compiled
def _flip_lengths(length, fixed, h, t, new):  # type: ignore[no-untyped-def]
    hn, tn = after(h), after(t)
    hp, tp = after(hn), after(tn)
    length[h] = length[t] = new
    length[hn], length[hp], length[tn], length[tp] = length[hp], length[tn], length[tp], length[hn]
    fixed[hn], fixed[hp], fixed[tn], fixed[tp] = fixed[hp], fixed[tn], fixed[tp], fixed[hn]


@compiled
def _halve_lengths(length, fixed, h, t, f):  # type: ignore[no-untyped-def]
    e, x, y, u, v = _unfolded(length, h, t)
    g, hn, tn = f + 3, after(h), after(t)
    length[f + 1], fixed[f + 1] = length[hn], fixed[hn]
    length[g + 1], fixed[g + 1] = length[tn], fixed[tn]
    length[h] = length[t] = length[f] = length[g] = e / 2
    fixed[f] = fixed[g] = fixed[h]
    length[hn] = length[f + 2] = np.hypot(x - e / 2, y)
    length[tn] = length[g + 2] = np.hypot(u - e / 2, v)
    fixed[hn] = fixed[f + 2] = fixed[tn] = fixed[g + 2] = False


@compiled
def _may_be_halved(length, twin, h):  # type: ignore[no-untyped-def]
    """Whether an edge has two triangles, and no corner of them in its middle."""
    if h // 3 == twin[h] // 3:
        return False
    e, x, y, u, v = _unfolded(length, h, twin[h])
    return min(np.hypot(x - e / 2, y), np.hypot(u - e / 2, v)) > _NOTHING * e


@compiled
def _first(length, twin, fixed, h, short):  # type: ignore[no-untyped-def]
    """The edge to halve before another one, itself if there is none (Ruppert 1995).

    It is a fixed edge that the new vertex would crowd: which it sees under an obtuse angle.
    """
    t = twin[h]
    e, x, y, u, v = _unfolded(length, h, t)
    to_k, to_m = np.hypot(x - e / 2, y), np.hypot(u - e / 2, v)
    for outer in (after(h), after(after(h)), after(t), after(after(t))):
        seen = e * e / 4 + (to_k * to_k if outer // 3 == h // 3 else to_m * to_m)
        long = fixed[outer] and length[outer] > short and seen < length[outer] * length[outer]
        if long and _may_be_halved(length, twin, outer):
            return outer
    return h


@compiled
def _push(stack, waiting, twin, h):  # type: ignore[no-untyped-def]
    edge = min(h, twin[h])
    if not waiting[edge]:
        waiting[edge] = True
        stack.append(edge)


@compiled
def _refine(tail, twin, same, fixed, length, sides, vertices, longest, limit):  # type: ignore[no-untyped-def]
    """Flip to Delaunay, halve what is too long, the longest first, flip again; the steps."""
    waiting = np.zeros(len(tail), dtype=np.bool_)
    stack = [h for h in range(sides) if h < twin[h]]
    for h in stack:
        waiting[h] = True
    pairs = [(0, 0) for _ in range(0)]
    shares = [(0.0, 0.0, False) for _ in range(0)]
    bound = length.max()
    h, changed = 0, False
    while True:
        while len(stack) and len(pairs) < limit:
            edge = stack.pop()
            waiting[edge] = False
            t = twin[edge]
            k, m = tail[after(after(edge))], tail[after(after(t))]
            if edge // 3 == t // 3 or fixed[edge] or k == m:
                continue
            wanted, old, new, chord = _crossing(length, edge, t)
            if not wanted:
                continue
            flip(tail, twin, same, edge, t)
            _flip_lengths(length, fixed, edge, t, chord)
            pairs.append((edge, t))
            shares.append((old, new, False))
            for outer in (after(edge), after(after(edge)), after(t), after(after(t))):
                _push(stack, waiting, twin, outer)
        if sides == len(tail) or len(pairs) >= limit:
            break
        while h < sides and not (length[h] > bound and _may_be_halved(length, twin, h)):
            h += 1
        if h < sides:
            edge = _first(length, twin, fixed, h, longest / 2)
            t = twin[edge]
            _halve_lengths(length, fixed, edge, t, sides)
            halve(tail, twin, same, edge, t, sides, vertices)
            pairs.append((edge, t))
            shares.append((0.5, 0.0, True))
            for outer in (after(after(edge)), after(after(t)), sides + 1, sides + 4):
                _push(stack, waiting, twin, outer)
            sides, vertices, changed = sides + 6, vertices + 1, True
        elif changed or bound > longest:
            bound = bound if changed else max(bound / _STEP, longest)
            h, changed = 0, False
        else:
            break
    halfedge, crossing = np.empty((len(pairs), 2), dtype=np.intp), np.empty((len(pairs), 2))
    halved = np.empty(len(pairs), dtype=np.bool_)
    for n in range(len(pairs)):
        halfedge[n, 0], halfedge[n, 1] = pairs[n]
        crossing[n, 0], crossing[n, 1], halved[n] = shares[n]
    return halfedge, crossing, halved
