"""Triangulation of X/H: a point of X/H for every vertex of a triangle mesh and a transition for every halfedge."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.components.one_line import one_line
from orbiframe.errors import MapError
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.orbifolds.atlas import Points
from orbiframe.orbifolds.orbifold import Orbifold

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Triangulation:
    """The map from a triangle mesh in space to X/H, linear in the projective model on each triangle.

    polyhedron: the triangle mesh in space, with its connectivity; patch: (V,) and points: (V, 3), where each vertex
    lies; transition: (H,), the lifted edge of halfedge h from i to j runs from points[i] to
    atlas.isometry[transition[h]] points[j] in the frame of the patch of i. group: where the group comes from, and
    weights: which edge weights made the map, both in words for the report. density: (V,), how many functions there
    should be per length at each vertex beyond what the map alone asks for, up to a factor; None: the same everywhere.
    crease: (H,), the halfedges of creases, across which functions are only continuous; sites: (n,), the vertices that
    the domain of splines then has, between which creases run along geodesics; None for none. seam: (H,), those of the
    creases across which a surface is smooth, as where a plane ends in a round; None for none. inside: (F,), the
    triangles of a mesh with a boundary, which the others only close; None where all belong to the mesh.

    >>> from orbiframe import fit
    >>> map_to_x = fit("dataset:plate_genus2_coarse", size=60).surface.triangulation
    >>> map_to_x.not_positive  # no triangle is folded
    0
    >>> abs(map_to_x.area_defect) < 1e-9  # their areas add up to that of X/H
    True
    """

    orbifold: Orbifold
    polyhedron: Polyhedron
    patch: Ints
    points: Floats
    transition: Ints
    group: str = "given"
    weights: str = "none"
    density: Floats | None = None
    crease: Bools | None = None
    sites: Ints | None = None
    inside: Bools | None = None
    seam: Bools | None = None

    __repr__ = one_line

    @property
    def own_faces(self) -> Ints:
        """The triangles that belong to the mesh, without those that only close it."""
        return np.arange(self.polyhedron.face_count) if self.inside is None else np.flatnonzero(self.inside)

    @property
    def sharp(self) -> Bools:
        """The halfedges of creases that are no seams, (H,)."""
        none = np.zeros(len(self.polyhedron.tail), dtype=np.bool_)
        return none if self.crease is None else self.crease if self.seam is None else self.crease & ~self.seam

    @cached_property
    def border(self) -> Ints:
        """The halfedges of the mesh's own triangles at its boundary; none where it is closed."""
        if self.inside is None:
            return np.empty(0, dtype=np.intp)
        mesh = self.polyhedron
        return np.flatnonzero(self.inside[mesh.face] & ~self.inside[mesh.face[mesh.twin]])

    @cached_property
    def corner_transitions(self) -> Ints:
        """The transition from the frame of the first corner of each triangle to that of each corner, (F, 3)."""
        t = self.transition.reshape(-1, 3)
        return np.stack([np.zeros_like(t[:, 0]), t[:, 0], self.orbifold.atlas.inverse[t[:, 2]]], axis=1)

    @cached_property
    def lifts(self) -> Floats:
        """The corners of every triangle in the frame of the patch of its first corner, (F, 3, 3): [face, corner]."""
        g = self.orbifold.atlas.isometry[self.corner_transitions]
        return np.asarray(np.einsum("fcij,fcj->fci", g, self.points[self.polyhedron.triangles]))

    def locate(self, face: Ints, barycentric: Floats) -> Points:
        """The points of X/H at barycentric coordinates (n, 3) in triangles (n,): projective interpolation.

        The lifted corners are combined with the barycentric coordinates and projected to X, so straight segments of a
        triangle become geodesics. Neighbouring triangles agree on their common edge.
        """
        x = np.einsum("nc,nci->ni", barycentric, self.lifts[face])
        return Points(self.patch[self.polyhedron.triangles[face, 0]], self.orbifold.geometry.project(x))

    @cached_property
    def face_signs(self) -> NDArray[np.float64]:
        """+1 or -1 for every triangle, (F,): its orientation in the frame of its first corner, carried from face to
        face through the transitions, so that on a nonorientable surface too a map without a fold has only triangles
        of positive sign times area. Raises MapError where the transitions contradict each other.
        """
        p, count = self.polyhedron, self.polyhedron.face_count
        parity = np.sign(np.linalg.det(self.orbifold.atlas.isometry))
        corner_sign = parity[self.corner_transitions].ravel()
        here = np.arange(len(p.tail))
        there = np.where(p.same, p.twin, p.next[p.twin])
        turned = corner_sign[here] * corner_sign[there] * np.where(p.same, -1, 1) < 0
        a, b = p.face[here], p.face[there]
        shift = np.where(turned, count, 0)
        rows, columns = np.concatenate([a, a + count]), np.concatenate([b + shift, b + count - shift])
        graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(2 * count, 2 * count)).tocsr()
        sheets, label = connected_components(graph, directed=False)
        if sheets != 2:
            raise MapError(
                "the transitions of the map do not reverse orientation as the mesh does: they belong to another "
                "surface; let the group come from the mesh (group.method = 'mesh')"
            )
        sign = np.where(label[:count] == label[0], 1.0, -1.0)
        return sign if float(sign @ np.sign(np.nan_to_num(self._raw_areas))) >= 0 else -sign

    @cached_property
    def _raw_areas(self) -> Floats:
        x = self.lifts
        return self.orbifold.geometry.triangle_area(x[:, 0], x[:, 1], x[:, 2])

    @cached_property
    def areas(self) -> Floats:
        """Signed area of every triangle in X, (F,): all are positive exactly if the map is an embedding.

        The sum is the area of X/H for any map with the right group; if all terms are positive besides, the angle sums
        at the vertices are 2 pi and the map covers X/H once.
        """
        return self.face_signs * self._raw_areas

    @property
    def not_positive(self) -> int:
        """The number of triangles that are folded over or degenerate; 0 for an embedding."""
        return int((~(self.areas > 0)).sum())

    @property
    def area_defect(self) -> float:
        """The sum of the triangle areas against the area of X/H, relative."""
        return float(abs(self.areas.sum() / self.orbifold.area - 1.0))

    @property
    def relation_defect(self) -> float:
        """How far the transitions round a triangle are from the identity: largest entry over all triangles."""
        rows = np.unique(self.transition.reshape(-1, 3), axis=0)
        g = self.orbifold.atlas.isometry[rows]
        return float(np.abs(g[:, 0] @ g[:, 1] @ g[:, 2] - np.eye(3)).max())

    @cached_property
    def angle_distortion(self) -> Floats:
        """The ratio of the singular values of the map on every triangle, (F,); 1 is conformal, inf a collapse.

        The map goes to the flat triangle whose sides are as long as those in X, which prefers none of the corners.
        """
        space = self.polyhedron.vertices[self.polyhedron.triangles]
        u, v = space[:, 1] - space[:, 0], space[:, 2] - space[:, 0]
        image = _flat_triangles(self.orbifold.geometry.distance(self.lifts, np.roll(self.lifts, -1, axis=1)))
        # In an orthonormal basis of the triangle's plane the edges are the columns of an upper triangular matrix.
        length = np.linalg.norm(u, axis=1)
        with np.errstate(all="ignore"):
            along = np.einsum("fi,fi->f", u, v) / length
            height = np.linalg.norm(np.cross(u, v), axis=1) / length
            first = image[..., 0] / length[:, None]
            second = (image[..., 1] - along[:, None] * first) / height[:, None]
            square = (first**2).sum(axis=1) + (second**2).sum(axis=1)
            area = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
            mean = square / (2 * area)
            return np.where(np.isfinite(mean), mean + np.sqrt(np.maximum(mean**2 - 1, 0)), np.inf)


def _flat_triangles(sides: Floats) -> Floats:
    """Corners 1 and 2 seen from corner 0 of flat triangles, (F, 2, 2): [face, axis, corner]; sides: (F, 3), 01, 12, 20.

    The height comes from Heron's formula in the order of Kahan, without cancellation.
    """
    base, opposite, last = sides.T
    c, b, a = np.sort(sides, axis=1).T
    with np.errstate(all="ignore"):
        area = np.sqrt(np.maximum((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c)), 0.0)) / 4
        along = (base + (last - opposite) * (last + opposite) / base) / 2
        return np.stack([np.stack([base, along], axis=1), np.stack([0 * base, 2 * area / base], axis=1)], axis=1)
