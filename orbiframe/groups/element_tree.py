"""The tree of the elements of a group: every tile but the first is reached from one parent, so none is met twice."""

from __future__ import annotations

import numpy as np

from orbiframe.compiled.decorator import compiled

# Sides that a point is equally far beyond, up to this share of the size of its coordinates, are a tie, which the
# number of the side decides. Whoever is this near to the limit itself cannot be told from a tie.
TIE = 1e-10
_UNSURE = 1e-13
DONE, TIED, ON_RIM, MANY = 0, 1, 2, 3  # how a walk ended


@compiled(inline=True)
def _product(k, a, b, reverses, c, d):  # type: ignore[no-untyped-def]
    if reverses:
        c, d = c.conjugate(), d.conjugate()
    return a * c - k * b * d.conjugate(), a * d + b * c.conjugate()


@compiled(inline=True)
def _parent_side(x0, x1, x2, covectors, size, heights):  # type: ignore[no-untyped-def]
    """The first of the sides that x is farthest beyond; -1 for a point of the domain, -2 where rounding decides."""
    best = -np.inf
    for s in range(len(covectors)):
        heights[s] = covectors[s, 0] * x0 + covectors[s, 1] * x1 + covectors[s, 2] * x2
        best = max(best, heights[s])
    unit = size * (abs(x0) + abs(x1) + abs(x2))
    if best < -TIE * unit:
        return -1
    if best < 2 * TIE * unit:
        return -2
    for s in range(len(covectors)):
        excess = heights[s] - best + TIE * unit
        if abs(excess) < _UNSURE * unit:
            return -2
        if excess > 0:
            return s
    return -2


@compiled(inline=True)
def _is_parent(x0, x1, x2, side, covectors, rivals, rival_count, size):  # type: ignore[no-untyped-def]
    """1 if x is beyond a side and farther than beyond those that cross it, 0 if not; -1 where a tie is in sight."""
    margin = 2 * TIE * size * (abs(x0) + abs(x1) + abs(x2))
    height = covectors[side, 0] * x0 + covectors[side, 1] * x1 + covectors[side, 2] * x2
    clear = 1 if height > margin else -1
    for k in range(rival_count[side]):
        s = rivals[side, k]
        other = covectors[s, 0] * x0 + covectors[s, 1] * x1 + covectors[s, 2] * x2
        if other > height + margin and other > margin:
            return 0
        if other > height - margin:
            clear = -1
    return clear


@compiled
def _rivals(k, covectors, bounding):  # type: ignore[no-untyped-def]
    """For every side the sides with a point of X, or nearly one, beyond both: no other matters for points beyond it.

    Of lines that bound a polygon and do not cross no point lies beyond both; from number `bounding` on they bound none.
    """
    sides = len(covectors)
    rivals, count = np.empty((sides, sides), dtype=np.int64), np.zeros(sides, dtype=np.int64)
    for s in range(sides):
        for t in range(sides):
            u, v = covectors[s], covectors[t]
            c0, c1, c2 = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
            if s != t and (k >= 0 or max(s, t) >= bounding or c0 * c0 > (c1 * c1 + c2 * c2) * (1 - 1e-6)):
                rivals[s, count[s]] = t
                count[s] += 1
    return rivals, count


@compiled(inline=True)
def _put(tree, n, a, b, reverses, parent, step):  # type: ignore[no-untyped-def]
    tree[0][n], tree[1][n], tree[2][n] = a, b, reverses
    tree[3][n], tree[4][n] = parent, step


@compiled
def _largest(covectors):  # type: ignore[no-untyped-def]
    """The size of the largest entry."""
    largest = 0.0
    for s in range(len(covectors)):
        for i in range(3):
            largest = max(largest, abs(covectors[s, i]))
    return largest


@compiled
def _empty(count):  # type: ignore[no-untyped-def]
    return (
        np.empty(count, dtype=np.complex128),
        np.empty(count, dtype=np.complex128),
        np.empty(count, dtype=np.bool_),
        np.empty(count, dtype=np.int32),
        np.empty(count, dtype=np.int16),
    )


@compiled
def _longer(tree, count):  # type: ignore[no-untyped-def]
    """The same elements with room for twice as many."""
    grown = _empty(2 * count)
    for n in range(count):
        _put(grown, n, tree[0][n], tree[1][n], tree[2][n], tree[3][n], tree[4][n])
    return grown


@compiled
def grow(k, generators, mate, covectors, bounding, reach, rim, depth, room, most):  # type: ignore[no-untyped-def]
    """All elements with |b|^2 <= reach and at most `depth` steps from the identity, breadth first.

    k: curvature; generators: a, b, reverses of the elements across the sides; covectors: (m, 3), see
    `DirichletDomain.bisectors`, the first `bounding` of them bound the domain. Where the image of the origin under the
    inverse of g lies beyond side s, g times generator s is nearer to the identity. A product g h is kept if its parent
    is g, so no element comes twice and none is looked up.

    Stops at an element for which rounding would decide: with |b|^2 within `rim` of the reach, relative, or with two
    sides between a tie and no tie; and where there are more than `most` elements.

    Returns the elements a, b, reverses, and for each its parent and the last generator, (room,), -1 for the identity;
    their number; and how the walk ended.
    """
    c, d, turns = generators
    sides, count, end, level = len(mate), 1, 1, 0
    tree, heights = _empty(max(room, 2 * sides + 2)), np.empty(sides)
    size = _largest(covectors) if sides else 1.0
    rivals, rival_count = _rivals(k, covectors, bounding)
    _put(tree, 0, 1.0 + 0.0j, 0.0 + 0.0j, False, -1, -1)
    n = 0
    while n < count:
        if n == end:
            level, end = level + 1, count
        if level == depth:
            break
        if count > most:
            return tree, count, MANY
        if count + sides > len(tree[0]):
            tree = _longer(tree, len(tree[0]))
        back = mate[tree[4][n]] if n else -1
        for s in range(sides):
            if s == back:
                continue
            a, b = _product(k, tree[0][n], tree[1][n], tree[2][n], c[s], d[s])
            square = b.real * b.real + b.imag * b.imag
            if abs(square - reach) < rim * reach:
                return tree, n + 1, ON_RIM
            if square > reach:
                continue
            reverses = tree[2][n] ^ turns[s]
            # The image of the origin under the inverse, which is (conj a, -b), or (a, -conj b) if it reverses.
            x = -2 * a * b.conjugate() if reverses else -2 * a.conjugate() * b
            x0 = a.real * a.real + a.imag * a.imag - k * square
            side = mate[s]
            clear = _is_parent(x0, x.real, x.imag, side, covectors, rivals, rival_count, size)
            if clear == 0:
                continue
            if clear < 0:
                side = _parent_side(x0, x.real, x.imag, covectors, size, heights)
            if side == -2:
                return tree, n + 1, TIED
            if side == mate[s]:
                _put(tree, count, a, b, reverses, n, s)
                count += 1
        n += 1
    return tree, count, DONE
