"""Vertices taken out of a Delaunay triangulation of X/H one by one."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.compiled.matrices import copy, multiply, set_identity
from orbiframe.delaunay.lawson_flips import (
    TOLERANCE,
    chord,
    legalise,
    outside,
    push,
    push_around,
    turn,
    versine,
)
from orbiframe.delaunay.triangle_arrays import TriangleArrays, after, before, corner, flip, merge, move
from orbiframe.errors import MapError

Ints = NDArray[np.intp]

# Against the squares of its edges: rounding must not decide whether a flatter triangle is one.
_FLAT = 1e-12


def remove(triangles: TriangleArrays, vertices: ArrayLike) -> None:
    """Take vertices out of Delaunay triangles, in an order chosen by chance with a fixed seed.

    Raises MapError where what is left has no geodesic triangulation: sites in one half of a sphere.
    """
    order = np.random.default_rng(0).permutation(np.asarray(vertices, dtype=np.intp))
    stuck = _remove(triangles, order)
    if stuck >= 0:
        raise MapError(
            f"the sites are too few for geodesic triangles: vertex {stuck} cannot be removed; on the sphere and the "
            "projective plane no half of the sphere may be without a site: give more sites, spread over all of it"
        )


@compiled
def _remove(triangles, order):  # type: ignore[no-untyped-def]
    """Remove vertices; returns -1, or the first that could not be removed."""
    ring = (np.empty(64, dtype=np.intp), np.empty((64, 3)), np.empty(64, dtype=np.bool_))
    for vertex in order:
        top = 0
        while True:
            degree, ring = _link(triangles, vertex, ring)
            if degree == 3:
                break
            e = _soonest(triangles.curvature, corner(triangles, triangles.seat[vertex]), degree, ring, _FLAT)
            if e < 0:
                e = _soonest(triangles.curvature, corner(triangles, triangles.seat[vertex]), degree, ring, 0.0)
            if e < 0:
                return vertex
            flip(triangles, e)
            top = push_around(triangles, top, e)
        f = triangles.seat[vertex] // 3
        merge(triangles, triangles.seat[vertex])
        for e in range(3 * f, 3 * f + 3):
            top = push(triangles, top, e)
        legalise(triangles, top, 1_000_000)
    return -1


@compiled
def _link(triangles, vertex, ring):  # type: ignore[no-untyped-def]
    """Walk counterclockwise round a vertex, in the frame of the triangle at its seat.

    Enters into `ring` the edges at the vertex, as halfedges; where they lead; whether to the vertex itself. Returns
    the number of edges and the ring, a longer one where it has to be. Frames that are mirror images are walked round
    the other way.
    """
    edge, x, loop = ring
    route, moved = np.empty((3, 3)), np.empty((3, 3))
    set_identity(route)
    slot, mirrored, degree = triangles.seat[vertex], False, 0
    while degree == 0 or slot != triangles.seat[vertex]:
        if degree == len(edge):
            edge, x, loop = _longer(edge, x, loop)
        end = before(slot) if mirrored else after(slot)
        edge[degree] = end if mirrored else slot
        x[degree, 0], x[degree, 1], x[degree, 2] = move(triangles.curvature, route, corner(triangles, end))
        loop[degree] = triangles.vertex[end] == vertex
        degree += 1
        way = slot if mirrored else before(slot)
        multiply(route, triangles.gluing[way], moved)
        copy(moved, route)
        starts = mirrored != triangles.same[way]
        slot = after(triangles.twin[way]) if starts else triangles.twin[way]
        mirrored = starts
    return degree, (edge, x, loop)


@compiled
def _longer(edge, x, loop):  # type: ignore[no-untyped-def]
    """The same ring with room for twice as many edges."""
    size = len(edge)
    longer = (np.empty(2 * size, dtype=np.intp), np.empty((2 * size, 3)), np.empty(2 * size, dtype=np.bool_))
    for i in range(size):
        longer[0][i], longer[2][i] = edge[i], loop[i]
        longer[1][i, 0], longer[1][i, 1], longer[1][i, 2] = x[i, 0], x[i, 1], x[i, 2]
    return longer


@compiled(arrays=False)
def _soonest(curvature, v, degree, ring, flat):  # type: ignore[no-untyped-def]
    """The edge at a vertex v that flips first if v, with all its lifts, is raised over the surface of the lifted sites.

    That is the way in which Delaunay triangulations with growing weights lose a vertex, so it never gets stuck before
    v is free, and ends at the Delaunay triangulation of the others (Devillers, On deletion in Delaunay triangulations,
    2002; for loops at v the other lifts rise as well). Only edges in convex quadrilaterals count; at degree 4 also
    those whose flip leaves v on an edge or beyond it, since v goes next. flat: how small against its edges a triangle
    counts as flat. Of edges that flip at one time the first is taken. Returns -1 if there is none.
    """
    edge, x, loop = ring
    best, soonest = -1, np.inf
    free = True
    for i in range(degree):
        free = free and not loop[i]
    for i in range(degree):
        i0, i2 = (i - 1) % degree, (i + 1) % degree
        a, b, c = (x[i0, 0], x[i0, 1], x[i0, 2]), (x[i, 0], x[i, 1], x[i, 2]), (x[i2, 0], x[i2, 1], x[i2, 2])
        ear = turn(curvature, a, b, c)
        if degree == 4 and free:
            i3 = (i + 2) % 4
            rest = turn(curvature, c, (x[i3, 0], x[i3, 1], x[i3, 2]), a)
        else:
            rest = turn(curvature, v, a, c)
        speed = ear
        if loop[i0]:
            speed -= turn(curvature, v, b, c)
        if loop[i]:
            speed += rest
        if loop[i2]:
            speed -= turn(curvature, v, a, b)
        least = flat * (versine(curvature, chord(curvature, a, b)) + versine(curvature, chord(curvature, b, c)))
        if ear <= least or rest <= least or speed <= least:
            continue
        height, size = outside(curvature, v, a, b, c)
        time = height / speed
        if time < soonest - TOLERANCE * size / speed:
            best, soonest = edge[i], time
    return best
