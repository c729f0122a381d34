"""Triangulations of small polygons in the plane, by cutting off ears."""

from __future__ import annotations

import numpy as np

from orbiframe.compiled import compiled

# Ears whose shapes differ by less are alike, and the first of them goes: rounding must not decide.
_SAME_SHAPE = 1e-9


@compiled
def _area(a, b, c):  # type: ignore[no-untyped-def]
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@compiled
def _square(a, b):  # type: ignore[no-untyped-def]
    """The square of the distance of two points."""
    return (b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2


@compiled
def _ear(points, a, b, c, count, corner):  # type: ignore[no-untyped-def]
    """How well shaped the ear (a, b, c) is, in (0, 1]; less than 0 if it turns over or holds another corner."""
    p, q, r = points[a], points[b], points[c]
    area = _area(p, q, r)
    sides = _square(p, q) + _square(q, r) + _square(r, p)
    shape = 2 * np.sqrt(3.0) * area / sides if sides > 0 else 0.0
    for n in range(count):
        k = corner[n]
        if k in (a, b, c):
            continue
        inside = _area(p, q, points[k]) >= 0 and _area(q, r, points[k]) >= 0
        if area > 0 and inside and _area(r, p, points[k]) >= 0:
            return min(shape - 2, -1.0)
    return shape


@compiled
def clip_ears(points):  # type: ignore[no-untyped-def]
    """The triangles (k - 2, 3) of a counterclockwise polygon (k, 2): always the best shaped ear goes first.

    Their oriented boundaries add up to the polygon whatever it looks like; if it crosses itself, some turn over.
    """
    count = len(points)
    corner = np.arange(count)
    triangles = np.empty((max(count - 2, 0), 3), dtype=np.intp)
    for n in range(len(triangles)):
        best, where = -np.inf, 0
        for k in range(count):
            shape = _ear(points, corner[(k - 1) % count], corner[k], corner[(k + 1) % count], count, corner)
            if shape > best + _SAME_SHAPE:
                best, where = shape, k
        triangles[n, 0], triangles[n, 1] = corner[(where - 1) % count], corner[where]
        triangles[n, 2] = corner[(where + 1) % count]
        count -= 1
        for k in range(where, count):
            corner[k] = corner[k + 1]
    return triangles
