"""Orbit sums: which lifts of which centres reach a point of X/H, how far they are and in which direction.

Distances are versines c: 1 - cos d in S^2, d^2 / 2 in E^2, cosh d - 1 in H^2. The versine to a fixed point is an
analytic function, with Hess c = (1 - K c) g in curvature K, so functions of c need no square root and no arc function.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.functions.lifted_centres import Images, LiftedCentres
from orbiframe.functions.near_points import near_points
from orbiframe.meshes.edge_paths import curve_order
from orbiframe.orbifolds.atlas import Points
from orbiframe.planes.geometry import Geometry
from orbiframe.workers.threads import in_threads

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Result = TypeVar("Result")

_LEAF = 8  # points in a leaf of the search tree
_BLOCK = 1 << 11  # rows of a block: bounds the memory of everything computed per pair, so that it stays in the cache


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of a point and a lift of a centre that reaches it, by points: a sparse matrix without its values.

    rows: (r,), indices of the points; start: (r + 1,), the pairs of point rows[i] are start[i] to start[i + 1] - 1;
    column: (p,), the centre, increasing in each row, equal where several of its lifts reach the point; versine: (p,);
    slope: (p, 2), derivative of the versine along `geometry.frame` at the point, or (0, 2) if not asked for; tests:
    how many versines the search computed to find the pairs.
    """

    rows: Ints
    start: Ints
    column: Ints
    versine: Floats
    slope: Floats
    tests: int


def in_blocks(
    lifted: LiftedCentres, points: Points, task: Callable[[Pairs], Result], *, slopes: bool = False
) -> Iterator[Result]:
    """What a task makes of all pairs of a point and a lift of a centre whose versine is below the centre's support.

    In blocks of rows, in several threads at a time, with the results in the order of the blocks. A support of 2 and
    more reaches every point of S^2. Every block belongs to one patch: the lifts of centres that are seen from there
    meet a tree of balls over the points, whose test costs no root and no arc function. Points beyond the disc of their
    patch are seen from a nearer one, see `near_points`.
    """
    geometry = lifted.orbifold.geometry
    points, turn = near_points(lifted.orbifold, points)

    def done(block: tuple[Images, Ints]) -> Result:
        images, part = block
        pairs = _pairs_of_block(geometry, images, lifted.support[images.column], part, points.x[part], slopes)
        return task(pairs if turn is None or not slopes else _turned(pairs, turn))

    return in_threads(done, _blocks(lifted, points))


def _blocks(lifted: LiftedCentres, points: Points) -> Iterator[tuple[Images, Ints]]:
    """Points of one patch and near each other, by their rows, with the lifts of centres that are seen from there."""
    geometry = lifted.orbifold.geometry
    order = np.argsort(points.patch, kind="stable")
    patches, first = np.unique(points.patch[order], return_index=True)
    members = np.split(order, first[1:])
    radii = np.zeros(lifted.orbifold.atlas.patch_count)
    np.maximum.at(radii, points.patch, geometry.distance(geometry.origin, points.x))
    for unsorted, images in zip(members, lifted.seen_from(patches, radii[patches]), strict=False):
        rows = unsorted[curve_order(points.x[unsorted])]
        for part in np.split(rows, range(_BLOCK, len(rows), _BLOCK)):
            yield images, part


def _turned(pairs: Pairs, turn: Floats) -> Pairs:
    """The same pairs with slopes along the frames of the points as they were given."""
    slope = np.empty_like(pairs.slope)
    _turn(pairs.rows, pairs.start, pairs.slope, turn, slope)
    return replace(pairs, slope=slope)


def _pairs_of_block(geometry: Geometry, images: Images, support: Floats, rows: Ints, x: Floats, slopes: bool) -> Pairs:
    """The pairs of some points x of one patch, (r, 3), in an order in which neighbours are near."""
    curvature = geometry.curvature
    levels = max(int(np.ceil(np.log2(len(rows) / _LEAF))), 0)
    ball, spread = _balls(curvature, x, levels)

    def search(cursor: Ints, found: Ints, versine: Floats, fill: bool) -> int:
        tree = (curvature, x, ball, spread, levels)
        return int(_search(tree, images.x, support, cursor, found, versine, fill))

    count = np.zeros(len(rows), dtype=np.intp)
    tests = search(count, np.zeros(0, dtype=np.intp), np.zeros(0), False)
    start = np.concatenate([[0], np.cumsum(count)])
    image, versine = np.empty(start[-1], dtype=np.intp), np.empty(start[-1])
    search(start[:-1].copy(), image, versine, True)
    slope = np.zeros((0, 2))
    if slopes:
        slope = _slopes(curvature, x, np.ascontiguousarray(geometry.frame(x)), start, image, images.x)
    return Pairs(rows, start, images.column[image], versine, slope, tests)


@compiled(inline=True)
def _versine(curvature, x0, x1, x2, y0, y1, y2):  # type: ignore[no-untyped-def]
    """The versine of two points as a sum of positive terms, so that near points keep all their digits."""
    v1, v2 = y1 - x1, y2 - x2
    if curvature == 0:
        return (v1 * v1 + v2 * v2) / 2
    if curvature > 0:
        v0 = y0 - x0
        return (v0 * v0 + v1 * v1 + v2 * v2) / 2
    dot = x1 * y1 + x2 * y2
    if dot < -1:
        return x0 * y0 - 1 - dot
    cross = x1 * v2 - x2 * v1
    return (v1 * v1 + v2 * v2 + cross * cross) / (1 + x0 * y0 + dot)


@compiled(may_divide_by_zero=True)
def _balls(curvature, x, levels):  # type: ignore[no-untyped-def]
    """A ball about each node of the tree: a point in it, and the largest sqrt(versine / 2) to its points.

    Node k of level l, with index 2^l + k, holds the points k n / 2^l to (k + 1) n / 2^l.
    """
    n = len(x)
    centre, spread = np.zeros((2 << levels, 3)), np.zeros(2 << levels)
    for level in range(levels + 1):
        for k in range(1 << level):
            low, high = (k * n) >> level, ((k + 1) * n) >> level
            if low == high:
                continue
            mean0, mean1, mean2 = 0.0, 0.0, 0.0
            for i in range(low, high):
                mean0, mean1, mean2 = mean0 + x[i, 0], mean1 + x[i, 1], mean2 + x[i, 2]
            share = 1 / (high - low)
            best, middle = np.inf, low
            for i in range(low, high):
                gap0, gap1, gap2 = x[i, 0] - mean0 * share, x[i, 1] - mean1 * share, x[i, 2] - mean2 * share
                gap = gap0 * gap0 + gap1 * gap1 + gap2 * gap2
                if gap < best:
                    best, middle = gap, i
            o0, o1, o2 = x[middle, 0], x[middle, 1], x[middle, 2]
            far = 0.0
            for i in range(low, high):
                far = max(far, _versine(curvature, o0, o1, o2, x[i, 0], x[i, 1], x[i, 2]))
            node = (1 << level) + k
            centre[node, 0], centre[node, 1], centre[node, 2] = o0, o1, o2
            # A little larger, so that rounding never cuts a point off.
            spread[node] = np.sqrt(far / 2) * (1 + 1e-6)
    return centre, spread


@compiled
def _search(tree, images, support, cursor, found, versine, fill):  # type: ignore[no-untyped-def]
    """Count the images that reach each point, or write them and their versines from `cursor` on.

    With s = sqrt(versine / 2) = sin(d/2), d/2 or sinh(d/2), the s of a sum or difference of distances follows from the
    addition theorem: discs of radii a, b at distance d are apart if s(d) > s(a + b), nested if s(d) < s(a - b).
    """
    curvature, x, ball, spread, levels = tree
    n, tests = len(x), 0
    stack = np.empty(2 * levels + 4, dtype=np.intp)
    for j in range(len(images)):
        m0, m1, m2 = images[j]
        sa = np.sqrt(support[j] / 2)
        everywhere = curvature > 0 and sa >= 1
        ca = 0.0 if everywhere else np.sqrt(1 - curvature * sa * sa)
        stack[0], top = 1, 1
        while top:
            top -= 1
            node = stack[top]
            level = 0
            while node >> (level + 1):
                level += 1
            k = node - (1 << level)
            low, high = (k * n) >> level, ((k + 1) * n) >> level
            if low == high:
                continue
            inside = everywhere
            if not everywhere:
                o, sb = ball[node], spread[node]
                tests += 1
                apart = _versine(curvature, m0, m1, m2, o[0], o[1], o[2]) / 2
                if curvature <= 0 or sa * sa + sb * sb < 1:
                    cb = np.sqrt(1 - curvature * sb * sb)
                    together, between = sa * cb + ca * sb, sa * cb - ca * sb
                    if apart > together * together * (1 + 1e-6):
                        continue
                    inside = between > 0 and apart * (1 + 1e-6) < between * between
            if not inside and level < levels:
                stack[top], stack[top + 1] = 2 * node + 1, 2 * node
                top += 2
                continue
            if inside and not fill:
                for i in range(low, high):
                    cursor[i] += 1
                continue
            tests += high - low
            for i in range(low, high):
                c = _versine(curvature, m0, m1, m2, x[i, 0], x[i, 1], x[i, 2])
                if inside or c < support[j]:
                    place = cursor[i]
                    if fill:
                        found[place], versine[place] = j, c
                    cursor[i] = place + 1
    return tests


@compiled
def _slopes(curvature, x, frame, start, image, images):  # type: ignore[no-untyped-def]
    """D_u c = -<u, m - x> for the unit tangents u of the frame at x, since <u, x> = 0; the difference is exact."""
    slope = np.empty((len(image), 2))
    for i in range(len(x)):
        x0, x1, x2 = x[i, 0], x[i, 1], x[i, 2]
        for k in range(start[i], start[i + 1]):
            m0, m1, m2 = images[image[k], 0], images[image[k], 1], images[image[k], 2]
            v0, v1, v2 = m0 - x0, m1 - x1, m2 - x2
            if curvature < 0:
                v0 = (v1 * (m1 + x1) + v2 * (m2 + x2)) / (m0 + x0)
            for a in range(2):
                slope[k, a] = -(curvature * frame[i, 0, a] * v0 + frame[i, 1, a] * v1 + frame[i, 2, a] * v2)
    return slope


@compiled(arrays=False)
def _turn(rows, start, slope, turn, out):  # type: ignore[no-untyped-def]
    """The slopes of each row times the matrix of its point."""
    for i in range(len(rows)):
        t = turn[rows[i]]
        for k in range(start[i], start[i + 1]):
            u, v = slope[k, 0], slope[k, 1]
            out[k, 0], out[k, 1] = u * t[0, 0] + v * t[1, 0], u * t[0, 1] + v * t[1, 1]
