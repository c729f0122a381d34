"""Even sites: points of X/H that are spread over a surface evenly in space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import OrbifoldSurface, Points
from orbiframe.delaunay import delaunay, lloyd, vertex_points
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe_remeshing.surface_mesh import SurfaceMesh, element, jets_at

Floats = NDArray[np.float64]

_STEPS = 6


def surface_area(surface: OrbifoldSurface) -> float:
    """The area of a surface in space, from a fine mesh on it."""
    return float(_map_areas(surface).sum()) * surface.scale**2


def even_mesh(surface: OrbifoldSurface, count: int, seed: int = 0) -> SurfaceMesh:
    """The Delaunay triangulation of X/H with `count` sites that lie about evenly in space.

    Sites begin at random, one in every equal share of the area. In Lloyd's steps they come to lie as the fourth root of
    a weight; that is the square of the area element, so that their distances in X go like the reciprocal of its root,
    and those in space are equal where the map is conformal. Raises MapError where a sphere has too few sites.
    """
    sites = scattered(surface, count, seed)
    current = delaunay(GeodesicTriangulation.of_map(surface.triangulation), sites).triangulation
    for _ in range(_STEPS):
        current = lloyd(current, 1, element(jets_at(surface, vertex_points(current))) ** 2)
    return SurfaceMesh.at(surface, vertex_points(current), current.vertex)


def scattered(surface: OrbifoldSurface, count: int, seed: int = 0) -> Points:
    """Random points of X/H, one in every share of 1 / count of the area in space, taken along the triangles."""
    area, rng = _map_areas(surface), np.random.default_rng(seed)
    upto = np.cumsum(area)
    wanted = (np.arange(count) + rng.random(count)) / count * upto[-1]
    face = np.minimum(np.searchsorted(upto, wanted), len(area) - 1)
    return surface.triangulation.locate(face, rng.dirichlet(np.ones(3), count))


def _map_areas(surface: OrbifoldSurface) -> Floats:
    """The area in space of every triangle of the map, its corners on the surface, before the surface is scaled."""
    flat = surface.triangulation
    places = surface.basis.values(Points(flat.patch, flat.points), surface.coefficients)
    a, b, c = np.moveaxis(places[flat.polyhedron.triangles], 1, 0)
    return np.asarray(np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2)
