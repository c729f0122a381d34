"""Edges along: the edges of a triangulation of X/H that are given geodesics between its vertices."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.delaunay.forced_edges import with_edge
from orbiframe.delaunay.site_triangulation import SiteTriangulation
from orbiframe.orbifolds.atlas import Points
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.point_location import Locator

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# How far, in barycentric coordinates, the middle of a geodesic may be from an edge.
_ON_EDGE = 1e-7


class Geodesics(NamedTuple):
    """Geodesics between sites: from start to end, (n, 3) each, in the frame of a patch, (n,); ends: (n, 2), the sites.

    Of a triangulation, ends are the numbers of its vertices.
    """

    patch: Ints
    start: Floats
    end: Floats
    ends: Ints

    def between(self, vertex: Ints) -> Geodesics:
        """The same geodesics with the vertices of a triangulation for their sites."""
        return self._replace(ends=vertex[self.ends])


def edges_along(domain: GeodesicTriangulation, geodesics: Geodesics) -> Ints:
    """The halfedge of the domain that is each geodesic, (n,); -1 for none, and where two are one edge."""
    geometry, (patch, start, end, ends) = domain.geometry, geodesics
    location = Locator(domain).locate(Points(patch, geometry.project(start + end)))
    face, share = np.empty(len(ends), dtype=np.intp), np.empty((len(ends), 3))
    face[location.order] = location.face
    inside = np.linalg.solve(np.swapaxes(domain.corners[location.face], 1, 2), location.columns[:, :, :1])[..., 0]
    share[location.order] = inside / inside.sum(axis=1, keepdims=True)
    corner = (np.abs(share).argmin(axis=1) + 1) % 3
    halfedge = 3 * face + corner
    after = halfedge - corner + (corner + 1) % 3
    joined = np.sort(domain.vertex.ravel()[np.stack([halfedge, after], axis=1)], axis=1)
    right = (np.abs(share).min(axis=1) < _ON_EDGE) & (joined == np.sort(ends, axis=1)).all(axis=1)
    edge = domain.edge[halfedge]
    once = np.bincount(edge[right], minlength=domain.edge_count)[edge] == 1
    return np.where(right & once, halfedge, -1)


def with_edges_along(current: SiteTriangulation, geodesics: Geodesics) -> tuple[SiteTriangulation, Ints]:
    """The triangulation with geodesics between its sites as edges, by flips, and their halfedges; -1 where it has none.

    See `with_edge`.
    """
    edges = edges_along(current.triangulation, geodesics.between(current.vertex))
    missing = np.flatnonzero(edges < 0)
    for k in missing:
        patch, start, end = int(geodesics.patch[k]), geodesics.start[k], geodesics.end[k]
        if (again := with_edge(current.triangulation, patch, start, end)) is not None:
            current = SiteTriangulation(again.triangulation, again.vertex[current.vertex])
    return current, edges_along(current.triangulation, geodesics.between(current.vertex)) if len(missing) else edges
