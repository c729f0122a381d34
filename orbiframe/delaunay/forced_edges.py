"""Forced edges: a geodesic between two vertices made an edge of a triangulation of X/H, by flips of what it crosses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.compiled.matrices import set_identity
from orbiframe.delaunay.fresh_frames import centred, polished
from orbiframe.delaunay.lawson_flips import turn
from orbiframe.delaunay.site_triangulation import SiteTriangulation
from orbiframe.delaunay.triangle_arrays import adopt, after, arrays_of, before, corner, flip, move, recentre
from orbiframe.orbifolds.atlas import Points
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.point_location import Locator

Floats = NDArray[np.float64]

# So far along a geodesic it lies in the first triangle that it runs through.
_BEGINNING = 1e-4
# Corners that agree to this, per the length of the geodesic, are its ends.
_SAME = 1e-6
_MOST_FLIPS = 200
# No triangle is made that is smaller, per the square of that length: the geodesic runs through a vertex there.
_LEAST = 1e-9


def with_edge(triangulation: GeodesicTriangulation, patch: int, start: Floats, end: Floats) -> SiteTriangulation | None:
    """The triangulation with an edge along the geodesic between two vertices, at start and end in a patch, (3,) each.

    Edges that it crosses are flipped where their quadrilaterals are convex, until none is left (Sloan, 1993). The sites
    are the vertices as they were. None where that does not end, as where the geodesic meets a vertex.
    """
    geometry = triangulation.geometry
    x = geometry.project((1 - _BEGINNING) * start + _BEGINNING * end)
    location = Locator(triangulation).locate(Points(np.array([patch]), x[None]), frames=True)
    across = location.columns[0] @ geometry.inverse(geometry.carry(x))
    p, q = geometry.settle(geometry.act(across, start)), geometry.settle(geometry.act(across, end))
    length = float(geometry.distance(p, q))
    own = geometry.distance(triangulation.corners[location.face[0]], p)
    if not own.min() < _SAME * length:
        return None
    triangles = arrays_of(triangulation)
    slot = 3 * int(location.face[0]) + int(own.argmin())
    try:
        if not _force(triangles, slot, tuple(q), _SAME * length, _LEAST * length**2):
            return None
    except ZeroDivisionError:  # a triangle that is carried so far round the sphere that nothing is left of it
        return None
    arrays = triangles.corners, triangles.twin, triangles.same, triangles.patch, triangles.placement
    found = polished(centred(triangulation.orbifold, *arrays))
    if not found.areas.min() > 0:
        return None
    number = np.empty(triangulation.vertex_count, dtype=np.intp)
    number[triangles.vertex] = found.vertex.ravel()
    return SiteTriangulation(found, number)


@compiled(arrays=False)
def _near(a, b, tolerance):  # type: ignore[no-untyped-def]
    return abs(a[1] - b[1]) + abs(a[2] - b[2]) + abs(a[0] - b[0]) < tolerance


@compiled(arrays=False)
def _force(triangles, slot, q, tolerance, least):  # type: ignore[no-untyped-def]
    """Flip until the geodesic from the corner `slot` to q, in the frame of its triangle, is an edge; whether it is."""
    k = triangles.curvature
    for _ in range(_MOST_FLIPS):
        if recentre(triangles, slot // 3):
            q = move(k, triangles.work[7], q)
        p = corner(triangles, slot)
        if _near(corner(triangles, after(slot)), q, tolerance) or _near(corner(triangles, before(slot)), q, tolerance):
            return True
        e = _best_crossed(triangles, slot, p, q, tolerance, least)
        if e < 0:
            return False
        first = e // 3 == slot // 3
        flip(triangles, e)
        if first:
            # The triangles are (p, d, b) in the slot of the first, and (d, p, a) in that of the other.
            f = 3 * (e // 3)
            d = corner(triangles, f + 1)
            slot = f if turn(k, p, d, q) > 0 else triangles.twin[f] + 1
    return False


@compiled(arrays=False)
def _best_crossed(triangles, slot, p, q, tolerance, least):  # type: ignore[no-untyped-def]
    """An edge that the geodesic crosses in a convex quadrilateral, one that crosses no more if flipped if there is one.

    -1 for none. The triangles on the way come into the frame of the first one.
    """
    k, e, found = triangles.curvature, after(slot), -1
    for _ in range(_MOST_FLIPS):
        if triangles.twin[e] // 3 == e // 3:
            return found
        t = adopt(triangles, e)
        # The same frame to the bit, so that triangles that are met again are not moved again.
        set_identity(triangles.gluing[e])
        set_identity(triangles.gluing[t])
        a, b, c, d = (
            corner(triangles, e),
            corner(triangles, t),
            corner(triangles, before(e)),
            corner(triangles, before(t)),
        )
        end = _near(d, q, tolerance)
        side = 0.0 if end else turn(k, p, q, d)
        if turn(k, c, a, d) > least and turn(k, c, d, b) > least:
            other = turn(k, p, q, c) if not _near(c, p, tolerance) else 0.0
            if side * other >= 0:
                return e
            if found < 0:
                found = e
        if end:
            return found
        # The geodesic leaves through the edge whose ends lie on different sides of it; e runs from right to left.
        e = after(t) if side > 0 else before(t)
    return found
