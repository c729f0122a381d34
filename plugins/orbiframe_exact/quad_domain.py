"""Quad domain: X/H cut into a few quadrilaterals, pairs of triangles of a coarse Delaunay triangulation."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import coo_array

from orbiframe import FitError, OrbifoldSurface, Points, surface_type
from orbiframe.delaunay import delaunay_of_vertices, domain_for, vertex_points
from orbiframe.surfaces import OpenTriangulation, border_curves, map_areas, open_triangulation
from orbiframe.triangulations import GeodesicTriangulation, girth
from orbiframe_exact.quad_points import QuadPoints, settled
from orbiframe_exact.rim_sides import RimSide, rim_side
from orbiframe_exact.thirds import thirds

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# What a pair is worth beside its quality, so that no triangle stays alone, and the quality of one that is not convex.
_PAIR, _NOT_CONVEX = 20.0, -5.0
# Pairs of convex quadrilaterals only have at least this quality, also those that meet a vertex twice.
_CONVEX = -2.0
# Readers of CAD files may mistake a face that meets a vertex twice; it is taken where there is no other way.
_MEETS_ITSELF = -10.0
# What a block of the input is worth more, and the least quality of quadrilaterals between corners of blocks.
_BLOCK, _SQUARE_ENOUGH = 2.0, 0.1
# How many vertices more are tried, as shares of those asked for.
_MORE = (0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.5)
# So much energy of the map's scale asks for one face more, and there are so many more at most.
_ENERGY, _LIMBS = 5.0, 24
# Corners of a boundary that are nearer than this share of an edge to a sharper one are rounded.
_APART = 0.02
# Shares that are tried at a boundary, whose corners may ask for many sides.
_MORE_AT_RIMS = (0.0, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 8.0)
_LOOK = np.linspace(0.02, 0.98, 7)


@dataclass(frozen=True, eq=False)
class QuadDomain:
    """Quadrilaterals that cover X/H, with their sides glued.

    Side k of a quadrilateral runs from its corner k to the next: along s at t = 0, along t at s = 1, and back. edge:
    (Q, 4), the edge at every side; rising: (Q, 4), whether the parameter of the edge grows with s or t there; ends:
    (E, 2), the vertices where every edge begins and ends; orientable: whether all can be seen from one side; triangles:
    those that are paired, and pair: (F,), the quadrilateral of each, -1 for those beyond a boundary; into: (F, 3, 3),
    the isometry from the frame of each to that of its quadrilateral; None where each triangle is three quadrilaterals
    in its own frame; closed: whether there is no boundary.
    """

    points: QuadPoints
    edge: Ints
    rising: Bools
    ends: Ints
    orientable: bool
    triangles: GeodesicTriangulation
    pair: Ints
    into: Floats | None
    closed: bool

    @property
    def count(self) -> int:
        """Number of quadrilaterals."""
        return len(self.edge)

    @property
    def meets_itself(self) -> Bools:
        """Which quadrilaterals have a vertex twice, (Q,)."""
        first = np.where(self.rising == np.array([True, True, False, False]), 0, 1)
        return _has_twins(self.ends[self.edge, first])

    def sides_of_edges(self) -> Ints:
        """The two sides 4 q + k at every edge, (E, 2); -1 for one that is not there."""
        order = np.argsort(self.edge.ravel(), kind="stable")
        edge = self.edge.ravel()[order]
        first = np.searchsorted(edge, np.arange(len(self.ends)))
        found = np.full((len(self.ends), 2), -1)
        found[edge, np.arange(len(edge)) - first[edge]] = order
        return found

    @property
    def group_of_faces(self) -> Ints:
        """What `pair` says of the triangles under every face of a file, in the order of the faces."""
        groups = int(self.pair.max()) + 1
        return np.repeat(np.arange(groups), self.count // groups)

    @property
    def smooth(self) -> Bools:
        """The edges at which two faces are to have common tangent planes, (E,): all but those at a boundary."""
        return np.asarray(self.sides_of_edges()[:, 1] >= 0)


def default_count(surface: OrbifoldSurface) -> int:
    """How many faces a surface has where none are asked for: 16, 8 for each unit of |chi|, and up to 24 for limbs.

    Where the scale of the map changes a face cannot be as large: the energy of `girth` says how much it changes. With a
    boundary it says more of what closes the surface for the map, and there are none for it.
    """
    inside = surface.triangulation.inside
    limbs = 0 if inside is not None else min(round(girth(surface.triangulation).energy / _ENERGY), _LIMBS)
    return 16 + 8 * abs(surface_type(surface.own_mesh).euler_characteristic) + limbs


def quad_domain(surface: OrbifoldSurface, count: int, blocks: Ints | None = None) -> QuadDomain:
    """About `count` quadrilaterals: a perfect matching of triangles of greatest quality, of V = count + chi vertices.

    The quality of a pair is the least sine between the two directions on the surface, or the root of the least area
    element over the greatest. Pairs that meet a vertex twice come last. Where triangles cannot be paired, or a
    quadrilateral would be glued to itself or not be convex, there are more vertices; where that does not help either,
    every triangle is divided in three.

    blocks: (B, 4), quadrilaterals of vertices of the input. Their corners are the vertices then, and a pair that is one
    of them is worth more; they count for nothing where a pair comes out far from square.
    """
    if surface.triangulation.inside is not None:
        return _open_domain(surface, count)
    if blocks is not None:
        found = _of_blocks(surface, blocks)
        if found is not None:
            return found
    chi = int(surface.orbifold.euler_characteristic)
    for more in _MORE:
        vertices = max(count + chi, 1) + math.ceil(more * count)
        sites = domain_for(surface.orbifold, surface.triangulation, vertices, (1, 0, 0))
        found, quality = _paired(surface, sites)
        if found is not None and quality > _CONVEX:
            return found
    return _divided(surface, count)


def _divided(surface: OrbifoldSurface, count: int) -> QuadDomain:
    """About twice `count` quadrilaterals, three in every triangle: all convex."""
    vertices = max(math.ceil(count / 3) + int(surface.orbifold.euler_characteristic), 1)
    sites = domain_for(surface.orbifold, surface.triangulation, vertices, (1, 0, 0))
    corners, edge, ends = thirds(sites, sites.corners * _weights(surface, sites)[sites.vertex][..., None])
    return QuadDomain(
        QuadPoints(surface, corners, np.repeat(sites.patch, 3), np.repeat(sites.placement, 3, axis=0)),
        edge,
        np.ones(edge.shape, dtype=np.bool_),
        ends,
        surface.orbifold.orientable,
        sites,
        np.arange(sites.face_count),
        None,
        True,
    )


def _open_domain(surface: OrbifoldSurface, count: int) -> QuadDomain:
    """About `count` quadrilaterals on a surface with a boundary, along which their sides run from corner to corner."""
    area, rim = (float(x) for x in (map_areas(surface)[surface.triangulation.own_faces].sum(), _rim_length(surface)))
    for more in _MORE_AT_RIMS:
        wanted = (1 + more) * count
        vertices = round(wanted + rim / (2 * math.sqrt(area / (math.sqrt(3) / 2) / wanted)))
        sites = open_triangulation(surface, max(vertices, 4), apart=_APART, even=True)
        found, quality = _paired(surface, sites.domain, rim=sites)
        if found is not None and quality > 0:
            return found
    raise FitError(
        f"no {count} faces cover this surface up to its boundary, which has corners or bends that they cannot follow; "
        f"ask for more of them, such as --faces {4 * count}, or write a mesh, to part.ply"
    )


def _rim_length(surface: OrbifoldSurface) -> float:
    return sum((curve.length for curve in border_curves(surface)), 0.0)


def _of_blocks(surface: OrbifoldSurface, blocks: Ints) -> QuadDomain | None:
    """Quadrilaterals between the corners of blocks of the input; None where one is bad."""
    triangulation = surface.triangulation
    start = GeodesicTriangulation.of_map(triangulation)
    number = np.empty(len(triangulation.points), dtype=np.intp)
    number[triangulation.polyhedron.triangles] = start.vertex
    corners, place = np.unique(blocks, return_inverse=True)
    sites, vertex = delaunay_of_vertices(start, number[corners])
    found, quality = _paired(surface, sites, vertex[place.reshape(blocks.shape)])
    return found if quality >= _SQUARE_ENOUGH else None


def _paired(
    surface: OrbifoldSurface,
    sites: GeodesicTriangulation,
    blocks: Ints | None = None,
    rim: OpenTriangulation | None = None,
) -> tuple[QuadDomain | None, float]:
    """The pairs that are worth most, None where none cover all, and the least quality of one."""
    halfedge, vertex = np.arange(3 * sites.face_count), sites.vertex.ravel()
    start, end = vertex, vertex[_following(halfedge)]
    kept = np.ones(sites.face_count, dtype=np.bool_) if rim is None else rim.kept
    wall = np.zeros(len(halfedge), dtype=np.bool_) if rim is None else rim.wall
    mates = (halfedge // 3 != sites.twin // 3) & kept[halfedge // 3] & kept[sites.twin // 3] & ~wall
    inner = np.flatnonzero(sites.reference & mates)
    corners, sides, back = _quads(sites, inner)
    corner = np.where(back, end[sides], start[sides])
    twice = _has_twins(corner)
    points = QuadPoints(surface, corners, sites.patch[inner // 3], sites.placement[inner // 3])
    quality = _quality(points)
    worth = _PAIR + quality + np.where(twice, _MEETS_ITSELF, 0.0)
    if blocks is not None:
        worth += np.where(_are_among(corner, blocks), _BLOCK, 0.0)
    chosen = _matching((np.cumsum(kept) - 1)[np.stack([inner, sites.twin[inner]]) // 3], worth, int(kept.sum()))
    if chosen is None:
        return None, 0.0
    sides, back = sides[chosen], back[chosen]
    reference = np.minimum(sides, sites.twin[sides])
    edges, edge = np.unique(reference, return_inverse=True)
    if _has_twins(edge.reshape(sides.shape)).any():
        return None, 0.0
    pair = np.full(sites.face_count, -1)
    pair[inner[chosen] // 3] = pair[sites.twin[inner[chosen]] // 3] = np.arange(len(chosen))
    into = np.tile(np.eye(3), (sites.face_count, 1, 1))
    into[sites.twin[inner[chosen]] // 3] = sites.gluing[inner[chosen]]
    along = ((sides == reference) | sites.same[sides]) ^ back
    weighted = corners[chosen] * _weights(surface, sites)[corner[chosen]][..., None]
    rims = () if rim is None else tuple(_rims(rim, wall, sides, corner[chosen], weighted))
    found = QuadDomain(
        QuadPoints(surface, weighted, points.patch[chosen], points.placement[chosen], rims),
        edge.reshape(sides.shape),
        along ^ np.array([False, False, True, True]),
        np.stack([start[edges], end[edges]], axis=1),
        surface_type(surface.own_mesh).orientable,
        sites,
        pair,
        into,
        rim is None,
    )
    return found, float((quality - twice)[chosen].min())


def _rims(rim: OpenTriangulation, wall: Bools, sides: Ints, corner: Ints, weighted: Floats) -> Iterator[RimSide]:
    """The sides of quadrilaterals along the boundary."""
    piece = dict(zip(rim.domain.edge[rim.edges].tolist(), range(len(rim.edges)), strict=True))
    first = rim.vertex[: len(rim.edges)]
    for q, k in zip(*(x.tolist() for x in np.nonzero(wall[sides])), strict=True):
        own = piece[int(rim.domain.edge[sides[q, k]])]
        ends = weighted[q, k], weighted[q, (k + 1) % 4]
        yield rim_side(rim.domain.geometry, rim, own, (q, k), ends, back=bool(first[own] != corner[q, k]))


def _quads(sites: GeodesicTriangulation, inner: Ints) -> tuple[Floats, Ints, Bools]:
    """The quadrilateral about every halfedge, in the frame of its triangle: corners, halfedges at its sides, and
    whether these run back.
    """
    face, c = np.divmod(inner, 3)
    other, k = np.divmod(sites.twin[inner], 3)
    apex = sites.geometry.act(sites.gluing[inner], sites.corners[other, (k + 2) % 3])
    near, far = sites.corners[face, c], sites.corners[face, (c + 1) % 3]
    corners = np.stack([sites.corners[face, (c + 2) % 3], near, apex, far], axis=1)
    same, after, last = sites.same[inner], 3 * other + (k + 1) % 3, 3 * other + (k + 2) % 3
    one, two = np.where(same, last, after), np.where(same, after, last)
    sides = np.stack([3 * face + (c + 2) % 3, one, two, 3 * face + (c + 1) % 3], axis=1)
    return corners, sides, np.stack([np.zeros_like(same), same, same, np.zeros_like(same)], axis=1)


def _quality(points: QuadPoints) -> Floats:
    """How square each quadrilateral is on the surface, from 0 to 1; less where it is not convex in X."""
    x = points.corners
    turns = [np.linalg.det(np.stack([x[:, k - 1], x[:, k], x[:, (k + 1) % 4]], axis=1)) for k in range(4)]
    convex = np.flatnonzero((np.stack(turns) > 0).all(axis=0))
    s, t = (grid.ravel() for grid in np.meshgrid(_LOOK, _LOOK))
    _, fs, ft = points.jets(np.repeat(convex, len(s)), np.tile(s, len(convex)), np.tile(t, len(convex)), 1)
    area = np.linalg.norm(np.cross(fs, ft), axis=1)
    sine = area / np.maximum(np.linalg.norm(fs, axis=1) * np.linalg.norm(ft, axis=1), np.finfo(float).tiny)
    area, sine = area.reshape(len(convex), -1), sine.reshape(len(convex), -1)
    even = np.sqrt(area.min(axis=1) / np.maximum(area.max(axis=1), np.finfo(float).tiny))
    quality = np.full(len(x), _NOT_CONVEX)
    quality[convex] = np.minimum(sine.min(axis=1), even)
    return quality


def _matching(pairs: Ints, worth: Floats, count: int) -> Ints | None:
    """The perfect matching of `count` things of greatest worth, as numbers of pairs (2, n); None if there is none."""
    number = pairs.shape[1]
    entries = np.ones(2 * number), (pairs.ravel(), np.tile(np.arange(number), 2))
    each = LinearConstraint(coo_array(entries, shape=(count, number)), 1, 1)
    found = milp(-worth, constraints=each, integrality=np.ones(number, dtype=np.intp), bounds=Bounds(0, 1))
    return None if found.x is None else np.flatnonzero(found.x > 0.5)


def _weights(surface: OrbifoldSurface, sites: GeodesicTriangulation) -> Floats:
    """The fourth root of the area element at every vertex: the speed in space is then equal at both ends of a side."""
    points, _ = settled(surface, vertex_points(sites))
    basis = surface.basis
    d = basis.jets(Points(points.patch, points.x), surface.coefficients, 1)  # type: ignore[attr-defined]
    return np.asarray(np.linalg.norm(np.cross(d[1], d[2]), axis=1) ** 0.25)


def _are_among(rows: Ints, others: Ints) -> Bools:
    """Whether the numbers of a row are those of one of the others, in any order, (n,)."""
    known = {tuple(row) for row in np.sort(others, axis=1).tolist()}
    return np.array([tuple(row) in known for row in np.sort(rows, axis=1).tolist()])


def _has_twins(rows: Ints) -> Bools:
    """Whether some number of a row is there twice, (n,)."""
    return np.asarray((np.diff(np.sort(rows, axis=1), axis=1) == 0).any(axis=1))


def _following(halfedge: Ints) -> Ints:
    return np.asarray(halfedge - halfedge % 3 + (halfedge + 1) % 3)
