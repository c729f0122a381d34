"""Even sites: points of X/H that are spread over a surface evenly in space."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import FitError, OrbifoldSurface, Points
from orbiframe.delaunay import Asked, crease_triangulation, creased, delaunay, lloyd, vertex_points
from orbiframe.surfaces import map_areas, scattered_points
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe_remeshing.surface_mesh import SurfaceMesh, element, jets_at

Floats = NDArray[np.float64]

_STEPS = 6
# Sites on a surface with creases are vertices of its refined mesh, of which at most one in so many.
_FINE = 4


def surface_area(surface: OrbifoldSurface) -> float:
    """The area of a surface in space, from a fine mesh on it."""
    return float(map_areas(surface)[surface.triangulation.own_faces].sum()) * surface.scale**2


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


def creased_mesh(surface: OrbifoldSurface, count: int) -> SurfaceMesh:
    """A triangulation of X/H with about `count` sites that lie about evenly in space, and the creases as edges.

    Sites are vertices of the refined mesh, which is that fine. Raises FitError where there are too few of these, and
    MapError where the creases find no place.
    """
    flat = surface.triangulation
    most = len(flat.points) // _FINE
    if count > most:
        raise FitError(
            f"{count} vertices on a surface with creases are more than {most}, a quarter of those of its refined mesh; "
            "take fewer or longer edges, or more functions (--size), with which the mesh is refined further"
        )
    plain = replace(flat, crease=None, seam=None, sites=None, density=None)
    asked = Asked(count, (1, 0, 0), grading=0.0, more=(0, 0))
    domain = crease_triangulation(creased(plain, flat.sharp, asked))
    made = SurfaceMesh.at(surface, vertex_points(domain), domain.vertex)
    here = np.flatnonzero(domain.creased & domain.reference)
    ends = domain.vertex.ravel()[np.stack([here, here - here % 3 + (here + 1) % 3], axis=1)]
    return replace(made, creases=ends)


def scattered(surface: OrbifoldSurface, count: int, seed: int = 0) -> Points:
    """Random points of X/H, one in every share of 1 / count of the area in space, taken along the triangles."""
    return scattered_points(surface, map_areas(surface), count, seed)
