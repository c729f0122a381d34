"""The domain of splines: a triangulation of X/H of any density, chosen apart from the mesh that made the map."""

from __future__ import annotations

import numpy as np

from orbiframe.delaunay.site_triangulation import delaunay_of_vertices
from orbiframe.errors import FitError
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.delaunay.sites import lloyd
from orbiframe.meshes.edge_paths import edge_graph, farthest_points
from orbiframe.triangulations.triangulation import Triangulation
from orbiframe.delaunay.voronoi import cell_areas

# The longest edge on the sphere: the ends of an edge of length pi have no geodesic between them.
_LONGEST = 0.9 * np.pi


def spline_domain(triangulation: Triangulation, vertices: int, *, smoothing: int = 3) -> GeodesicTriangulation:
    """The Delaunay triangulation of X/H with `vertices` sites, spread evenly over the surface in space.

    The sites are vertices of the mesh at first, farthest points by the lengths of edges in space from the vertex
    farthest from the centroid on. Then as many steps of Lloyd as `smoothing` says make the triangles rounder; with the
    square of the density of the sites as weight, they keep it. The triangles are Delaunay in X and positive, down to
    one vertex (on the sphere and the projective plane down to what its geodesic triangles need, with a few more sites
    where an edge would be almost half of a great circle). Raises FitError if the mesh has fewer distinct vertices;
    MapError if the sphere has too few sites or the map has folds.
    """
    x = triangulation.polyhedron.vertices
    first = int(np.argmax(np.linalg.norm(x - x.mean(axis=0), axis=1)))
    chosen = farthest_points(edge_graph(triangulation.polyhedron), vertices, first=first).chosen
    if vertices < 1 or len(chosen) < vertices:
        raise FitError(
            f"{vertices} vertices are wanted for the splines, and the mesh has {len(chosen)} distinct ones; take at "
            "least 1 and at most as many, or refine the mesh first"
        )
    start = GeodesicTriangulation.of_map(triangulation)
    number = np.empty(len(x), dtype=np.intp)
    number[triangulation.polyhedron.triangles] = start.vertex
    found = delaunay_of_vertices(start, number[chosen]).triangulation
    if found.geometry.curvature > 0 and found.edge_lengths.max() > _LONGEST:
        return spline_domain(triangulation, vertices + 1, smoothing=smoothing)
    return lloyd(found, smoothing, cell_areas(found) ** -2.0) if smoothing else found
