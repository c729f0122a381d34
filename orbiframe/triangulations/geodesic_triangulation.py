"""GeodesicTriangulation: X/H cut into geodesic triangles, each in a frame of its own."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.errors import MapError
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.planes.geometry import Geometry
from orbiframe.triangulations.edge_frames import about_centres, edge_gluings
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class GeodesicTriangulation:
    """X/H cut into geodesic triangles: the domain of splines, of any density, down to one vertex.

    Every triangle has a frame of its own, in which its corners lie near the origin and run counterclockwise. Halfedge
    e = 3 f + c runs from corner c of triangle f to corner c + 1. Two triangles may share several edges, a triangle
    may be glued to itself and its corners may be one vertex: nothing is said of H beyond the gluings.

    corners: (F, 3, 3), [triangle, corner, coordinate]; twin: (3 F,); same: (3 F,), the twin runs the same way, so that
    the gluing reverses orientation; gluing: (3 F, 3, 3), the isometry from the frame of the triangle of the twin to the
    frame of the triangle of the halfedge; patch: (F,) and placement: (F, 3, 3), the isometry from the frame of each
    triangle to the frame of a patch of the orbifold. crease: (3 F,), the halfedges of creases, across which functions
    are only continuous; None for none. seam: (3 F,), those of them across which a surface is smooth; None for none.
    """

    orbifold: Orbifold
    corners: Floats
    twin: Ints
    same: Bools
    gluing: Floats
    patch: Ints
    placement: Floats
    crease: Bools | None = None
    seam: Bools | None = None

    @classmethod
    def of_map(cls, triangulation: Triangulation) -> GeodesicTriangulation:
        """The triangles of the map of a mesh. Raises MapError if some triangle is folded over."""
        mesh, orbifold = triangulation.polyhedron, triangulation.orbifold
        if triangulation.not_positive:
            raise MapError(
                f"{triangulation.not_positive} of {mesh.face_count} triangles of the map are folded; functions on X/H "
                "need an embedding: use map.method = 'auto'"
            )
        steps = orbifold.atlas.isometry[triangulation.corner_transitions].reshape(-1, 3, 3)
        gluing = steps @ orbifold.geometry.inverse(steps[_starts(mesh.twin, mesh.same)])
        mirror = np.tile(np.eye(3), (mesh.face_count, 1, 1))
        mirror[:, 2, 2] = np.sign(np.linalg.det(triangulation.lifts))
        halfedge_mirror = np.repeat(mirror, 3, axis=0)
        return cls(
            orbifold,
            triangulation.lifts @ mirror,
            mesh.twin,
            mesh.same,
            halfedge_mirror @ gluing @ halfedge_mirror[mesh.twin],
            triangulation.patch[mesh.triangles[:, 0]],
            mirror,
        )

    @property
    def geometry(self) -> Geometry:
        """The plane of constant curvature that covers the surface."""
        return self.orbifold.geometry

    @property
    def face_count(self) -> int:
        """Number of triangles."""
        return len(self.corners)

    @cached_property
    def start(self) -> Ints:
        """The corner 3 f + c of the triangle of the twin that is glued to the start of each halfedge, (3 F,)."""
        return _starts(self.twin, self.same)

    @cached_property
    def vertex(self) -> Ints:
        """The vertex of every corner, (F, 3); vertices are numbered by their first corners."""
        count = 3 * self.face_count
        here = np.arange(count)
        links = np.concatenate([here, _following(here)]), np.concatenate([self.start, self.end])
        graph = coo_array((np.ones(2 * count), links), shape=(count, count))
        label = connected_components(graph, directed=False)[1]
        first, number = np.unique(label, return_index=True)[1], np.empty(label.max() + 1, dtype=np.intp)
        number[label[np.sort(first)]] = np.arange(len(first))
        return np.asarray(number[label].reshape(-1, 3))

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""
        return int(self.vertex.max()) + 1

    @cached_property
    def vertex_corner(self) -> Ints:
        """The reference corner 3 f + c of every vertex, (V,): its first."""
        return np.unique(self.vertex, return_index=True)[1]

    @cached_property
    def corner_frame(self) -> Floats:
        """The isometry from the frame of the reference corner of the vertex to the frame of each corner, (F, 3, 3, 3).

        corners[f, c] = corner_frame[f, c] v, where v is the reference corner of its vertex: found by walking round the
        vertex from gluing to gluing, both ways at once.
        """
        frame = np.full((3 * self.face_count, 3, 3), np.nan)
        known = np.zeros(3 * self.face_count, dtype=np.bool_)
        level = self.vertex_corner
        frame[level], known[level] = np.eye(3), True
        while len(level):
            level = self._next_corners(frame, known, level)
        return frame.reshape(-1, 3, 3, 3)

    def _next_corners(self, frame: Floats, known: Bools, level: Ints) -> Ints:
        """Enter the frames of the corners beside those of a level, and return them."""
        face, corner = np.divmod(level, 3)
        before = 3 * face + (corner + 2) % 3
        # Across the halfedge that starts at the corner, and across the one that ends there.
        across = np.concatenate([level, before])
        beside = np.concatenate([self.start[level], self.end[before]])
        source = np.concatenate([level, level])
        beside, first = np.unique(beside, return_index=True)
        new = ~known[beside]
        beside, first = beside[new], first[new]
        frame[beside] = self.geometry.inverse(self.gluing[across[first]]) @ frame[source[first]]
        known[beside] = True
        return np.asarray(beside)

    @cached_property
    def end(self) -> Ints:
        """The corner of the triangle of the twin that is glued to the end of each halfedge, (3 F,)."""
        return np.where(self.same, _following(self.twin), self.twin)

    @property
    def creased(self) -> Bools:
        """The halfedges of creases, (3 F,)."""
        return np.zeros(3 * self.face_count, dtype=np.bool_) if self.crease is None else self.crease

    @property
    def sharp(self) -> Bools:
        """The halfedges of creases that are no seams, (3 F,)."""
        return self.creased if self.seam is None else self.creased & ~self.seam

    @cached_property
    def crease_degree(self) -> Ints:
        """How many creases meet at every vertex, (V,): 1 where one ends, 2 on its way, more at corners."""
        return self._degree(self.creased)

    @property
    def sharp_degree(self) -> Ints:
        """The same without seams."""
        return self._degree(self.sharp)

    def _degree(self, marked: Bools) -> Ints:
        first, vertex = np.flatnonzero(marked & self.reference), self.vertex.ravel()
        return np.bincount(vertex[np.concatenate([first, _following(first)])], minlength=self.vertex_count)

    @cached_property
    def reference(self) -> Bools:
        """One halfedge of every edge is marked, (3 F,): the smaller of the two; a mirror is its own twin."""
        return np.arange(3 * self.face_count) <= self.twin

    @cached_property
    def edge(self) -> Ints:
        """The edge of every halfedge, (3 F,); edges are numbered by their reference halfedges."""
        number = np.cumsum(self.reference) - 1
        return number[np.where(self.reference, np.arange(len(number)), self.twin)]

    @property
    def edge_count(self) -> int:
        """Number of edges."""
        return int(self.reference.sum())

    @property
    def euler_characteristic(self) -> int:
        """Vertices less edges plus triangles."""
        return self.vertex_count - self.edge_count + self.face_count

    @cached_property
    def areas(self) -> Floats:
        """The area of every triangle, (F,); all positive, and their sum is the area of X/H."""
        x = self.corners
        return self.geometry.triangle_area(x[:, 0], x[:, 1], x[:, 2])

    @property
    def area_defect(self) -> float:
        """The sum of the areas against the area of X/H, relative."""
        return float(abs(self.areas.sum() / self.orbifold.area - 1))

    @cached_property
    def edge_lengths(self) -> Floats:
        """The length of every halfedge, (3 F,)."""
        return self.geometry.distance(self.corners, np.roll(self.corners, -1, axis=1)).ravel()

    @property
    def gluing_defect(self) -> float:
        """How far the gluings are from taking the ends of twins to each other: the largest error of a coordinate."""
        flat, halfedge = self.corners.reshape(-1, 3), np.arange(3 * self.face_count)
        ends = ((halfedge, self.start), (_following(halfedge), self.end))
        return max(float(np.abs(flat[a] - self.geometry.act(self.gluing, flat[b])).max()) for a, b in ends)

    @property
    def vertex_defect(self) -> float:
        """How far walks round the vertices are from the identity: the largest error of a corner frame."""
        frame = self.corner_frame.reshape(-1, 3, 3)
        return float(np.abs(frame - self.gluing @ frame[self.start]).max())

    def refined(self) -> GeodesicTriangulation:
        """Every triangle in four, through the midpoints of its edges: triangle 4 f + c at corner c, 4 f + 3 inside.

        The midpoint of edge c, from corner c to c + 1, is corner c + 1 of child c and corner c of the inner child. Each
        child has a frame of its own at its centre, so that refined triangles are exact however large these are.
        """
        x, geometry = self.corners, self.geometry
        middle = geometry.project(x + np.roll(x, -1, axis=1))
        before = np.roll(middle, 1, axis=1)
        child = np.empty((self.face_count, 4, 3, 3))
        for c in range(3):
            child[:, c, c], child[:, c, (c + 1) % 3], child[:, c, (c + 2) % 3] = x[:, c], middle[:, c], before[:, c]
        child[:, 3] = middle
        twin, same = self._refined_twins()
        corners, placement = about_centres(geometry, child.reshape(-1, 3, 3), np.repeat(self.placement, 4, axis=0))
        gluing = edge_gluings(geometry, corners, twin, same)
        patch = np.repeat(self.patch, 4)
        return GeodesicTriangulation(
            self.orbifold, corners, twin, same, gluing, patch, placement, _halves(self.crease), _halves(self.seam)
        )

    def _refined_twins(self) -> tuple[Ints, Bools]:
        """Twins and side flags of the children: outer halves inherit."""
        count = self.face_count
        twin = np.empty((count, 4, 3), dtype=np.intp)
        same = np.zeros((count, 4, 3), dtype=np.bool_)
        base = 12 * np.arange(count)
        for c in range(3):
            after = (c + 1) % 3
            # Halfedge c + 1 of child c runs from the middle of edge c to that of edge c - 1, beside the inner triangle.
            twin[:, c, after] = base + 9 + (c + 2) % 3
            twin[:, 3, (c + 2) % 3] = base + 3 * c + after
            edge = 3 * np.arange(count) + c
            for child in (c, after):
                start_half = child == c
                twin[:, child, c] = _half(self.twin[edge], self.same[edge] == start_half)
                same[:, child, c] = self.same[edge]
        return twin.ravel(), same.ravel()


def _following(halfedge: Ints) -> Ints:
    """The next halfedge round the triangle."""
    return halfedge - halfedge % 3 + (halfedge + 1) % 3


def _starts(twin: Ints, same: Bools) -> Ints:
    """The corner at the end of the twin that is glued to the start of each halfedge; corner c starts halfedge c."""
    return np.where(same, twin, _following(twin))


def _half(halfedge: Ints, first: Bools) -> Ints:
    """The half of a halfedge, in the refined triangulation, that begins where it does, or that ends where it does."""
    face, c = np.divmod(halfedge, 3)
    return np.asarray(12 * face + 3 * np.where(first, c, (c + 1) % 3) + c)


def _halves(marked: Bools | None) -> Bools | None:
    """The halves of marked edges (3 F,) of triangles that are cut in four, (12 F,)."""
    if marked is None:
        return None
    whole = marked.reshape(-1, 3)
    found = np.zeros((len(whole), 4, 3), dtype=np.bool_)
    for c in range(3):
        found[:, c, c], found[:, (c + 1) % 3, c] = whole[:, c], whole[:, c]
    return found.ravel()
