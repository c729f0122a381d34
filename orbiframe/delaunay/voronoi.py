"""Voronoi regions of the vertices of a Delaunay triangulation of X/H, seen from its triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]


def circumcentres(triangulation: GeodesicTriangulation) -> Floats:
    """The centre of the circle round every triangle, in the frame of the triangle, (F, 3): the Voronoi vertices.

    With u, v the chords from one corner it lies on the line of u x v, for H^2 with the last two entries negated; in
    E^2 it is the common point of two perpendicular bisectors. Raises GeometryError if three corners in H^2 lie on no
    circle, which no Delaunay triangle does.
    """
    x, geometry = triangulation.corners, triangulation.geometry
    u, v = geometry.chord(x[:, 0], x[:, 1]), geometry.chord(x[:, 0], x[:, 2])
    normal = np.cross(u, v)
    if geometry.curvature:
        return geometry.project(normal * [1.0, geometry.curvature, geometry.curvature])
    first, second = (w[:, 1] ** 2 + w[:, 2] ** 2 for w in (u, v))
    ahead = np.stack([v[:, 2] * first - u[:, 2] * second, u[:, 1] * second - v[:, 1] * first], axis=1)
    return geometry.settle(x[:, 0] + np.pad(ahead / (2 * normal[:, :1]), ((0, 0), (1, 0))))


def circumradii(triangulation: GeodesicTriangulation) -> Floats:
    """The radius of the circle round every triangle, (F,)."""
    return triangulation.geometry.distance(triangulation.corners[:, 0], circumcentres(triangulation))


def kites(triangulation: GeodesicTriangulation) -> Floats:
    """What every corner has of the Voronoi region of its vertex, as two triangles, (F, 3, 2, 3, 3).

    [triangle, corner, half, point, coordinate]: the vertex, the middle of the edge after it and the circumcentre; the
    vertex, the circumcentre and the middle of the edge before it. Clockwise, and to be subtracted, where the centre
    lies beyond the edge. They fill the region.
    """
    x = triangulation.corners
    middle = triangulation.geometry.project(x + np.roll(x, -1, axis=1))
    centre = np.broadcast_to(circumcentres(triangulation)[:, None], x.shape)
    first = np.stack([x, middle, centre], axis=2)
    second = np.stack([x, centre, np.roll(middle, 1, axis=1)], axis=2)
    return np.stack([first, second], axis=2)


def region_areas(triangulation: GeodesicTriangulation) -> Floats:
    """The area of the Voronoi region of every vertex of a Delaunay triangulation, (V,); their sum is that of X/H."""
    p = kites(triangulation)
    area = triangulation.geometry.triangle_area(p[..., 0, :], p[..., 1, :], p[..., 2, :]).sum(axis=-1)
    return np.asarray(np.bincount(triangulation.vertex.ravel(), weights=area.ravel()), dtype=np.float64)
