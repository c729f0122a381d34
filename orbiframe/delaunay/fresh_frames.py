"""Frames of triangles made anew from their corners, so that errors of many steps do not add up."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.compiled.matrices import copy, multiply
from orbiframe.delaunay.lawson_flips import chord, versine
from orbiframe.delaunay.triangle_arrays import carry, invert, move
from orbiframe.orbifolds.atlas import Atlas
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# An error of the gluings that calls for better corners, and the farthest that those may be from what they replace.
_GOOD = 1e-12
_SAME_LIFT = 1e-3

# With more triangles none is large.
_FEW = 2000


def centred(
    orbifold: Orbifold, corners: Floats, twin: Ints, same: Bools, patch: Ints, placement: Floats
) -> GeodesicTriangulation:
    """The triangulation with every triangle in a frame at its centre, attached to a patch near it.

    corners, placement: in the frames that the triangles have; the gluings follow from the ends of the edges alone.
    """
    x, place = corners.copy(), placement.copy()
    _centre(orbifold.geometry.curvature, x, place)
    patch, place = _attached(orbifold.atlas, patch, place)
    gluing = edge_gluings(orbifold.geometry.curvature, x, twin, same)
    return GeodesicTriangulation(orbifold, x, twin, same, gluing, patch, place)


def polished(triangulation: GeodesicTriangulation) -> GeodesicTriangulation:
    """Large triangles of H^2 with corners found anew: as lifts of the vertices by products of few transitions.

    Flips between large triangles lose digits, though far too few to tell one lift of a vertex from another. Without
    change where the digits are there.
    """
    t, geometry = triangulation, triangulation.geometry
    if geometry.curvature >= 0 or t.face_count > _FEW or t.gluing_defect < _GOOD:
        return t
    near = geometry.settle(geometry.act(t.placement[:, None], t.corners))
    face, corner = np.divmod(t.vertex_corner, 3)
    site = near[face, corner]
    reach = geometry.distance(geometry.origin, near).max(axis=1)
    copies = t.orbifold.copies(t.patch, reach + geometry.distance(geometry.origin, site).max() + 0.1)
    corners = near.copy()
    for c in range(3):
        vertex = t.vertex[copies.base, c]
        here = np.flatnonzero(copies.patch == t.patch[face][vertex])
        base, lift = copies.base[here], geometry.act(copies.isometry[here], site[vertex[here]])
        apart = geometry.distance(lift, near[base, c])
        order = np.lexsort((apart, base))
        first = order[np.unique(base[order], return_index=True)[1]]
        first = first[apart[first] < _SAME_LIFT]
        corners[base[first], c] = lift[first]
    mirror = np.tile(np.eye(3), (t.face_count, 1, 1))
    mirror[:, 2, 2] = geometry.parity(t.placement)
    return centred(t.orbifold, geometry.settle(corners) @ mirror, t.twin, t.same, t.patch, mirror)


def edge_gluings(curvature: int, corners: Floats, twin: Ints, same: Bools) -> Floats:
    """The isometries from triangle to triangle across every edge, from its ends in both frames, (3 F, 3, 3).

    h = F diag(1, 1, +-1) F'^-1 with the orthonormal frames F, F' of the edge at its start.
    """
    gluing = np.empty((len(twin), 3, 3))
    _glue(curvature, np.ascontiguousarray(corners), twin, same, gluing)
    return gluing


def _attached(atlas: Atlas, patch: Ints, placement: Floats) -> tuple[Ints, Floats]:
    """Frames attached to patches whose origins are near them: from patch to patch, while that brings them nearer."""
    geometry, patch = atlas.geometry, patch.copy()
    leaving = np.argsort(atlas.tail, kind="stable")
    bound = np.searchsorted(atlas.tail[leaving], np.arange(atlas.patch_count + 1))
    distance = geometry.distance(geometry.origin, placement[:, :, 0])
    far = np.flatnonzero(distance > atlas.radius[patch])
    while len(far):
        step = np.full(len(far), -1)
        for p in np.unique(patch[far]):
            here, ways = np.flatnonzero(patch[far] == p), leaving[bound[p] : bound[p + 1]]
            if len(ways):
                origin = geometry.act(atlas.isometry[atlas.inverse[ways]], placement[far[here], None, :, 0])
                reach = geometry.distance(geometry.origin, origin)
                least = reach.min(axis=1)
                step[here] = np.where(least < distance[far[here]] * (1 - 1e-9), ways[reach.argmin(axis=1)], -1)
        far, step = far[step >= 0], step[step >= 0]
        patch[far] = atlas.head[step]
        placement[far] = geometry.nearest_isometry(atlas.isometry[atlas.inverse[step]] @ placement[far])
        distance[far] = geometry.distance(geometry.origin, placement[far, :, 0])
        far = far[distance[far] > atlas.radius[patch[far]]]
    return patch, placement


@compiled(arrays=False)
def _flag(curvature, p, t, out):  # type: ignore[no-untyped-def]
    """out = the isometry from the origin and the first direction to the point p and the direction of t there."""
    k = curvature
    if k > 0:
        along = p[0] * t[0] + p[1] * t[1] + p[2] * t[2]
        a, b, c = t[0] - along * p[0], t[1] - along * p[1], t[2] - along * p[2]
    else:
        a, b, c = -k * (p[1] * t[1] + p[2] * t[2]) / p[0], t[1], t[2]
    length = np.sqrt(k * a * a + b * b + c * c)
    a, b, c = a / length, b / length, c / length
    out[0, 0], out[1, 0], out[2, 0] = p
    out[0, 1], out[1, 1], out[2, 1] = a, b, c
    out[0, 2] = k * (p[1] * c - p[2] * b)
    out[1, 2], out[2, 2] = p[2] * a - p[0] * c, p[0] * b - p[1] * a


@compiled(arrays=False)
def _edge_flag(curvature, p, q, out):  # type: ignore[no-untyped-def]
    """out = the flag at p in the direction to q."""
    d = chord(curvature, p, q)
    bend = curvature * versine(curvature, d)
    _flag(curvature, p, (d[0] + bend * p[0], d[1] + bend * p[1], d[2] + bend * p[2]), out)


@compiled
def _glue(curvature, corners, twin, same, gluing):  # type: ignore[no-untyped-def]
    here, there, back = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for e in range(len(twin)):
        t = twin[e]
        if t < e:
            invert(curvature, gluing[t], gluing[e])
            continue
        p, q = corners[e // 3, e % 3], corners[e // 3, (e + 1) % 3]
        x, y = corners[t // 3, t % 3], corners[t // 3, (t + 1) % 3]
        if not same[e]:
            x, y = y, x
        _edge_flag(curvature, (p[0], p[1], p[2]), (q[0], q[1], q[2]), here)
        _edge_flag(curvature, (x[0], x[1], x[2]), (y[0], y[1], y[2]), there)
        if same[e]:
            for i in range(3):
                here[i, 2] = -here[i, 2]
        invert(curvature, there, back)
        multiply(here, back, gluing[e])


@compiled
def _centre(curvature, corners, placement):  # type: ignore[no-untyped-def]
    there, back, moved = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for f in range(len(corners)):
        x = corners[f]
        a, b, c = x[0, 0] + x[1, 0] + x[2, 0], x[0, 1] + x[1, 1] + x[2, 1], x[0, 2] + x[1, 2] + x[2, 2]
        scale = a if curvature == 0 else np.sqrt(a * a + curvature * (b * b + c * c))
        carry(curvature, (a / scale, b / scale, c / scale), there)
        invert(curvature, there, back)
        for i in range(3):
            x[i, 0], x[i, 1], x[i, 2] = move(curvature, back, x[i])
        multiply(placement[f], there, moved)
        copy(moved, placement[f])
        _straighten(curvature, placement[f], moved)


@compiled(arrays=False)
def _straighten(curvature, g, spare):  # type: ignore[no-untyped-def]
    """Put an isometry that has drifted back to one with nearly the same image of the origin and first direction."""
    p = (g[0, 0], g[1, 0], g[2, 0])
    if curvature > 0:
        length = np.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])
        p = (p[0] / length, p[1] / length, p[2] / length)
    elif curvature < 0:
        p = (np.sqrt(1 + p[1] * p[1] + p[2] * p[2]), p[1], p[2])
    _flag(curvature, p, (g[0, 1], g[1, 1], g[2, 1]), spare)
    sign = 1.0 if spare[1, 2] * g[1, 2] + spare[2, 2] * g[2, 2] + curvature * spare[0, 2] * g[0, 2] > 0 else -1.0
    copy(spare, g)
    for i in range(3):
        g[i, 2] = sign * spare[i, 2]
