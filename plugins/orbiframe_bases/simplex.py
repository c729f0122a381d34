"""Simplex splines on X/H with the vertices of a triangulation as knots."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, permutations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe import Orbifold, Triangulation, UsageError
from orbiframe.delaunay import domain_for
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe_bases.ear_clipping import clip_ears
from orbiframe_bases.knot_clouds import flatness, knot_clouds
from orbiframe_bases.simplex_program import subset_program
from orbiframe_bases.simplex_reach import same_rows
from orbiframe_bases.simplex_splines import KnotSets, SimplexSplines

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Vertices that are looked at for the best displacement of knots, and displacements that are tried.
_WORK, _MOST_TURNS = 1000, 8
# How many functions there are about, for each vertex, edge and triangle: V, at most E, and about 4 V.
_UNKNOWNS = {1: (1, 0, 0), 2: (0, 1, 0), 3: (1, 1, 0)}


class Simplex(SimplexSplines):
    """Homogeneous simplex splines whose knots are the vertices of a triangulation: C^(degree - 1) (paper, section 3.3).

    Degree 1 has the hat functions: B_v = sum of [t] lambda_v chi_t over the triangles t at v, [t] their determinants.
    For each degree more, the triangles in the sum with the knots I are replaced by those of a triangulation of their
    link: B_I = sum of [t] M(t + I) over the triangles t that fill the polygon opposite to I (Neamtu 2001; Liu and
    Snoeyink 2007). There is one function for each vertex (degree 1), for each edge (2), and for each triple of vertices
    that are a triangle or nearly so (3). A homogeneous polynomial has its blossom at the knots I as coefficient of B_I,
    so the functions add up to 1 in E^2.

    The polygons are cut by distances seen from one lift, and cuts are carried to all others: the choice is invariant.
    Knots are vertices moved a little, by `radius` shortest edges, the same way for all lifts, because knots in line
    cost a derivative each; where H itself has three lifts of a vertex in line, `smoothness` says so.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself; degree:
    1, 2 or 3; radius: from 0 to 0.3. Raises UsageError for an option out of range.
    """

    def __init__(
        self,
        orbifold: Orbifold,
        triangulation: Triangulation | GeodesicTriangulation,
        *,
        size: int = 1000,
        degree: int = 2,
        radius: float = 0.2,
    ) -> None:
        if degree not in _UNKNOWNS or not 0 <= radius <= 0.3:
            raise UsageError(
                f"simplex has degree {degree} and radius {radius}; degrees are 1, 2 and 3 (dms has higher ones), radii "
                "from 0 to 0.3"
            )
        domain = domain_for(orbifold, triangulation, size, _UNKNOWNS[degree])
        super().__init__(domain, degree, _best_knot_sets(domain, degree, radius))


def _best_knot_sets(domain: GeodesicTriangulation, degree: int, radius: float) -> KnotSets:
    """The functions for the turn of all displacements that keeps three knots farthest from a line.

    Splines with knots almost in line have creases. On large triangulations no turn avoids them all: there are fewer
    tries.
    """
    made = (_hats, _edge_functions, _triple_functions)[degree - 1]
    tries = min(max(_WORK // domain.vertex_count, 1), _MOST_TURNS)
    turns = np.arange(tries) * (2 * np.pi / tries)
    found = [made(Stars(domain, knot_clouds(domain, 1, radius, turn)[:, 1])) for turn in turns]
    triples = np.array(list(combinations(range(degree + 2), 3)))
    return found[int(np.argmax([flatness(knot_sets.knots, triples) for knot_sets in found]))]


@dataclass(frozen=True, eq=False)
class Stars:
    """The triangles around every vertex, in the frame of its reference corner, in counterclockwise order.

    Spoke s is an edge that leaves a vertex; those of vertex v are first[v] to first[v + 1] - 1. knots: (V, 3), the knot
    of every vertex in that frame.
    """

    domain: GeodesicTriangulation
    knots: Floats

    @property
    def home(self) -> Ints:
        """The triangle whose frame is that of each vertex, (V,)."""
        return self.domain.vertex_corner // 3

    @cached_property
    def _spokes(self) -> tuple[Ints, Ints, Floats]:
        """Vertex, halfedge and isometry from the frame of the far end of every spoke, sorted."""
        d, corner = self.domain, np.arange(3 * self.domain.face_count)
        face, c = np.divmod(corner, 3)
        frame = d.corner_frame.reshape(-1, 3, 3)
        back = d.geometry.inverse(frame)
        left = np.linalg.det(frame) > 0
        far = 3 * face + (c + np.where(left, 1, 2)) % 3
        halfedge = np.where(left, corner, far)
        vertex = d.vertex.ravel()
        place = d.geometry.act(back, d.corners.reshape(-1, 3)[far])
        centre = d.corners.reshape(-1, 3)[d.vertex_corner][vertex]
        axes = d.geometry.frame(centre)
        form = np.array([d.geometry.curvature, 1.0, 1.0])
        across = np.einsum("nik,ni->nk", axes, (place - centre) * form)
        order = np.lexsort((np.arctan2(across[:, 1], across[:, 0]), vertex))
        return vertex[order], halfedge[order], (back @ frame[far])[order]

    @cached_property
    def first(self) -> Ints:
        """The first spoke of every vertex, (V + 1,)."""
        return np.searchsorted(self._spokes[0], np.arange(self.domain.vertex_count + 1))

    @property
    def vertex(self) -> Ints:
        """The vertex that every spoke leaves."""
        return self._spokes[0]

    @property
    def isometry(self) -> Floats:
        """From the frame of the far end of every spoke to the frame of its vertex, (s, 3, 3)."""
        return self._spokes[2]

    @cached_property
    def edge(self) -> Ints:
        """The edge of every spoke."""
        return self.domain.edge[self._spokes[1]]

    @cached_property
    def far(self) -> Ints:
        """The vertex at the far end of every spoke."""
        spokes = np.lexsort((np.arange(len(self.edge)), self.edge)).reshape(-1, 2)
        far = np.empty(len(self.edge), dtype=np.intp)
        far[spokes[:, 0]], far[spokes[:, 1]] = self.vertex[spokes[:, 1]], self.vertex[spokes[:, 0]]
        return far

    @cached_property
    def place(self) -> Floats:
        """The knot at the far end of every spoke, in the frame of its vertex, (s, 3)."""
        return self.domain.geometry.act(self.isometry, self.knots[self.far])

    def flat(self, centre: Floats, places: Floats) -> Floats:
        """Plane coordinates (k, 2) of places (k, 3), projected from the origin of R^3, about a centre (3,)."""
        geometry = self.domain.geometry
        middle = geometry.project(centre)
        axes = geometry.frame(middle) * np.array([geometry.curvature, 1.0, 1.0])[:, None]
        level = places @ (middle * [1.0, geometry.curvature, geometry.curvature])
        return np.asarray((places @ axes) / np.maximum(level, 1e-9)[:, None])

    @cached_property
    def triangles(self) -> Ints:
        """Triangulations of the polygons around the vertices, (n, 3) spokes, counterclockwise."""
        found = []
        for v, (begin, end) in enumerate(zip(self.first[:-1], self.first[1:], strict=True)):
            found.append(begin + clip_ears(self.flat(self.knots[v], self.place[begin:end])))
        return np.concatenate(found)


def _knot_sets(home: Ints, knots: Floats, column: Ints, size: int) -> KnotSets:
    """Functions sum over (t', I') of det(t' with x in place of b) M(t' + I'), b in t', for I = I' + b.

    That is B_I: the inner sides of the triangles that fill the link of I cancel (one step of the recursion). Knots 0,
    1, 2 are t'.
    """
    p, q, r = np.moveaxis(knots[:, :3], 1, 0)
    lead = np.stack([np.cross(q, r - q), np.cross(r, p - r), np.cross(p, q - p)], axis=1)
    base = subset_program(knots.shape[1])
    program = type(base)(base.states, base.start, base.child, base.knot, np.repeat(base.outputs, 3))
    return KnotSets(program, home, knots, np.ones(column.shape), lead, column, size)


def _hats(stars: Stars) -> KnotSets:
    """I' empty, t' the triangles, I a vertex."""
    d = stars.domain
    knots = np.einsum("fcij,fcj->fci", d.corner_frame, stars.knots[d.vertex])
    return _knot_sets(np.arange(d.face_count), knots, d.vertex, d.vertex_count)


def _edge_functions(stars: Stars) -> KnotSets:
    """I' = {v}, t' the triangles that fill the polygon around v, I an edge."""
    t = stars.triangles
    v = stars.vertex[t[:, 0]]
    knots = np.concatenate([stars.place[t], stars.knots[v][:, None]], axis=1)
    return _knot_sets(stars.home[v], knots, stars.edge[t], stars.domain.edge_count)


@dataclass(frozen=True, eq=False)
class _Lifts:
    """Lifts of vertices seen from the frame of another: vertex (..., ), isometry (..., 3, 3) from its frame, knot."""

    vertex: Ints
    isometry: Floats
    place: Floats


def _triple_functions(stars: Stars) -> KnotSets:
    """I' = {v, w} an edge, t' the triangles that fill its link, I a triple."""
    polygon, spoke, triangle = _edge_links(stars)
    v = stars.vertex[spoke]
    b = _Lifts(polygon.vertex[triangle], polygon.isometry[triangle], polygon.place[triangle])
    ends = np.stack([stars.knots[v], stars.place[spoke]], axis=1)
    knots = np.concatenate([b.place, ends], axis=1)
    column = _triple_numbers(stars, spoke, b)
    return _knot_sets(stars.home[v], knots, column, int(column.max()) + 1)


def _edge_links(stars: Stars) -> tuple[_Lifts, Ints, Ints]:
    """The polygons opposite to the edges: their corners, and for every triangle that fills one its spoke and corners.

    The link of {v, w} runs from the left triangle at the edge to the right one around v, and back around w.
    """
    sides = _opposite_sides(stars)
    pairs = np.lexsort((np.arange(len(stars.edge)), stars.edge)).reshape(-1, 2)
    mirrored = np.linalg.det(stars.isometry) < 0
    parts: list[tuple[Ints, Floats, Floats]] = []
    spokes, triangles, total = [], [], 0
    for near, other in pairs:
        g = stars.isometry[near]
        here, there = sides[near], sides[other]
        there = there[::-1] if mirrored[near] else there
        vertex = np.concatenate([stars.far[here[:-1]], stars.far[there[:-1]]])
        isometry = np.concatenate([stars.isometry[here[:-1]], g @ stars.isometry[there[:-1]]])
        place = np.concatenate([stars.place[here[:-1]], stars.place[there[:-1]] @ g.T])
        ears = clip_ears(stars.flat(stars.knots[stars.vertex[near]] + stars.place[near], place))
        parts.append((vertex, isometry, place))
        triangles.append(total + ears)
        spokes.append(np.full(len(ears), near))
        total += len(vertex)
    corners = _Lifts(*(np.concatenate(part) for part in zip(*parts, strict=True)))
    return corners, np.concatenate(spokes), np.concatenate(triangles)


def _opposite_sides(stars: Stars) -> list[Ints]:
    """For every spoke the sides opposite to it in the triangles of its star that hold it, as a path of spokes.

    It runs counterclockwise from the next spoke to the one before.
    """
    t = stars.triangles
    held = [(s, a, b) for k in range(3) for s, a, b in np.roll(t, -k, axis=1).tolist()]
    begin = stars.first[stars.vertex]
    degree = (stars.first[1:] - stars.first[:-1])[stars.vertex]
    paths: list[list[tuple[int, int, int]]] = [[] for _ in begin]
    for s, a, b in held:
        turns = [int((x - s) % degree[s]) for x in (a, b)]
        paths[s].append((turns[0], a, b))
    return [np.array([min(path)[1], *(b for _, _, b in sorted(path))], dtype=np.intp) for path in paths]


def _triple_numbers(stars: Stars, spoke: Ints, b: _Lifts) -> Ints:
    """The number of the triple {v, w, b} of every element and corner, (n, 3): equal if H takes one to the other.

    Each triple is described as seen from each of its three vertices, in both orders of the others; triples with a
    common description are one.
    """
    geometry = stars.domain.geometry
    shape = b.vertex.shape
    near = np.broadcast_to(spoke[:, None], shape).ravel()
    count = len(near)
    vertex = np.stack([stars.vertex[near], stars.far[near], b.vertex.ravel()], axis=1)
    isometry = np.stack([np.tile(np.eye(3), (count, 1, 1)), stars.isometry[near], b.isometry.reshape(-1, 3, 3)], axis=1)
    place = np.stack([stars.knots[stars.vertex[near]], stars.place[near], b.place.reshape(-1, 3)], axis=1)
    back = geometry.inverse(isometry)
    kinds, places = [], []
    for i, j, k in permutations(range(3)):
        seen = [geometry.act(back[:, i], place[:, other]) for other in (j, k)]
        kinds.append(
            (vertex[:, i] * stars.domain.vertex_count + vertex[:, j]) * stars.domain.vertex_count + vertex[:, k]
        )
        places.append(np.concatenate(seen, axis=1))
    number = same_rows(np.concatenate(kinds), np.concatenate(places))
    rows = np.tile(np.arange(count), 6)
    size = number.max() + 1
    graph = coo_array((np.ones(len(rows)), (rows, count + number)), shape=(count + size, count + size))
    label = connected_components(graph, directed=False)[1][:count]
    return np.unique(label, return_inverse=True)[1].reshape(shape)
