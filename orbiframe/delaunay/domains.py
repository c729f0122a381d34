"""Domains of splines: a triangulation of X/H for a wanted number of functions."""

from __future__ import annotations

import math

from orbiframe.errors import FitError
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.delaunay.spline_domain import spline_domain
from orbiframe.triangulations.triangulation import Triangulation


def domain_for(
    orbifold: Orbifold,
    triangulation: Triangulation | GeodesicTriangulation,
    size: int,
    unknowns: tuple[int, int, int],
) -> GeodesicTriangulation:
    """The domain for about `size` functions, so many for each vertex, edge and triangle as `unknowns` says.

    A geodesic triangulation is taken as it is. From the map of a mesh a domain is made with V vertices, where V
    follows from E = 3 (V - chi) and F = 2 (V - chi); in S^2 and H^2 with more vertices, hence functions, if need be,
    see `fewest_vertices`. Raises FitError for a triangulation of another orbifold.
    """
    if triangulation.orbifold is not orbifold:
        raise FitError("the triangulation belongs to another orbifold than the functions; pass triangulation.orbifold")
    if isinstance(triangulation, GeodesicTriangulation):
        return triangulation
    at_vertex, on_edge, in_face = unknowns
    per_vertex = at_vertex + 3 * on_edge + 2 * in_face
    fixed = orbifold.euler_characteristic * (3 * on_edge + 2 * in_face)
    return spline_domain(triangulation, max(round((size + fixed) / per_vertex), fewest_vertices(orbifold)))


def fewest_vertices(orbifold: Orbifold) -> int:
    """Of a domain whose triangles are on average as large as those of the icosahedron on S^2, pi / 5; one in E^2.

    Much larger triangles would fill half a sphere, or lose digits and take long to find in H^2, where none has an area
    of pi.
    """
    chi = float(orbifold.euler_characteristic)
    return max(math.ceil(chi + 5 * abs(chi)), 1)
