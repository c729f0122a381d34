"""Nearest points: how far points in space are from a triangle mesh, exactly."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.triangle_boxes import LEAF, TriangleBoxes

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


class NearestPoints:
    """Distances of points to a triangle mesh; of the boxes only those are opened that hold something nearer."""

    def __init__(self, mesh: Polyhedron) -> None:
        corners = mesh.vertices[mesh.triangles]
        self._boxes = TriangleBoxes.of(corners)
        self._corners = np.ascontiguousarray(corners[self._boxes.order])

    def distance(self, points: Floats) -> Floats:
        """The distance of each point to the mesh, (n,)."""
        return np.sqrt(self.searched(points)[0])

    def searched(self, points: Floats) -> tuple[Floats, int]:
        """The squares of the distances, (n,), and how many triangles were tried for all points together."""
        points = np.ascontiguousarray(points, dtype=np.float64)
        squares, _, tried = _search(points, self._corners, *self._boxes[1:])
        return np.asarray(squares), int(tried)

    def places(self, points: Floats) -> tuple[Ints, Floats]:
        """A triangle (n,) in which the nearest point of the mesh lies, and its barycentric coordinates there (n, 3)."""
        points = np.ascontiguousarray(points, dtype=np.float64)
        chosen = _search(points, self._corners, *self._boxes[1:])[1]
        return self._boxes.order[chosen], _coordinates(points, self._corners[chosen])


def _coordinates(points: Floats, corners: Floats) -> Floats:
    """The barycentric coordinates of the points of triangles (n, 3, 3) that are nearest to points (n, 3)."""
    count = np.arange(len(points))
    onto_sides = np.zeros((3, len(points), 3))
    for side in range(3):
        start, along = corners[:, side], corners[:, (side + 1) % 3] - corners[:, side]
        length = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
        share = np.clip(np.einsum("ni,ni->n", points - start, along) / length, 0, 1)
        onto_sides[side, :, side], onto_sides[side, :, (side + 1) % 3] = 1 - share, share
    apart = points - np.einsum("snc,nci->sni", onto_sides, corners)
    found = onto_sides[(apart**2).sum(axis=2).argmin(axis=0), count]
    u, v, w = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
    normal = np.cross(u, v)
    square = np.maximum((normal**2).sum(axis=1), np.finfo(float).tiny)
    second = np.einsum("ni,ni->n", np.cross(w, v), normal) / square
    third = np.einsum("ni,ni->n", np.cross(u, w), normal) / square
    over = np.stack([1 - second - third, second, third], axis=1)
    inside = (over >= 0).all(axis=1) & (square > np.finfo(float).tiny)
    found[inside] = over[inside]
    return np.asarray(found)


@compiled
def _search(points, corners, axes, low, high):  # type: ignore[no-untyped-def]
    """The least squared distance of each point to the triangles, of which one, and how many triangles were tried."""
    found, chosen, tried, nearest = np.empty(len(points)), np.empty(len(points), dtype=np.intp), 0, 0
    first_leaf = len(low) // 2
    stack, away = np.empty(64, dtype=np.intp), np.empty(64)
    for n in range(len(points)):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        # Points in a row are near to each other: the triangle of the one before is a good one to begin with.
        least = _square(x, y, z, corners[nearest])
        stack[0], away[0], size = 0, 0.0, 1
        while size:
            size -= 1
            box = stack[size]
            if not away[size] < least:
                continue
            if box >= first_leaf:
                for k in range(LEAF * (box - first_leaf), min(LEAF * (box - first_leaf + 1), len(corners))):
                    tried += 1
                    square = _square(x, y, z, corners[k])
                    if square < least:
                        least, nearest = square, k
                continue
            for child in range(2 * box + 1, 2 * box + 3):
                stack[size], away[size] = child, _to_box(x, y, z, axes[child], low[child], high[child])
                size += 1
            if away[size - 2] < away[size - 1]:  # the nearer one is opened first
                stack[size - 2], stack[size - 1] = stack[size - 1], stack[size - 2]
                away[size - 2], away[size - 1] = away[size - 1], away[size - 2]
        found[n], chosen[n] = least, nearest
    return found, chosen, tried


@compiled(inline=True)
def _to_box(x, y, z, axes, low, high):  # type: ignore[no-untyped-def]
    """The squared distance of a point to a box."""
    total = 0.0
    for k in range(3):
        along = axes[k, 0] * x + axes[k, 1] * y + axes[k, 2] * z
        gap = max(low[k] - along, along - high[k], 0.0)
        total += gap * gap
    return total


@compiled(inline=True)
def _square(x, y, z, corners):  # type: ignore[no-untyped-def]
    """The squared distance of a point to a triangle: to its plane over the inside, else to the nearest side."""
    u0, u1, u2 = corners[1, 0] - corners[0, 0], corners[1, 1] - corners[0, 1], corners[1, 2] - corners[0, 2]
    v0, v1, v2 = corners[2, 0] - corners[0, 0], corners[2, 1] - corners[0, 1], corners[2, 2] - corners[0, 2]
    w0, w1, w2 = x - corners[0, 0], y - corners[0, 1], z - corners[0, 2]
    uu, uv, vv = u0 * u0 + u1 * u1 + u2 * u2, u0 * v0 + u1 * v1 + u2 * v2, v0 * v0 + v1 * v1 + v2 * v2
    wu, wv = w0 * u0 + w1 * u1 + w2 * u2, w0 * v0 + w1 * v1 + w2 * v2
    whole = uu * vv - uv * uv
    s, t = wu * vv - wv * uv, wv * uu - wu * uv
    if whole > 0 and s >= 0 and t >= 0 and s + t <= whole:
        s, t = s / whole, t / whole
        return (w0 - s * u0 - t * v0) ** 2 + (w1 - s * u1 - t * v1) ** 2 + (w2 - s * u2 - t * v2) ** 2
    third = _to_side(w0 - u0, w1 - u1, w2 - u2, v0 - u0, v1 - u1, v2 - u2)
    return min(_to_side(w0, w1, w2, u0, u1, u2), _to_side(w0, w1, w2, v0, v1, v2), third)


@compiled(inline=True)
def _to_side(w0, w1, w2, u0, u1, u2):  # type: ignore[no-untyped-def]
    """The squared distance of w to the segment from the origin to u."""
    length = u0 * u0 + u1 * u1 + u2 * u2
    share = min(max((w0 * u0 + w1 * u1 + w2 * u2) / length, 0.0), 1.0) if length > 0 else 0.0
    return (w0 - share * u0) ** 2 + (w1 - share * u1) ** 2 + (w2 - share * u2) ** 2
