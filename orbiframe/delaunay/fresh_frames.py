"""Frames of triangles made anew from their corners, so that errors of many steps do not add up."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.orbifolds.atlas import Atlas
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.triangulations.edge_frames import about_centres, edge_gluings
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
    x, place = about_centres(orbifold.geometry, corners, placement)
    patch, place = _attached(orbifold.atlas, patch, place)
    gluing = edge_gluings(orbifold.geometry, x, twin, same)
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
