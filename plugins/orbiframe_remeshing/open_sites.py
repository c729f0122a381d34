"""Open sites: vertices on a surface with a boundary, those on the boundary first, and triangles between them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe import FitError, OrbifoldSurface, Points
from orbiframe.delaunay import Geodesics, SiteTriangulation, delaunay, lloyd_step, vertex_points, with_edges_along
from orbiframe.surfaces import BorderCurve, border_curves, inside
from orbiframe.triangulations import GeodesicTriangulation, Locator
from orbiframe_remeshing.even_sites import map_areas, scattered_over
from orbiframe_remeshing.surface_mesh import Rim, SurfaceMesh, element, jets_at

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

_STEPS = 6
# Where the boundary turns by more it has a corner, which stays if no sharper one is nearer than this share of an edge.
_CORNER, _APART = np.radians(30), 0.5
# Sites beyond the boundary, only to lead the first triangles: so many for each within, and no fewer.
_BEYOND, _FEWEST = 0.5, 12
# Pieces of the boundary that are no edges are halved so often, then made edges by flips.
_ROUNDS = 6


class Pieces(NamedTuple):
    """The boundary in pieces: each runs from arc length start to end, (n,), of a curve, (n,), and on to the next piece.

    following: (n,), the piece that each runs on to.
    """

    curves: list[BorderCurve]
    curve: Ints
    start: Floats
    end: Floats
    following: Ints

    @classmethod
    def of(cls, curves: list[BorderCurve], starts: list[Floats]) -> Pieces:
        """The pieces between arc lengths of every curve, in rising order."""
        count = np.array([len(start) for start in starts])
        first = np.cumsum(count) - count
        curve = np.repeat(np.arange(len(curves)), count)
        following = np.concatenate([a + (np.arange(n) + 1) % n for a, n in zip(first, count, strict=True)])
        ends = [np.append(s[1:], s[0] + c.length) for s, c in zip(starts, curves, strict=True)]
        return cls(curves, curve, np.concatenate(starts), np.concatenate(ends), following)

    @property
    def sites(self) -> Points:
        """Where pieces begin."""
        return self._points(self.start)

    def along(self, share: float) -> Points:
        """The points of the boundary at a share of the way along pieces."""
        return self._points((1 - share) * self.start + share * self.end)

    def _points(self, arc: Floats) -> Points:
        found = [curve.points(arc[self.curve == k]) for k, curve in enumerate(self.curves)]
        return _joined(*found)

    def geodesics(self) -> Geodesics:
        """The geodesics along pieces, between sites that are numbered as pieces are."""
        parts = [
            curve.geodesics(self.start[self.curve == k], self.end[self.curve == k])
            for k, curve in enumerate(self.curves)
        ]
        patch, start, end = (np.concatenate(table) for table in zip(*parts, strict=True))
        return Geodesics(patch, start, end, np.stack([np.arange(len(patch)), self.following], axis=1))

    def halved(self, some: Bools) -> Pieces:
        """Some pieces, (n,), in two."""
        middle = (self.start + self.end) / 2
        starts = []
        for k in range(len(self.curves)):
            own = self.curve == k
            starts.append(np.sort(np.concatenate([self.start[own], middle[own & some]])))
        return Pieces.of(self.curves, starts)


def open_mesh(surface: OrbifoldSurface, count: int, seed: int = 0) -> SurfaceMesh:
    """Triangles on a surface with a boundary, with about `count` vertices that lie about evenly in space.

    Those on the boundary are even along it from corner to corner, and stay. The others come to lie by Lloyd's steps on
    X, whose closing faces have some sites too. Then pieces of the boundary are made edges, and what lies beyond them
    goes. Raises FitError where pieces of the boundary do not become edges.
    """
    curves = border_curves(surface)
    length = sum(curve.length for curve in curves)
    area = float(map_areas(surface)[surface.triangulation.own_faces].sum())
    edge = edge_for(count, area, length)
    pieces = Pieces.of(curves, [_even(curve, edge) for curve in curves])
    free = _spread(surface, pieces, max(count - len(pieces.curve), 1), seed)
    for turn in range(_ROUNDS):
        found, edges = _with_rim(surface, pieces, free)
        missing = edges < 0
        if not missing.any():
            mesh, beyond = _within(surface, found, edges, pieces, len(free.patch))
            if not beyond.any():
                return mesh
            free = Points(free.patch[~beyond], free.x[~beyond])
        else:
            pieces = pieces.halved(missing)
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


def _even(curve: BorderCurve, edge: float) -> Floats:
    """Arc lengths of about even pieces between the corners of a curve, three at least in all."""
    at, turn = curve.corners(_CORNER)
    kept: list[float] = []
    for place in at[np.argsort(-turn, kind="stable")].tolist():
        away = np.abs(np.array(kept) - place)
        if not (np.minimum(away, curve.length - away) < _APART * edge).any():
            kept.append(place)
    stops = np.sort(kept) if kept else np.zeros(1)
    ends = np.append(stops[1:], stops[0] + curve.length)
    number = np.maximum(np.rint((ends - stops) / edge), math.ceil(3 / len(stops))).astype(np.intp)
    shares = [a + (b - a) * np.arange(n) / n for a, b, n in zip(stops, ends, number, strict=True)]
    return np.sort(np.concatenate(shares) % curve.length)


def _spread(surface: OrbifoldSurface, pieces: Pieces, count: int, seed: int) -> Points:
    """Sites off the boundary, within it and some beyond, after Lloyd's steps in which those on it stay."""
    flat = surface.triangulation
    assert flat.inside is not None
    area = map_areas(surface)
    within = scattered_over(surface, np.where(flat.inside, area, 0.0), count, seed)
    a, b, c = np.moveaxis(flat.polyhedron.vertices[flat.polyhedron.triangles], 1, 0)
    plain = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    more = max(round(_BEYOND * count * float(plain[~flat.inside].sum() / area[flat.inside].sum())), _FEWEST)
    beyond = scattered_over(surface, np.where(flat.inside, 0.0, plain), min(more, count + _FEWEST), seed)
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
        weight[own] = element(jets_at(surface, Points(sites.patch[own], sites.x[own])))
        current = lloyd_step(current, weight**2, fixed)
    free = _sites(current)
    return Points(free.patch[~fixed], free.x[~fixed])


def _with_rim(surface: OrbifoldSurface, pieces: Pieces, free: Points) -> tuple[SiteTriangulation, Ints]:
    """The triangulation with sites on the rim and off it, and the halfedges of the pieces of the rim, -1 for none."""
    start = GeodesicTriangulation.of_map(surface.triangulation)
    return with_edges_along(delaunay(start, _joined(pieces.sites, free)), pieces.geodesics())


def _within(
    surface: OrbifoldSurface, found: SiteTriangulation, edges: Ints, pieces: Pieces, free: int
) -> tuple[SurfaceMesh, Bools]:
    """The triangles within the rim, and which of the sites off it lie beyond it and are corners of such, (free,)."""
    domain, sites = found.triangulation, _sites(found)
    kept = _faces_within(surface, domain, edges)
    number = np.empty(domain.vertex_count, dtype=np.intp)
    number[found.vertex] = np.arange(len(found.vertex))
    triangles = number[domain.vertex[kept]]
    used = np.zeros(len(number), dtype=np.bool_)
    used[triangles] = True
    rim = len(pieces.curve)
    beyond = used.copy()
    beyond[used] &= ~inside(surface, Points(sites.patch[used], sites.x[used]))
    renumbered = np.cumsum(used) - 1
    ends = renumbered[pieces.geodesics().ends]
    mesh = SurfaceMesh.at(surface, Points(sites.patch[used], sites.x[used]), renumbered[triangles])
    return replace(mesh, creases=ends, rim=Rim(ends, pieces.along)), beyond[rim : rim + free]


def _faces_within(surface: OrbifoldSurface, domain: GeodesicTriangulation, edges: Ints) -> Bools:
    """The triangles on the surface's side of the rim, (F,): flooded from edge to edge, not across the rim."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

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
