"""Delaunay triangulations of X/H with any sites, in the three geometries, for every group (paper, section 3.3)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.delaunay.fresh_frames import centred, polished
from orbiframe.delaunay.insertion import insert
from orbiframe.delaunay.lawson_flips import legalise, push_all
from orbiframe.delaunay.point_walk import find_in
from orbiframe.delaunay.removal import remove
from orbiframe.delaunay.triangle_arrays import TriangleArrays, arrays_of
from orbiframe.errors import MapError
from orbiframe.orbifolds.atlas import Points
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Ints = NDArray[np.intp]

_MOST_FLIPS_EACH = 10_000

# In H^2 triangles with longer edges are refined before sites are put in, so often at most: digits are lost far out.
_LONG = 1.0
_MOST_REFINEMENTS = 4


class SiteTriangulation(NamedTuple):
    """A triangulation of X/H whose vertices are given sites: vertex (n,) is the vertex of every site."""

    triangulation: GeodesicTriangulation
    vertex: Ints


def delaunay(triangulation: GeodesicTriangulation, sites: Points) -> SiteTriangulation:
    """The Delaunay triangulation of X/H with exactly the given sites, from any triangulation of the same X/H.

    The open disc round every triangle, in X, is empty of all lifts of sites. It is invariant under H; where four sites
    lie on one circle, one of the diagonals is taken. One site is enough but on the sphere and the projective plane,
    where no half may be without a site. Raises MapError for no site, for two sites at one place, and where there are
    too few of them on a sphere; GeometryError for points that are not on X/H.
    """
    if not len(sites.patch):
        raise MapError("no sites are given; a triangulation of a closed surface has at least one vertex")
    start = _fine(triangulation)
    triangles = _flipped(start, len(sites.patch))
    located = find_in(triangles, start, sites)
    vertex, count = insert(triangles, start.face_count, start.vertex_count, located, start.orbifold.area)
    _require_distinct(vertex)
    remove(triangles, _others(count, vertex))
    return _result(triangles, triangulation.orbifold, vertex)


def delaunay_of_vertices(triangulation: GeodesicTriangulation, vertices: ArrayLike | None = None) -> SiteTriangulation:
    """The Delaunay triangulation of X/H whose sites are vertices of a triangulation: some of them, or all.

    vertices: (n,), different numbers as in `triangulation.vertex`. Raises MapError as `delaunay` does.
    """
    count = triangulation.vertex_count
    chosen = np.arange(count) if vertices is None else np.asarray(vertices, dtype=np.intp)
    if not len(chosen):
        raise MapError("no vertices are chosen; a triangulation of a closed surface has at least one vertex")
    _require_distinct(chosen)
    triangles = _flipped(triangulation, 0)
    remove(triangles, _others(count, chosen))
    return _result(triangles, triangulation.orbifold, chosen)


def _others(count: int, vertex: Ints) -> Ints:
    """The numbers below `count` that are not among the given ones."""
    absent = np.ones(count, dtype=np.bool_)
    absent[vertex] = False
    return np.flatnonzero(absent)


def _require_distinct(vertex: Ints) -> None:
    order = np.argsort(vertex, kind="stable")
    twice = np.flatnonzero(np.diff(vertex[order]) == 0)
    if len(twice):
        one, other = order[twice[0]], order[twice[0] + 1]
        raise MapError(f"sites {one} and {other} are at one place of X/H; give every site once")


def _fine(triangulation: GeodesicTriangulation) -> GeodesicTriangulation:
    """A triangulation of H^2 with refined triangles, so that none is large."""
    for _ in range(_MOST_REFINEMENTS if triangulation.geometry.curvature < 0 else 0):
        if triangulation.edge_lengths.max() <= _LONG:
            break
        t = triangulation.refined()
        triangulation = centred(t.orbifold, t.corners, t.twin, t.same, t.patch, t.placement)
    return triangulation


def _flipped(triangulation: GeodesicTriangulation, more: int) -> TriangleArrays:
    """TriangleArrays that are Delaunay, with room for `more` sites."""
    triangles = arrays_of(triangulation, more)
    _settle(triangles, triangulation.face_count)
    return triangles


def _settle(triangles: TriangleArrays, count: int) -> None:
    if not legalise(triangles, push_all(triangles, count), _MOST_FLIPS_EACH * count):
        raise MapError(
            f"the edges of {count} triangles were flipped {_MOST_FLIPS_EACH * count} times without an end; the "
            "triangulation to start from is no triangulation of X/H: check that its areas are positive"
        )


def _result(triangles: TriangleArrays, orbifold: Orbifold, sites: Ints) -> SiteTriangulation:
    """The triangles that are left, and the numbers that the vertices of sites have among them."""
    _settle(triangles, len(triangles.corners))
    alive = np.flatnonzero(triangles.twin[::3] >= 0)
    number = np.cumsum(triangles.twin[::3] >= 0) - 1
    halfedge = (3 * alive[:, None] + np.arange(3)).ravel()
    twin = triangles.twin[halfedge]
    twin = 3 * number[twin // 3] + twin % 3
    same, patch, placement = triangles.same[halfedge], triangles.patch[alive], triangles.placement[alive]
    triangulation = polished(centred(orbifold, triangles.corners[alive], twin, same, patch, placement))
    return SiteTriangulation(triangulation, _by_first_corner(triangles.vertex[halfedge], len(triangles.seat))[sites])


def _by_first_corner(label: Ints, most: int) -> Ints:
    """The number of every label (< most) in the order of their first corners, (most,); 0 for those that are absent."""
    first = np.full(most, len(label))
    first[label[::-1]] = np.arange(len(label) - 1, -1, -1)
    is_first = np.zeros(len(label) + 1, dtype=np.intp)
    is_first[first] = 1
    return np.asarray((np.cumsum(is_first) - 1)[first] * (first < len(label)))
