"""Crease domain: a triangulation of X/H in which creases of a mesh are chains of edges, and a map that follows them.

Sites are spread over the creases and over the faces between them. A piece of a crease between two sites is to be an
edge of their Delaunay triangulation; where it is none, its middle becomes a site too, and where it has no middle, edges
are flipped. Then the vertices of the mesh on the piece are moved onto the geodesic between its ends, which they are
near, so that the crease runs along edges of the domain exactly, and no triangle of the mesh lies on both sides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from orbiframe.delaunay.forced_edges import with_edge
from orbiframe.delaunay.site_triangulation import delaunay_of_vertices
from orbiframe.errors import MapError
from orbiframe.meshes.edge_paths import Graph, dijkstra_forest, edge_graph, farthest_points
from orbiframe.meshes.sizes import vector_areas
from orbiframe.orbifolds.atlas import Points
from orbiframe.triangulations.crease_chains import Chain, CreaseGraph
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.local_girth import site_density
from orbiframe.triangulations.point_location import Locator
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Pieces are halved so often, then made edges by flips; those without a middle are made edges so at once.
_ROUNDS, _LAST_ROUNDS = 10, 8
# No site between creases is nearer to one than this share of the spacing.
_APART = 0.6
# How fast the spacing grows away from creases with a smaller one.
_SLOPE = 0.7
# The spacing is found by so many trials, or as soon as the number of functions is as near as this.
_TRIALS, _ENOUGH = 5, 0.08
# Between two sites a crease turns by no more than about this.
_BEND = np.radians(45)
# How far, in barycentric coordinates, the middle of a piece of a crease may be from an edge.
_ON_EDGE = 1e-7
# Extra unknowns of a vertex on a crease, and extra open edges there: one of the crease, two hairs.
_EXTRA_AT_VERTEX, _EXTRA_EDGES = 2, 3


def creased(
    triangulation: Triangulation, crease: Bools, size: int, unknowns: tuple[int, int, int], grading: float = 0.6
) -> Triangulation:
    """The map with creases (H,) and sites for about `size` functions, so that creases are geodesic from site to site.

    unknowns: how many there are at each vertex, edge and triangle of the domain. Raises MapError where creases cannot
    be placed.
    """
    return _Placing(triangulation, crease, grading).placed(size, unknowns)


def crease_triangulation(triangulation: Triangulation) -> GeodesicTriangulation:
    """The Delaunay triangulation of the sites of a map with creases, in which these are edges.

    Raises MapError where a piece of a crease between two sites is no edge.
    """
    assert triangulation.crease is not None
    assert triangulation.sites is not None
    domain, pieces, edges = _with_edges(triangulation, triangulation.crease, triangulation.sites, np.inf)
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
    triangulation: Triangulation, crease: Bools, sites: Ints, forced: float
) -> tuple[GeodesicTriangulation, list[Chain], Ints]:
    """The domain with its creases, the pieces of creases between sites, and the halfedge of each, -1 for none.

    Pieces that are no edges of the Delaunay triangulation are made edges by flips, if all of them have at most `forced`
    vertices; else the longer ones are to be halved first.
    """
    start = GeodesicTriangulation.of_map(triangulation)
    number = np.empty(len(triangulation.polyhedron.vertices), dtype=np.intp)
    number[triangulation.polyhedron.triangles] = start.vertex
    found = delaunay_of_vertices(start, number[sites])
    domain = found.triangulation
    vertex = np.full(len(number), -1, dtype=np.intp)
    vertex[sites] = found.vertex
    pieces = list(CreaseGraph.of(triangulation.polyhedron, crease, sites).chains(triangulation))
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
    flags = np.zeros(3 * domain.face_count, dtype=np.bool_)
    flags[edges[edges >= 0]] = True
    return replace(domain, crease=flags | flags[domain.twin]), pieces, edges


def _edges_under(
    domain: GeodesicTriangulation, triangulation: Triangulation, pieces: list[Chain], vertex: Ints
) -> Ints:
    """The halfedge of the domain that is the geodesic between the ends of each piece; -1 for none or two."""
    geometry, ends = domain.geometry, np.array([piece.vertices[[0, -1]] for piece in pieces])
    lifts = [piece.lifted(triangulation) for piece in pieces]
    middle = geometry.project(np.array([lift[0] + lift[-1] for lift in lifts]))
    location = Locator(domain).locate(Points(triangulation.patch[ends[:, 0]], middle))
    face = np.empty(len(pieces), dtype=np.intp)
    share = np.empty((len(pieces), 3))
    face[location.order] = location.face
    inside = np.linalg.solve(np.swapaxes(domain.corners[location.face], 1, 2), location.columns[:, :, :1])[..., 0]
    share[location.order] = inside / inside.sum(axis=1, keepdims=True)
    corner = (np.abs(share).argmin(axis=1) + 1) % 3
    halfedge = 3 * face + corner
    after = halfedge - corner + (corner + 1) % 3
    joined = np.sort(domain.vertex.ravel()[np.stack([halfedge, after], axis=1)], axis=1)
    right = (np.abs(share).min(axis=1) < _ON_EDGE) & (joined == np.sort(vertex[ends], axis=1)).all(axis=1)
    edge = domain.edge[halfedge]
    once = np.bincount(edge[right], minlength=domain.edge_count)[edge] == 1
    return np.where(right & once, halfedge, -1)


def _no_place(triangulation: Triangulation, piece: Chain) -> str:
    place = ", ".join(f"{x:.4g}" for x in triangulation.polyhedron.vertices[piece.vertices].mean(axis=0))
    return (
        f"a crease near ({place}) of the mesh, scaled to a box of diagonal 1 about the origin, cannot be a chain of "
        "edges of the domain of the splines; ask for more functions (option size), or for fewer creases (a larger "
        "angle)"
    )


@dataclass(frozen=True, eq=False)
class _Placing:
    """The creases of a map on their way to places."""

    triangulation: Triangulation
    crease: Bools
    grading: float

    def placed(self, size: int, unknowns: tuple[int, int, int]) -> Triangulation:
        sites = self._sites(size, unknowns)
        for turn in range(_ROUNDS + _LAST_ROUNDS):
            forced = 2 if turn < _ROUNDS else np.inf
            _, pieces, edges = _with_edges(self.triangulation, self.crease, sites, forced)
            missing = [piece for piece, edge in zip(pieces, edges, strict=True) if edge < 0]
            missing = [piece for piece in missing if len(piece.vertices) > 2] or missing
            if not missing:
                moved = self._straightened(pieces)
                missing = _folded(moved, pieces)
                if not missing:
                    return replace(moved, crease=self.crease, sites=sites)
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

    def _sites(self, size: int, unknowns: tuple[int, int, int]) -> Ints:
        """Sites on the creases, then between them, about as many as the functions ask for."""
        mesh = self.triangulation.polyhedron
        density = site_density(self.triangulation, self.grading)
        length = mesh.edge_lengths * (density[mesh.tail] + density[mesh.head]) / 2
        at_vertex, on_edge, in_face = unknowns
        each, more = at_vertex + 3 * on_edge + 2 * in_face, _EXTRA_AT_VERTEX + _EXTRA_EDGES * on_edge
        area = np.linalg.norm(vector_areas(mesh), axis=1) @ (density[mesh.triangles].mean(axis=1) ** 2)
        spacing = float(np.sqrt(each * area / size))
        for _ in range(_TRIALS):
            on, between = self._spread(length, spacing)
            asked = (each + more) * len(on) + each * len(between)
            if abs(asked / size - 1) < _ENOUGH:
                break
            spacing *= float(np.clip(np.sqrt(asked / size), 0.5, 2.0))
        return np.unique(np.concatenate([on, between]))

    def _spread(self, length: Floats, spacing: float) -> tuple[Ints, Ints]:
        """Sites on and between creases at this spacing, between them the nearer, the nearer those on creases are."""
        mesh = self.triangulation.polyhedron
        graph, rim = edge_graph(mesh, length), np.unique(mesh.tail[self.crease])
        on, apart = self._on_creases(length, spacing)
        reach = dijkstra_forest(_with_hub(graph, on, apart / _SLOPE), np.array([len(mesh.vertices)])).distance[:-1]
        local = np.minimum(spacing, _SLOPE * reach)
        scaled = edge_graph(mesh, length * (spacing / local[mesh.tail] + spacing / local[mesh.head]) / 2)
        hub = _with_hub(scaled, rim, np.full(len(rim), (1 - _APART) * spacing))
        chosen = farthest_points(hub, len(mesh.vertices), first=len(mesh.vertices), radius=spacing).chosen[1:]
        return on, chosen

    def _on_creases(self, length: Floats, spacing: float) -> tuple[Ints, Floats]:
        """The corners and ends of creases, and vertices between them at about this spacing, and how far apart they are.

        Nearer together on short curves and where a curve turns.
        """
        mesh, apart = self.triangulation.polyhedron, np.full(len(self.triangulation.points), np.inf)
        scale = _scales(mesh.edge_lengths, length, mesh.tail)
        for chain in CreaseGraph.of(mesh, self.crease).chains(self.triangulation):
            way = np.linalg.norm(np.diff(mesh.vertices[chain.vertices], axis=0), axis=1)
            reached = np.concatenate([[0.0], np.cumsum(way * scale[chain.vertices[:-1]])])
            least = 3 if chain.vertices[0] == chain.vertices[-1] else 1
            count = max(least, round(reached[-1] / spacing), math.ceil(_turning(mesh.vertices[chain.vertices]) / _BEND))
            wanted = np.arange(count + 1) * reached[-1] / count
            site = chain.vertices[np.unique(np.abs(reached[:, None] - wanted).argmin(axis=0))]
            apart[site] = np.minimum(apart[site], reached[-1] / count)
        on = np.flatnonzero(np.isfinite(apart))
        return on, np.minimum(apart[on], spacing)


def _turning(x: Floats) -> float:
    """The sum of the angles by which a curve (n, 3) turns at its inner vertices."""
    way = np.diff(x, axis=0)
    way /= np.maximum(np.linalg.norm(way, axis=1), np.finfo(float).tiny)[:, None]
    turn = 2 * np.arcsin(np.minimum(np.linalg.norm(np.diff(way, axis=0), axis=1) / 2, 1.0))
    return float(turn.sum())


def _scales(edges: Floats, length: Floats, tail: Ints) -> Floats:
    """The length of sites per length in space at the vertices."""
    weight = np.bincount(tail, weights=edges)
    return np.bincount(tail, weights=length) / np.maximum(weight, np.finfo(float).tiny)


def _with_hub(graph: Graph, rim: Ints, length: Floats) -> Graph:
    """The graph with one more vertex, joined to all of a rim by links of some lengths."""
    count, degree = len(graph.start) - 1, np.diff(graph.start)
    owner = np.concatenate([np.repeat(np.arange(count), degree), rim, np.full(len(rim), count)])
    neighbour = np.concatenate([graph.neighbour, np.full(len(rim), count), rim])
    lengths = np.concatenate([graph.length, length, length])
    order = np.argsort(owner, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=count + 1))]).astype(np.intp)
    none = np.zeros(len(owner), dtype=np.intp)
    return Graph(start, neighbour[order], lengths[order], none, none.astype(np.bool_))


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
