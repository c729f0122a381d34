"""Sites put into a Delaunay triangulation of X/H one by one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.compiled.matrices import copy, multiply
from orbiframe.delaunay.lawson_flips import chord, legalise_star, push, versine
from orbiframe.delaunay.point_walk import LONGEST_CHAIN, Located, by_place, follow
from orbiframe.delaunay.triangle_arrays import TriangleArrays, corner, move, recentre, split
from orbiframe.errors import MapError

Ints = NDArray[np.intp]

# Sites nearer than this, for a surface of area 1, are one.
_SAME = 1e-9


def insert(triangles: TriangleArrays, faces: int, vertices: int, sites: Located, area: float) -> tuple[Ints, int]:
    """Put sites into Delaunay triangles that have `faces` triangles and `vertices` vertices, and room.

    Returns the vertex of every site, a new one or one that was there, (n,), and the number of vertices.
    The sites go in rounds, each twice the one before, chosen by chance with a fixed seed, and in a round along a curve
    (Amenta, Choi, Rote, Incremental constructions con BRIO, 2003). Raises MapError where a site is lost.
    """
    vertex = np.full(len(sites.face), -1)
    triangles.route[:] = np.eye(3)
    near = _SAME**2 * area / 2
    vertices, lost = _insert(triangles, faces, vertices, _rounds(sites), sites.face, sites.x, near, vertex)
    if lost >= 0:
        raise MapError(f"site {lost}, {sites.x[lost]} in its triangle, was lost by rounding; give points of X")
    return vertex, vertices


def _rounds(sites: Located) -> Ints:
    """The order of insertion."""
    count = len(sites.face)
    chance = np.random.default_rng(0).permutation(count)
    level = np.log2((chance + 1) / max(count, 1)).astype(np.intp)
    order = by_place(sites.face, sites.x)
    return order[np.argsort(level[order], kind="stable")]


@compiled
def _insert(triangles, faces, vertices, order, home, x, near, vertex):  # type: ignore[no-untyped-def]
    route, y = np.empty((3, 3)), np.empty(3)
    k, face, seed, last, chain = triangles.curvature, 0, 1, -1, 0
    for i in order:
        if home[i] != last or chain >= LONGEST_CHAIN:
            last, chain = home[i], 0
            face = last
            copy(triangles.route[last], route)
        chain += 1
        y[0], y[1], y[2] = move(k, route, x[i])
        face, seed = follow(triangles, face, y, route, seed)
        if face < 0:
            return vertices, i
        if recentre(triangles, face):
            y[0], y[1], y[2] = move(k, triangles.work[7], y)
            multiply(triangles.work[7], route, triangles.work[4])
            copy(triangles.work[4], route)
        site = (y[0], y[1], y[2])
        for slot in range(3 * face, 3 * face + 3):
            if versine(k, chord(k, corner(triangles, slot), site)) < near:
                vertex[i] = triangles.vertex[slot]
        if vertex[i] >= 0:
            continue
        vertex[i] = vertices
        split(triangles, face, site, vertices, faces, faces + 1)
        top = push(triangles, push(triangles, push(triangles, 0, 3 * face), 3 * faces), 3 * faces + 3)
        faces, vertices = faces + 2, vertices + 1
        legalise_star(triangles, top)
        if not _holds(triangles, face, site):
            chain = LONGEST_CHAIN
    return vertices, -1


@compiled(arrays=False)
def _holds(triangles, face, x):  # type: ignore[no-untyped-def]
    """Whether x is a corner of a triangle to the bit: its frame is then still the same."""
    return (
        corner(triangles, 3 * face) == x or corner(triangles, 3 * face + 1) == x or corner(triangles, 3 * face + 2) == x
    )
