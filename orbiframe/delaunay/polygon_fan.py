"""The fundamental polygon of a group cut into triangles: a triangulation of X/H where no mesh is given."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import GeometryError
from orbiframe.groups.group import Group
from orbiframe.groups.polygon_group import PolygonGroup
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.triangulations.edge_frames import edge_gluings
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def polygon_triangulation(group: Group) -> GeodesicTriangulation:
    """The fundamental polygon of a group in triangles: a polygon as a fan from the origin, the sphere as an octahedron.

    Raises GeometryError for a group whose fundamental polygon is neither.
    """
    word = group.word
    orbifold = Orbifold(group.atlas(), word.euler_characteristic, word.orientable, group.area)
    if isinstance(group, PolygonGroup):
        return _fan(orbifold, group)
    if group.geometry.curvature > 0 and np.isclose(group.area, 2 * np.pi * word.euler_characteristic):
        return _octahedron(orbifold)
    raise GeometryError(f"the group of '{word}' has no fundamental polygon; use a PolygonGroup or a mesh")


def _fan(orbifold: Orbifold, group: PolygonGroup) -> GeodesicTriangulation:
    """Triangle k has side k of the polygon as its edge 0, along the first axis of its frame, and the origin opposite.

    The frame stands on the middle of the side. So all coordinates come from lengths and from the place of the middle,
    and the gluing of side k is a turn or a reflection: no product of large matrices is taken.
    """
    geometry, polygon, word = group.geometry, group.polygon, group.word
    k = np.arange(len(word))
    mate = np.array(word.mate)
    parallel = np.array([word.reverses(side) for side in range(len(word))])
    half = (polygon.side_lengths + polygon.side_lengths[mate]) / 4
    flags = polygon.side_flags
    corners = np.stack(
        [geometry.from_polar(half, np.pi), geometry.from_polar(half, 0.0), geometry.inverse(flags)[..., 0]], axis=1
    )
    twin = np.stack([3 * mate, 3 * np.roll(k, -1) + 2, 3 * np.roll(k, 1) + 1], axis=1).ravel()
    same = np.stack([parallel, np.zeros_like(parallel), np.zeros_like(parallel)], axis=1).ravel()
    gluing = edge_gluings(geometry, corners, twin, same)
    gluing[::3] = np.where(parallel[:, None, None], geometry.reflection(0.0), geometry.rotation(np.pi))
    return GeodesicTriangulation(orbifold, corners, twin, same, gluing, np.zeros_like(k), flags)


def _octahedron(orbifold: Orbifold) -> GeodesicTriangulation:
    """The octants of the sphere, or of one half of it with antipodal edges glued."""
    signs = np.array([(a, b, c) for a in (1.0, -1.0) for b in (1.0, -1.0) for c in (1.0, -1.0)])
    if not orbifold.orientable:
        signs = signs[:4]
    corners = signs[:, :, None] * np.eye(3)
    clockwise = signs.prod(axis=1) < 0
    corners[clockwise] = corners[clockwise][:, [0, 2, 1]]
    ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2, 3)
    twin, same = _matching(ends, orbifold.orientable)
    centre = orbifold.geometry.carry(orbifold.geometry.project(corners.sum(axis=1)))
    x = orbifold.geometry.act(np.swapaxes(centre, -1, -2)[:, None], corners)
    gluing = edge_gluings(orbifold.geometry, x, twin, same)
    return GeodesicTriangulation(orbifold, x, twin, same, gluing, np.zeros(len(x), dtype=np.intp), centre)


def _matching(ends: Floats, orientable: bool) -> tuple[Ints, NDArray[np.bool_]]:
    """The twin of every halfedge, given by its ends, and whether it runs the same way; up to sign if not orientable."""
    twin, same = np.full(len(ends), -1), np.zeros(len(ends), dtype=np.bool_)
    for e, edge in enumerate(ends):
        for sign in (1.0,) if orientable else (1.0, -1.0):
            for way in (False, True):
                match = (ends == sign * (edge if way else edge[::-1])).all(axis=(1, 2))
                match[e] = False
                if match.any():
                    twin[e], same[e] = np.flatnonzero(match)[0], way
    return twin, same
