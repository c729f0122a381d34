"""Crease domain: a triangulation of X/H in which creases of a mesh are chains of edges, and a map that follows them.

Sites are spread over the creases and over the faces between them. A piece of a crease between two sites is to be an
edge of their Delaunay triangulation; where it is none, its middle becomes a site too, and where it has no middle, edges
are flipped. Then the vertices of the mesh on the piece are moved onto the geodesic between its ends, which they are
near, so that the crease runs along edges of the domain exactly, and no triangle of the mesh lies on both sides.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from orbiframe.delaunay.crease_sites import Asked, crease_sites
from orbiframe.delaunay.forced_edges import with_edge
from orbiframe.delaunay.geodesic_edges import Geodesics, edges_along
from orbiframe.delaunay.site_triangulation import delaunay_of_vertices
from orbiframe.errors import MapError
from orbiframe.triangulations.crease_chains import Chain, CreaseGraph
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Pieces are halved so often, then made edges by flips; those without a middle are made edges so at once.
_ROUNDS, _LAST_ROUNDS = 10, 8


def creased(triangulation: Triangulation, crease: Bools, asked: Asked, seam: Bools | None = None) -> Triangulation:
    """The map with creases (H,) and sites for as many functions as are asked for, geodesic from site to site.

    seam: (H,), those of the creases across which the surface is smooth. Raises MapError where creases cannot be placed.
    """
    marked = replace(triangulation, crease=crease, seam=seam)
    return _Placing(triangulation, marked).placed(crease_sites(marked, asked))


def crease_triangulation(triangulation: Triangulation) -> GeodesicTriangulation:
    """The Delaunay triangulation of the sites of a map with creases, in which these are edges.

    Raises MapError where a piece of a crease between two sites is no edge.
    """
    assert triangulation.sites is not None
    domain, pieces, edges = _with_edges(triangulation, triangulation.sites, np.inf)
    if (edges < 0).any():
        raise MapError(_no_place(triangulation, pieces[int(np.argmin(edges))]))
    return domain


def off_geodesics(triangulation: Triangulation) -> float:
    """How far vertices on creases are from the geodesic between the sites about them: the largest, per its length.

    Infinite for a crease that no site interrupts.
    """
    geometry, worst = triangulation.orbifold.geometry, 0.0
    assert triangulation.crease is not None
    stop = np.zeros(len(triangulation.points), dtype=np.bool_)
    stop[triangulation.sites] = True
    for piece in CreaseGraph.of(triangulation.polyhedron, triangulation.crease, triangulation.sites).chains(
        triangulation
    ):
        if not stop[piece.vertices[[0, -1]]].all():
            return np.inf
        x = piece.lifted(triangulation)
        plane = np.cross(x[0], x[-1])
        size = np.sqrt(max(float((plane**2 * [geometry.curvature, 1, 1]).sum()), np.finfo(float).tiny))
        length = float(geometry.distance(x[0], x[-1]))
        worst = max(worst, float(np.abs(x @ plane).max() / size / max(length, np.finfo(float).tiny)))
    return worst


def _with_edges(
    triangulation: Triangulation, sites: Ints, forced: float
) -> tuple[GeodesicTriangulation, list[Chain], Ints]:
    """The domain with its creases, the pieces of creases between sites, and the halfedge of each, -1 for none.

    Pieces that are no edges of the Delaunay triangulation are made edges by flips, if all of them have at most `forced`
    vertices; else the longer ones are to be halved first.
    """
    assert triangulation.crease is not None
    start = GeodesicTriangulation.of_map(triangulation)
    number = np.empty(len(triangulation.polyhedron.vertices), dtype=np.intp)
    number[triangulation.polyhedron.triangles] = start.vertex
    found = delaunay_of_vertices(start, number[sites])
    domain = found.triangulation
    vertex = np.full(len(number), -1, dtype=np.intp)
    vertex[sites] = found.vertex
    pieces = list(CreaseGraph.of(triangulation.polyhedron, triangulation.crease, sites).chains(triangulation))
    edges = _edges_under(domain, triangulation, pieces, vertex)
    missing = [piece for piece, edge in zip(pieces, edges, strict=True) if edge < 0]
    if any(len(piece.vertices) > forced for piece in missing):
        missing = []
    for piece in missing:
        x, patch = piece.lifted(triangulation), int(triangulation.patch[piece.vertices[0]])
        if (again := with_edge(domain, patch, x[0], x[-1])) is not None:
            domain, vertex[sites] = again.triangulation, again.vertex[vertex[sites]]
    if missing:
        edges = _edges_under(domain, triangulation, pieces, vertex)
    domain = replace(domain, crease=_flags(domain, edges))
    if triangulation.seam is not None:
        smooth = triangulation.seam[np.array([piece.first for piece in pieces])]
        domain = replace(domain, seam=_flags(domain, edges[smooth]))
    return domain, pieces, edges


def _flags(domain: GeodesicTriangulation, halfedges: Ints) -> Bools:
    """Marks at some halfedges, and at their twins; -1 is none."""
    flags = np.zeros(3 * domain.face_count, dtype=np.bool_)
    flags[halfedges[halfedges >= 0]] = True
    return np.asarray(flags | flags[domain.twin])


def _edges_under(
    domain: GeodesicTriangulation, triangulation: Triangulation, pieces: list[Chain], vertex: Ints
) -> Ints:
    """The halfedge of the domain that is the geodesic between the ends of each piece; -1 for none or two."""
    ends = np.array([piece.vertices[[0, -1]] for piece in pieces])
    lifts = [piece.lifted(triangulation) for piece in pieces]
    start, end = np.array([lift[0] for lift in lifts]), np.array([lift[-1] for lift in lifts])
    return edges_along(domain, Geodesics(triangulation.patch[ends[:, 0]], start, end, vertex[ends]))


def _no_place(triangulation: Triangulation, piece: Chain) -> str:
    place = ", ".join(f"{x:.4g}" for x in triangulation.polyhedron.vertices[piece.vertices].mean(axis=0))
    return (
        f"a crease near ({place}) of the mesh, scaled to a box of diagonal 1 about the origin, cannot be a chain of "
        "edges of the domain of the splines; ask for more functions (option size), or for fewer creases (a larger "
        "angle)"
    )


@dataclass(frozen=True, eq=False)
class _Placing:
    """The creases of a map on their way to places: the map without marks, and with them."""

    triangulation: Triangulation
    marked: Triangulation

    @property
    def crease(self) -> Bools:
        assert self.marked.crease is not None
        return self.marked.crease

    def placed(self, sites: Ints) -> Triangulation:
        for turn in range(_ROUNDS + _LAST_ROUNDS):
            forced = 2 if turn < _ROUNDS else np.inf
            _, pieces, edges = _with_edges(self.marked, sites, forced)
            missing = [piece for piece, edge in zip(pieces, edges, strict=True) if edge < 0]
            missing = [piece for piece in missing if len(piece.vertices) > 2] or missing
            if not missing:
                moved = self._straightened(pieces)
                missing = _folded(moved, pieces)
                if not missing:
                    return replace(moved, crease=self.crease, seam=self.marked.seam, sites=sites)
            sites = self._nearer(sites, missing)
        raise MapError(_no_place(self.triangulation, missing[0]))

    def _nearer(self, sites: Ints, missing: list[Chain]) -> Ints:
        """Sites with the middles of some pieces; where a piece has none, without those that lie in its way."""
        mesh = self.triangulation.polyhedron
        middles = [piece.vertices[len(piece.vertices) // 2] for piece in missing if len(piece.vertices) > 2]
        on_crease = np.zeros(len(mesh.vertices), dtype=np.bool_)
        on_crease[mesh.tail[self.crease]] = True
        free, bad = sites[~on_crease[sites]], np.zeros(int((~on_crease[sites]).sum()), dtype=np.bool_)
        for piece in missing:
            if len(piece.vertices) == 2:
                a, b = mesh.vertices[piece.vertices]
                away = np.linalg.norm(mesh.vertices[free] - (a + b) / 2, axis=1)
                bad |= away < max(float(np.linalg.norm(b - a)), float(away.min(initial=np.inf)) * (1 + 1e-9))
        if not middles and not bad.any():
            raise MapError(_no_place(self.triangulation, missing[0]))
        return np.unique(np.concatenate([sites[on_crease[sites]], free[~bad], np.array(middles, dtype=np.intp)]))

    def _straightened(self, pieces: list[Chain]) -> Triangulation:
        """The map with the vertices on creases moved to the geodesics between sites, each as far along as before."""
        flat, geometry = self.triangulation, self.triangulation.orbifold.geometry
        points = flat.points.copy()
        for piece in (piece for piece in pieces if len(piece.vertices) > 2):
            frames = piece.frames(flat)
            x = geometry.act(frames, flat.points[piece.vertices])
            way = np.concatenate([[0.0], np.cumsum(geometry.distance(x[:-1], x[1:]))])
            line = geometry.geodesic(x[0], x[-1], (way / way[-1])[1:-1])
            points[piece.vertices[1:-1]] = geometry.settle(geometry.act(geometry.inverse(frames[1:-1]), line))
        return _in_patches(replace(flat, points=points))


def _folded(moved: Triangulation, pieces: list[Chain]) -> list[Chain]:
    """The pieces that were moved where a triangle is folded now."""
    bad = np.flatnonzero(~(moved.areas > 0))
    if not len(bad):
        return []
    near = np.zeros(len(moved.points), dtype=np.bool_)
    near[moved.polyhedron.triangles[bad]] = True
    found = [piece for piece in pieces if near[piece.vertices[1:-1]].any()]
    if not found:
        raise MapError(
            "triangles of the map fold where creases are made geodesic; ask for more functions (option size)"
        )
    return found


def _in_patches(triangulation: Triangulation) -> Triangulation:
    """The same map in patches that are as large as their triangles reach."""
    orbifold, mesh = triangulation.orbifold, triangulation.polyhedron
    atlas, geometry, step = orbifold.atlas, orbifold.geometry, triangulation.transition
    reach = atlas.radius.copy()
    tail, head = triangulation.patch[mesh.tail], triangulation.patch[mesh.head]
    ahead = geometry.act(atlas.isometry[step], triangulation.points[mesh.head])
    behind = geometry.act(atlas.isometry[atlas.inverse[step]], triangulation.points[mesh.tail])
    for patch, x in ((triangulation.patch, triangulation.points), (tail, ahead), (head, behind)):
        np.maximum.at(reach, patch, geometry.distance(geometry.origin, x))
    return replace(triangulation, orbifold=replace(orbifold, atlas=replace(atlas, radius=reach)))
