"""Open triangulation: a Delaunay triangulation of X/H in which the boundary of a surface is a chain of edges."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.delaunay.geodesic_edges import with_edges_along
from orbiframe.delaunay.site_triangulation import SiteTriangulation, delaunay
from orbiframe.delaunay.sites import lloyd_step, vertex_points
from orbiframe.errors import FitError
from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.border import inside
from orbiframe.surfaces.border_curve import border_curves
from orbiframe.surfaces.border_pieces import BorderPieces, even_pieces
from orbiframe.surfaces.scattering import map_areas, scattered_points
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.point_location import Locator

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

_STEPS = 6
# Sites beyond the boundary, only to lead the first triangles: so many for each within, and no fewer.
_BEYOND, _FEWEST = 0.5, 12
# Pieces of the boundary that are no edges are halved so often, then given up.
_ROUNDS = 6


class OpenTriangulation(NamedTuple):
    """A triangulation of X/H, and which of its triangles are those of a surface with a boundary.

    domain: the triangulation; sites: its vertices, the beginnings of the pieces of the boundary first, and vertex, the
    number that each has in it, (n,); pieces: of the boundary; edges: the halfedge of each piece, (m,); kept: (F,).
    """

    domain: GeodesicTriangulation
    sites: Points
    vertex: Ints
    pieces: BorderPieces
    edges: Ints
    kept: Bools

    @property
    def triangles(self) -> Ints:
        """The sites at the corners of the triangles of the surface, (f, 3)."""
        number = np.empty(self.domain.vertex_count, dtype=np.intp)
        number[self.vertex] = np.arange(len(self.vertex))
        return number[self.domain.vertex[self.kept]]

    @property
    def wall(self) -> Bools:
        """The halfedges along the boundary, on both sides of it, (3 F,)."""
        found = np.zeros(3 * self.domain.face_count, dtype=np.bool_)
        found[self.edges] = found[self.domain.twin[self.edges]] = True
        return found


def open_triangulation(
    surface: OrbifoldSurface, count: int, seed: int = 0, *, apart: float = 0.5, even: bool = False
) -> OpenTriangulation:
    """Triangles on a surface with a boundary, with about `count` vertices that lie about evenly in space.

    Those on the boundary are even along it from corner to corner. The others come to lie by Lloyd's steps on X, whose
    closing faces have some sites too. Then pieces of the boundary are made edges, by flips. apart: corners that are
    nearer to sharper ones than this share of an edge are none; even: an even number of pieces, so of triangles too,
    that end at vertices of the refined mesh. Raises FitError where pieces of the boundary do not
    become edges, and for a basis without derivatives.
    """
    curves = border_curves(surface)
    area = float(map_areas(surface)[surface.triangulation.own_faces].sum())
    pieces = even_pieces(curves, edge_for(count, area, sum(curve.length for curve in curves)), apart, at_vertices=even)
    if even and len(pieces.curve) % 2:
        pieces = pieces.halved(np.arange(len(pieces.curve)) == (pieces.end - pieces.start).argmax())
    free = _spread(surface, pieces, max(count - len(pieces.curve), 1), seed)
    start = GeodesicTriangulation.of_map(surface.triangulation)
    for _ in range(_ROUNDS):
        current = delaunay(start, _joined(pieces.sites, free))
        current, edges = with_edges_along(current, pieces.geodesics())
        if (edges < 0).any():
            pieces = pieces.halved(edges < 0)
            continue
        kept = _faces_within(surface, current.triangulation, edges)
        found = OpenTriangulation(current.triangulation, _sites(current), current.vertex, pieces, edges, kept)
        beyond = _beyond(surface, found)[len(pieces.curve) :]
        if not beyond.any():
            return found
        free = Points(free.patch[~beyond], free.x[~beyond])
    raise FitError(
        "some pieces of the boundary do not become edges of triangles: it bends too much for their number; take more "
        "vertices, or shorter edges"
    )


def edge_for(count: float, area: float, rim: float) -> float:
    """The edge of even triangles of so many vertices on an area with a rim: each vertex has sqrt(3) / 2 of its square,
    and those on the rim half of that.
    """
    whole, half = area / (math.sqrt(3) / 2), rim / 2
    return 2 * whole / (math.sqrt(half**2 + 4 * whole * count) - half)


def _spread(surface: OrbifoldSurface, pieces: BorderPieces, count: int, seed: int) -> Points:
    """Sites off the boundary, within it and some beyond, after Lloyd's steps in which those on it stay."""
    flat = surface.triangulation
    assert flat.inside is not None
    area = map_areas(surface)
    within = scattered_points(surface, np.where(flat.inside, area, 0.0), count, seed)
    a, b, c = np.moveaxis(flat.polyhedron.vertices[flat.polyhedron.triangles], 1, 0)
    plain = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    more = max(round(_BEYOND * count * float(plain[~flat.inside].sum() / area[flat.inside].sum())), _FEWEST)
    beyond = scattered_points(surface, np.where(flat.inside, 0.0, plain), min(more, count + _FEWEST), seed)
    rim = pieces.sites
    fixed = np.arange(len(rim.patch) + count + len(beyond.patch)) < len(rim.patch)
    start = GeodesicTriangulation.of_map(flat)
    current, ratio, locator = delaunay(start, _joined(rim, within, beyond)), plain / flat.areas, Locator(start)
    for _ in range(_STEPS):
        sites = _sites(current)
        location, own = locator.locate(sites), np.empty(len(fixed), dtype=np.bool_)
        weight = np.empty(len(fixed))
        weight[location.order], own[location.order] = ratio[location.face], flat.inside[location.face]
        own |= fixed
        weight[own] = _element(surface, Points(sites.patch[own], sites.x[own]))
        current = lloyd_step(current, weight**2, fixed)
    free = _sites(current)
    return Points(free.patch[~fixed], free.x[~fixed])


def _element(surface: OrbifoldSurface, points: Points) -> Floats:
    """Area in space for area in X at each point, (n,)."""
    if not isinstance(surface.basis, DifferentiableBasis):
        raise FitError("this basis knows no derivatives, which even triangles need; use one that does, as 'gaussian'")
    _, *slopes = surface.basis.jets(points, surface.coefficients, 1)
    return np.asarray(np.linalg.norm(np.cross(*slopes), axis=1))


def _beyond(surface: OrbifoldSurface, found: OpenTriangulation) -> Bools:
    """Which sites are corners of triangles of the surface, but lie beyond its boundary, (n,); those on it may."""
    used = np.zeros(len(found.vertex), dtype=np.bool_)
    used[found.triangles] = True
    beyond = used.copy()
    beyond[used] &= ~inside(surface, Points(found.sites.patch[used], found.sites.x[used]))
    return beyond


def _faces_within(surface: OrbifoldSurface, domain: GeodesicTriangulation, edges: Ints) -> Bools:
    """The triangles on the surface's side of the rim, (F,): flooded from edge to edge, not across the rim."""
    wall = np.zeros(3 * domain.face_count, dtype=np.bool_)
    wall[edges] = wall[domain.twin[edges]] = True
    here = np.flatnonzero(~wall)
    links = here // 3, domain.twin[here] // 3
    count, part = connected_components(coo_array((np.ones(len(here)), links), shape=(domain.face_count,) * 2))
    geometry = domain.geometry
    middle = geometry.project(domain.corners.sum(axis=1))
    centre = Points(domain.patch, geometry.settle(geometry.act(domain.placement, middle)))
    own = np.where(inside(surface, centre), domain.areas, -domain.areas)
    return np.asarray(np.bincount(part, weights=own, minlength=count)[part] > 0)


def _sites(current: SiteTriangulation) -> Points:
    """The sites of a triangulation in their order."""
    places = vertex_points(current.triangulation)
    return Points(places.patch[current.vertex], places.x[current.vertex])


def _joined(*points: Points) -> Points:
    return Points(*(np.concatenate(table) for table in zip(*points, strict=True)))
