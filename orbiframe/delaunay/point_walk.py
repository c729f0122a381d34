"""Point location on X/H: a point walks from triangle to triangle and changes frames by the gluings."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.compiled.matrices import copy, multiply
from orbiframe.delaunay.lawson_flips import turn
from orbiframe.delaunay.triangle_arrays import TriangleArrays, arrays_of, corner, move
from orbiframe.errors import GeometryError
from orbiframe.meshes.edge_paths import curve_order
from orbiframe.orbifolds.atlas import Points
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# After so many points a walk begins anew at its first triangle: rounding in the way of the frames must not add up.
LONGEST_CHAIN = 64


class Located(NamedTuple):
    """The triangle (n,) of each of n points of X/H, and its coordinates in the frame of that triangle, (n, 3)."""

    face: Ints
    x: Floats


def find(triangulation: GeodesicTriangulation, points: Points) -> Located:
    """The triangles in which points of X/H lie; a point on an edge or vertex lies in any of its triangles.

    Raises GeometryError for a point that is not finite or too far from its patch to be followed.
    """
    return find_in(arrays_of(triangulation), triangulation, points)


def find_in(triangles: TriangleArrays, triangulation: GeodesicTriangulation, points: Points) -> Located:
    """The same for triangles that come from a triangulation and may have been flipped since."""
    face, route = _entrances(triangles, triangulation)
    x = np.ascontiguousarray(points.x, dtype=np.float64)
    found = Located(np.empty(len(x), dtype=np.intp), np.empty((len(x), 3)))
    patch = np.asarray(points.patch, dtype=np.intp)
    finite = np.isfinite(x).all(axis=1)
    lost = int(np.argmin(finite)) if not finite.all() else -1
    if lost < 0:
        lost = _locate(triangles, by_place(patch, x), patch, x, face, route, found.face, found.x)
    if lost >= 0:
        raise GeometryError(
            f"point {lost}, {x[lost]} in patch {patch[lost]}, was not found in any triangle; give finite points of X "
            "near the origin of the frame of their patch"
        )
    return found


def by_place(group: Ints, x: Floats) -> Ints:
    """The order by group, and within a group along a space-filling curve."""
    order = curve_order(x)
    return order[np.argsort(group[order], kind="stable")]


def _entrances(triangles: TriangleArrays, triangulation: GeodesicTriangulation) -> tuple[Ints, Floats]:
    """For every patch some triangle, and the isometry from the frame of the patch to the frame of the triangle."""
    atlas, geometry = triangulation.orbifold.atlas, triangulation.geometry
    face = np.full(atlas.patch_count, -1)
    patch, first = np.unique(triangles.patch[: triangulation.face_count], return_index=True)
    face[patch] = first
    route = geometry.inverse(triangles.placement[np.maximum(face, 0)])
    while (face < 0).any():
        steps = np.flatnonzero((face[atlas.tail] < 0) & (face[atlas.head] >= 0) & (atlas.tail >= 0))
        new, chosen = np.unique(atlas.tail[steps], return_index=True)
        step = steps[chosen]
        face[new] = face[atlas.head[step]]
        route[new] = route[atlas.head[step]] @ atlas.isometry[atlas.inverse[step]]
    return face, route


@compiled(arrays=False)
def follow(triangles, face, x, route, seed):  # type: ignore[no-untyped-def]
    """Follow a point x from a triangle to the one that it lies in; x and route change with the frames.

    Crosses any edge that the point lies beyond, but never straight back: on a Delaunay triangulation that ends, on any
    other with probability 1. Returns the triangle (-1: none found) and the state of the random numbers.
    """
    moved = triangles.work[4]
    entered = -1
    for _ in range(100_000):
        seed = (seed * 1103515245 + 12345) % 2147483648
        way = -1
        for i in range(3):
            e = 3 * face + (seed // 65536 + i) % 3
            if e != entered:
                a, b = corner(triangles, e), corner(triangles, e - 2 if e % 3 == 2 else e + 1)
                if turn(triangles.curvature, a, b, (x[0], x[1], x[2])) < 0:
                    way = e
                    break
        if way < 0:
            return face, seed
        entered = triangles.twin[way]
        face = entered // 3
        step = triangles.gluing[entered]
        x[0], x[1], x[2] = move(triangles.curvature, step, x)
        multiply(step, route, moved)
        copy(moved, route)
    return -1, seed


@compiled
def _locate(triangles, order, patch, x, first, first_route, found_face, found_x):  # type: ignore[no-untyped-def]
    """Fill in the triangles and coordinates of points; returns -1, or the first point that was not found."""
    route, y = np.empty((3, 3)), np.empty(3)
    face, seed, last, chain = 0, 1, -1, 0
    for i in order:
        if patch[i] != last or chain >= LONGEST_CHAIN:
            last, chain = patch[i], 0
            face = first[last]
            copy(first_route[last], route)
        chain += 1
        y[0], y[1], y[2] = move(triangles.curvature, route, x[i])
        face, seed = follow(triangles, face, y, route, seed)
        if face < 0:
            return i
        found_face[i] = face
        found_x[i, 0], found_x[i, 1], found_x[i, 2] = y[0], y[1], y[2]
    return -1
