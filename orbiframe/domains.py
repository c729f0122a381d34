"""Domains of splines: a triangulation of X/H for a wanted number of functions."""

from __future__ import annotations

from orbiframe.errors import FitError
from orbiframe.geodesic_triangulation import GeodesicTriangulation
from orbiframe.orbifold import Orbifold
from orbiframe.spline_domain import spline_domain
from orbiframe.triangulation import Triangulation


def domain_for(
    orbifold: Orbifold,
    triangulation: Triangulation | GeodesicTriangulation,
    size: int,
    unknowns: tuple[int, int, int],
) -> GeodesicTriangulation:
    """The domain for about `size` functions, so many for each vertex, edge and triangle as `unknowns` says.

    A geodesic triangulation is taken as it is. From the map of a mesh a domain is made with V vertices, where V
    follows from E = 3 (V - chi) and F = 2 (V - chi). Raises FitError for a triangulation of another orbifold.
    """
    if triangulation.orbifold is not orbifold:
        raise FitError("the triangulation belongs to another orbifold than the functions; pass triangulation.orbifold")
    if isinstance(triangulation, GeodesicTriangulation):
        return triangulation
    at_vertex, on_edge, in_face = unknowns
    per_vertex = at_vertex + 3 * on_edge + 2 * in_face
    fixed = orbifold.euler_characteristic * (3 * on_edge + 2 * in_face)
    return spline_domain(triangulation, max(round((size + fixed) / per_vertex), 1))
