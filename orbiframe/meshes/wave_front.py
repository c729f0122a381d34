"""Wave fronts: distances along a triangle mesh, from triangle to triangle as if each were unfolded into the plane."""

from __future__ import annotations

import heapq

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# A front that comes earlier by less than this share is the same.
_EARLIER = 1 - 1e-12
# Beyond blunt corners a front may come before the one that was there; so many times a vertex is taken up again. Then it
# only takes what comes in order, so that the search ends on triangles of any shape.
_AGAIN = 64


def front_distances(mesh: Polyhedron, start: Ints, distance: Floats) -> Floats:
    """When a wave reaches the vertices, (V,), that has reached the vertices `start` (k,) at the times `distance` (k,).

    It crosses a triangle as if it came in straight lines from one point of its plane, that which has the known
    distances from two corners; where no such line goes through their side, along the other sides. Exact in the plane;
    on smooth surfaces the error falls with the size of the triangles. Vertices that no face joins
    to the start have inf. mesh: of triangles.

    Source: M. Novotni and R. Klein, Computing geodesic distances on triangular meshes, WSCG 2002.
    """
    corners = np.ascontiguousarray(mesh.triangles)
    count = len(mesh.vertices)
    order = np.argsort(corners.ravel(), kind="stable")
    first = np.concatenate([[0], np.cumsum(np.bincount(corners.ravel(), minlength=count))]).astype(np.intp)
    ends = mesh.vertices[corners]
    sides = np.linalg.norm(np.roll(ends, -1, axis=1) - ends, axis=2)
    found = np.full(count, np.inf)
    np.minimum.at(found, start, distance)
    _spread(corners, np.ascontiguousarray(sides), first, order, np.asarray(start, dtype=np.intp), found)
    return found


def through_sides(first: Floats, second: Floats, base: Floats, here: Floats, there: Floats) -> Floats:
    """`through_side` for n sides, (n,) each."""
    found = np.empty(len(first))
    _all_sides(*(np.ascontiguousarray(part) for part in (first, second, base, here, there)), found)
    return found


@compiled
def _all_sides(first, second, base, here, there, found):  # type: ignore[no-untyped-def]
    for k in range(len(found)):
        found[k] = through_side(first[k], second[k], base[k], here[k], there[k])


@compiled
def _spread(corners, sides, first, order, start, found):  # type: ignore[no-untyped-def]
    """Vertices in the order in which the wave comes; one that it reaches earlier than it did is taken up again."""
    waiting = [(found[v], v) for v in start]
    left = np.full(len(found), _AGAIN)
    heapq.heapify(waiting)
    while len(waiting):
        time, v = heapq.heappop(waiting)
        if time > found[v]:
            continue
        for k in range(first[v], first[v + 1]):
            face, corner = order[k] // 3, order[k] % 3
            for step in range(1, 3):
                own, other = (corner + step) % 3, (corner + 3 - step) % 3
                target, third = corners[face, own], corners[face, other]
                # Side k of a face runs from corner k to corner k + 1.
                if step == 1:
                    here, there, base = sides[face, corner], sides[face, own], sides[face, other]
                else:
                    here, there, base = sides[face, own], sides[face, other], sides[face, corner]
                reached = through_side(time, found[third], base, here, there)
                if reached < _EARLIER * found[target] and (left[target] > 0 or reached >= time):
                    found[target] = reached
                    left[target] -= 1
                    heapq.heappush(waiting, (reached, target))


@compiled
def through_side(first, second, base, here, there):  # type: ignore[no-untyped-def]
    """The distance of a point of the plane beyond a side, whose ends have the distances first and second.

    base: the length of the side; here, there: the lengths from its ends to the point. Along one of these if the line
    does not cross the side.
    """
    along = min(first + here, second + there)
    if not (second < np.inf and base > 0):
        return along
    x = (base**2 + first**2 - second**2) / (2 * base)
    far = (base**2 + here**2 - there**2) / (2 * base)
    # On the line of the side, up to rounding, squares are 0.
    y, z = np.sqrt(max(first**2 - x**2, 0.0)), np.sqrt(max(here**2 - far**2, 0.0))
    if y + z <= 0:
        return along
    crossing = x + (far - x) * y / (y + z)
    if crossing < 0 or crossing > base:
        return along
    return np.sqrt((far - x) ** 2 + (y + z) ** 2)
