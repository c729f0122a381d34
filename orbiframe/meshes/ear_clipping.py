"""Ear clipping: a polygon in the plane cut into triangles, ears with the shortest diagonals first.

What an ear must not hold is asked of a tree of boxes over the reflex corners, and the ears wait in a heap: about
n log n steps for n corners (n^1.5 where they are thin spikes), where a search of all corners for every ear takes n^2.
"""

from __future__ import annotations

from heapq import heapify, heappop, heappush

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Lengths are alike where their squares agree to about this: rounding must not choose between equal diagonals.
_ALIKE = 2e-9
_ROUNDING = 1e-15


def cut_ears(p: Floats) -> tuple[Ints, int]:
    """Triangles (n - 2, 3) of a counterclockwise polygon (n, 2) of unit size, and the number of boxes looked at.

    Of the ears the one with the shortest diagonal goes first, of equal ones the first in the polygon. Where no ear is
    left, as in a polygon that crosses itself, the corner with the shortest diagonal goes.
    """
    order = np.argsort(_along_a_curve(p), kind="stable")
    return _clip(np.ascontiguousarray(p), order)  # type: ignore[no-any-return]


def _along_a_curve(p: Floats) -> NDArray[np.int64]:
    """Places of points (n, 2) along the Z curve in their box: near points come near to one another."""
    low = p.min(axis=0)
    size = float(np.ptp(p, axis=0).max()) or 1.0
    code = np.zeros(len(p), dtype=np.int64)
    cell = np.minimum((p - low) / size * 2**16, 2**16 - 1).astype(np.int64)
    for bit in range(16):
        for axis in range(2):
            code |= ((cell[:, axis] >> bit) & 1) << (2 * bit + axis)
    return code


@compiled
def _is_convex(p, before, after, k):  # type: ignore[no-untyped-def]
    """Whether a corner is convex by more than the rounding of the points, whose coordinates are at most about 1."""
    a, b, c = p[before[k]], p[k], p[after[k]]
    u, v, x, y = b[0] - a[0], b[1] - a[1], c[0] - b[0], c[1] - b[1]
    return u * y - v * x > _ROUNDING * (abs(u) + abs(v) + abs(x) + abs(y))


@compiled
def _clip(p, order):  # type: ignore[no-untyped-def]
    n = len(p)
    before, after = np.arange(-1, n - 1), np.arange(1, n + 1)
    before[0], after[n - 1] = n - 1, 0
    boxes, leaf = _tree(p, order, before, after)
    triangles = np.empty((n - 2, 3), dtype=np.intp)
    version = np.zeros(n, dtype=np.intp)
    looked = 0
    ears = [(0, 0, 0) for _ in range(0)]
    rest = [(_length(p, before, after, k), k, 0) for k in range(n)]
    for k in range(n):
        free, steps = _is_ear(p, before, after, k, order, boxes)
        looked += steps
        if free:
            ears.append(rest[k])
    heapify(ears)
    heapify(rest)
    for t in range(n - 2):
        ear = _next(ears, version)
        if ear < 0:
            ear = _next(rest, version)
        a, c = before[ear], after[ear]
        triangles[t, 0], triangles[t, 1], triangles[t, 2] = a, ear, c
        after[a], before[c] = c, a
        version[ear] = -1
        _remove(boxes, leaf[ear])
        for k in (a, c):
            version[k] += 1
            if _is_convex(p, before, after, k):
                _remove(boxes, leaf[k])
            entry = (_length(p, before, after, k), k, version[k])
            heappush(rest, entry)
            free, steps = _is_ear(p, before, after, k, order, boxes)
            looked += steps
            if free:
                heappush(ears, entry)
    return triangles, looked


@compiled
def _next(heap, version):  # type: ignore[no-untyped-def]
    """The corner of the first entry that still holds, or -1."""
    while len(heap):
        _, corner, when = heappop(heap)
        if version[corner] == when:
            return corner
    return -1


@compiled
def _length(p, before, after, k):  # type: ignore[no-untyped-def]
    """The diagonal that cuts a corner off, in steps so large that rounding does not tell equal ones apart."""
    a, c = before[k], after[k]
    square = (p[a, 0] - p[c, 0]) ** 2 + (p[a, 1] - p[c, 1]) ** 2
    return np.int64(np.rint(np.log(max(square, 1e-300)) / _ALIKE))


@compiled
def _tree(p, order, before, after):  # type: ignore[no-untyped-def]
    """Boxes (2 m, 4) of the reflex corners in an order: node k holds nodes 2k and 2k + 1; and the leaf of a corner."""
    n, m = len(p), 1
    while m < n:
        m *= 2
    boxes = np.empty((2 * m, 4))
    for node in range(2 * m):
        _empty(boxes, node)
    leaf = np.empty(n, dtype=np.intp)
    for place in range(n):
        k = order[place]
        leaf[k] = m + place
        if not _is_convex(p, before, after, k):
            for axis in range(2):
                boxes[m + place, axis] = boxes[m + place, 2 + axis] = p[k, axis]
    for node in range(m - 1, 0, -1):
        _join(boxes, node)
    return boxes, leaf


@compiled
def _empty(boxes, node):  # type: ignore[no-untyped-def]
    for axis in range(2):
        boxes[node, axis], boxes[node, 2 + axis] = np.inf, -np.inf


@compiled
def _join(boxes, node):  # type: ignore[no-untyped-def]
    one, other = boxes[2 * node], boxes[2 * node + 1]
    for k in range(2):
        boxes[node, k] = min(one[k], other[k])
        boxes[node, 2 + k] = max(one[2 + k], other[2 + k])


@compiled
def _remove(boxes, node):  # type: ignore[no-untyped-def]
    """Take a corner out of the tree, once."""
    if boxes[node, 0] > boxes[node, 2]:
        return
    _empty(boxes, node)
    node //= 2
    while node:
        _join(boxes, node)
        node //= 2


@compiled
def _is_ear(p, before, after, ear, order, boxes):  # type: ignore[no-untyped-def]
    """Whether a corner is convex and no reflex corner lies in its triangle, and how many boxes were looked at."""
    a, c = before[ear], after[ear]
    x, y, z = p[a], p[ear], p[c]
    if not _is_convex(p, before, after, ear):
        return False, 0
    m, looked = len(boxes) // 2, 0
    stack = np.empty(64, dtype=np.intp)
    stack[0], top = 1, 1
    while top:
        top -= 1
        node = stack[top]
        looked += 1
        box = boxes[node]
        if box[0] > box[2] or _apart(box, x, y) or _apart(box, y, z) or _apart(box, z, x) or _beside(box, x, y, z):
            continue
        if node < m:
            stack[top], stack[top + 1] = 2 * node, 2 * node + 1
            top += 2
            continue
        k = order[node - m]
        if k != a and k != ear and k != c:
            return False, looked
    return True, looked


@compiled
def _apart(box, a, b):  # type: ignore[no-untyped-def]
    """Whether a box lies to the right of the line from a to b: its corner that is farthest to the left does."""
    u, v = b[0] - a[0], b[1] - a[1]
    x = box[0] if v > 0 else box[2]
    y = box[3] if u > 0 else box[1]
    return u * (y - a[1]) - v * (x - a[0]) < 0.0


@compiled
def _beside(box, a, b, c):  # type: ignore[no-untyped-def]
    """Whether a box does not meet that of a triangle."""
    for k in range(2):  # noqa: SIM110  (compiled without generators)
        if box[k] > max(a[k], b[k], c[k]) or box[2 + k] < min(a[k], b[k], c[k]):
            return True
    return False
