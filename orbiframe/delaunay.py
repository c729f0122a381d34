"""Delaunay triangulations of X/H with any sites, in the three geometries, for every group (paper, section 3.3)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.atlas import Atlas, Points
from orbiframe.cells import Cells, cells_of
from orbiframe.errors import MapError
from orbiframe.flips import legalise, push_all
from orbiframe.geodesic_triangulation import GeodesicTriangulation
from orbiframe.geometry import Geometry
from orbiframe.insertion import insert
from orbiframe.orbifold import Orbifold
from orbiframe.removal import remove
from orbiframe.walking import locate_in

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

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
    cells = _flipped(start, len(sites.patch))
    located = locate_in(cells, start, sites)
    vertex, count = insert(cells, start.face_count, start.vertex_count, located, start.orbifold.area)
    _require_distinct(vertex)
    remove(cells, np.setdiff1d(np.arange(count), vertex))
    return _result(cells, triangulation.orbifold, vertex)


def delaunay_of_vertices(triangulation: GeodesicTriangulation, vertices: ArrayLike | None = None) -> SiteTriangulation:
    """The Delaunay triangulation of X/H whose sites are vertices of a triangulation: some of them, or all.

    vertices: (n,), different numbers as in `triangulation.vertex`. Raises MapError as `delaunay` does.
    """
    everything = np.arange(triangulation.vertex_count)
    chosen = everything if vertices is None else np.asarray(vertices, dtype=np.intp)
    if not len(chosen):
        raise MapError("no vertices are chosen; a triangulation of a closed surface has at least one vertex")
    _require_distinct(chosen)
    cells = _flipped(triangulation, 0)
    remove(cells, np.setdiff1d(everything, chosen))
    return _result(cells, triangulation.orbifold, chosen)


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
        triangulation = _centred(t.orbifold, t.corners, t.twin, t.same, t.patch, t.placement)
    return triangulation


def _flipped(triangulation: GeodesicTriangulation, more: int) -> Cells:
    """Cells that are Delaunay, with room for `more` sites."""
    cells = cells_of(triangulation, more)
    _settle(cells, triangulation.face_count)
    return cells


def _settle(cells: Cells, count: int) -> None:
    if not legalise(cells, push_all(cells, count), _MOST_FLIPS_EACH * count):
        raise MapError(
            f"the edges of {count} triangles were flipped {_MOST_FLIPS_EACH * count} times without an end; the "
            "triangulation to start from is no triangulation of X/H: check that its areas are positive"
        )


# ---- from cells to a triangulation ----------------------------------------------------------------------------------


def _result(cells: Cells, orbifold: Orbifold, vertex: Ints) -> SiteTriangulation:
    """The triangles that are left, each in a frame at its centre, and the corners of sites."""
    _settle(cells, len(cells.corners))
    alive = np.flatnonzero(cells.twin[::3] >= 0)
    number = np.cumsum(cells.twin[::3] >= 0) - 1
    halfedge = (3 * alive[:, None] + np.arange(3)).ravel()
    twin = cells.twin[halfedge]
    triangulation = _centred(
        orbifold,
        cells.corners[alive],
        3 * number[twin // 3] + twin % 3,
        cells.same[halfedge],
        cells.patch[alive],
        cells.placement[alive],
    )
    seat = cells.seat[vertex]
    return SiteTriangulation(triangulation, triangulation.vertex.ravel()[3 * number[seat // 3] + seat % 3])


def _centred(
    orbifold: Orbifold, corners: Floats, twin: Ints, same: Bools, patch: Ints, placement: Floats
) -> GeodesicTriangulation:
    """Every triangle in a frame at its centre, attached to a patch near it, with gluings from the edges alone."""
    geometry = orbifold.geometry
    centre = geometry.carry(geometry.project(corners.sum(axis=1)))
    back = geometry.inverse(centre)
    x = geometry.settle(geometry.act(back[:, None], corners))
    patch, placement = _attached(orbifold.atlas, patch, geometry.nearest_isometry(placement @ centre))
    gluing = edge_gluings(geometry, x, twin, same)
    return GeodesicTriangulation(orbifold, x, twin, same, gluing, patch, placement)


def edge_gluings(geometry: Geometry, corners: Floats, twin: Ints, same: Bools) -> Floats:
    """The isometries from triangle to triangle across every edge, from its ends in both frames, (3 F, 3, 3)."""
    start = corners.reshape(-1, 3)
    end = np.roll(corners, -1, axis=1).reshape(-1, 3)
    there = np.where(same[:, None], start[twin], end[twin]), np.where(same[:, None], end[twin], start[twin])
    return geometry.isometry_between(there[0], there[1], start, end, np.where(same, -1.0, 1.0))


def _attached(atlas: Atlas, patch: Ints, placement: Floats) -> tuple[Ints, Floats]:
    """Frames attached to patches whose origins are near them: from patch to patch, while that brings them nearer."""
    geometry, patch, placement = atlas.geometry, patch.copy(), placement.copy()
    order = np.argsort(atlas.tail, kind="stable")
    bound = np.searchsorted(atlas.tail[order], np.arange(atlas.patch_count + 1))
    far = np.arange(len(patch))
    while len(far):
        distance = geometry.distance(geometry.origin, placement[far, :, 0])
        far, distance = far[distance > atlas.radius[patch[far]]], distance[distance > atlas.radius[patch[far]]]
        best, step = distance * (1 - 1e-9), np.full(len(far), -1)
        for p in np.unique(patch[far]):
            here = np.flatnonzero(patch[far] == p)
            leaving = order[bound[p] : bound[p + 1]]
            moved = geometry.act(atlas.isometry[atlas.inverse[leaving]], placement[far[here], None, :, 0])
            reach = geometry.distance(geometry.origin, moved)
            nearest = reach.argmin(axis=1)
            least = reach[np.arange(len(here)), nearest]
            step[here] = np.where(least < best[here], leaving[nearest], -1)
        far, step = far[step >= 0], step[step >= 0]
        patch[far] = atlas.head[step]
        placement[far] = geometry.nearest_isometry(atlas.isometry[atlas.inverse[step]] @ placement[far])
    return patch, placement
