"""Spline domain: a triangulation of X/H for a wanted number of functions."""

from __future__ import annotations

import math

import numpy as np

from orbiframe.delaunay.crease_domain import crease_triangulation
from orbiframe.delaunay.site_triangulation import delaunay_of_vertices
from orbiframe.delaunay.sites import lloyd
from orbiframe.delaunay.voronoi import region_areas
from orbiframe.errors import FitError
from orbiframe.meshes.edge_paths import edge_graph, farthest_points, outermost_vertex
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.local_girth import site_lengths
from orbiframe.triangulations.triangulation import Triangulation

# How much of the density of sites follows the girth: triangles of one star stay of one size where the map changes fast.
_GRADING = 0.6
# The longest edge on the sphere: the ends of an edge of length pi have no geodesic between them.
_LONGEST = 0.9 * np.pi
# Of a coarse domain on the sphere no edge should be as long as a quarter of a great circle, beyond which the functions
# of odd degree, divided by what is nearest to 1, have poles. So many further steps even it out.
_COARSE, _QUARTER, _FURTHER = 50, 0.95 * np.pi / 2, 12


def spline_domain(
    triangulation: Triangulation, vertices: int, *, smoothing: int = 3, grading: float = _GRADING
) -> GeodesicTriangulation:
    """The Delaunay triangulation of X/H with `vertices` sites, graded over the surface in space.

    The sites are vertices of the mesh at first, farthest points by the lengths of edges in space, times the density
    that the girth of the surface asks for (`site_density`), from the vertex farthest from the centroid on. Then as many
    steps of Lloyd as `smoothing` says make the triangles rounder; with the square of the density of the sites as
    weight, they keep it. The triangles are Delaunay in X and positive, down to one vertex (on the sphere and the
    projective plane down to what its geodesic triangles need, with a few more sites where an edge would be almost half
    of a great circle; few sites on the sphere get further steps while an edge is longer than a quarter of one). Raises
    FitError if the mesh has fewer distinct vertices; MapError if the sphere has too few sites or the map has folds.
    """
    mesh = triangulation.polyhedron
    lengths = site_lengths(triangulation, grading)
    chosen = farthest_points(edge_graph(mesh, lengths), vertices, first=outermost_vertex(mesh)).chosen
    if vertices < 1 or len(chosen) < vertices:
        raise FitError(
            f"{vertices} vertices are wanted for the splines, and the mesh has {len(chosen)} distinct ones; take at "
            "least 1 and at most as many, or refine the mesh first"
        )
    start = GeodesicTriangulation.of_map(triangulation)
    number = np.empty(len(triangulation.polyhedron.vertices), dtype=np.intp)
    number[triangulation.polyhedron.triangles] = start.vertex
    found = delaunay_of_vertices(start, number[chosen]).triangulation
    if found.geometry.curvature > 0 and found.edge_lengths.max() > _LONGEST:
        return spline_domain(triangulation, vertices + 1, smoothing=smoothing, grading=grading)
    return _without_long_edges(lloyd(found, smoothing, region_areas(found) ** -2.0)) if smoothing else found


def _without_long_edges(found: GeodesicTriangulation) -> GeodesicTriangulation:
    """A coarse domain on the sphere made even until no edge is too long."""
    if found.geometry.curvature > 0 and found.vertex_count <= _COARSE:
        for _ in range(_FURTHER):
            if found.edge_lengths.max() <= _QUARTER:
                break
            found = lloyd(found)
    return found


def domain_for(
    orbifold: Orbifold,
    triangulation: Triangulation | GeodesicTriangulation,
    size: int,
    unknowns: tuple[int, int, int],
    *,
    creases: bool = False,
) -> GeodesicTriangulation:
    """The domain for about `size` functions, so many for each vertex, edge and triangle as `unknowns` says.

    A geodesic triangulation is taken as it is. From the map of a mesh a domain is made with V vertices, where V
    follows from E = 3 (V - chi) and F = 2 (V - chi); in S^2 and H^2 with more vertices, hence functions, if need be,
    see `fewest_vertices`. That of a map with creases has the sites of the map. creases: whether the functions keep
    creases. Raises FitError for a triangulation of another orbifold, and for one with creases that are not kept.
    """
    if triangulation.orbifold is not orbifold:
        raise FitError("the triangulation belongs to another orbifold than the functions; pass triangulation.orbifold")
    if triangulation.crease is not None and not creases:
        raise FitError("these functions are smooth everywhere and keep no creases; take basis.name = 'ps2' or another")
    if isinstance(triangulation, GeodesicTriangulation):
        return triangulation
    if triangulation.crease is not None:
        return crease_triangulation(triangulation)
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
