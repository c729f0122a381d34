"""Creased domain: the plane regions between creases, and every other triangle of the functions as three quads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe import OrbifoldSurface
from orbiframe.splines import ElementBasis
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe_exact.quad_domain import QuadDomain
from orbiframe_exact.quad_points import QuadPoints
from orbiframe_exact.thirds import thirds

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# A region is plane if it leaves its plane by no more than this share of the tolerance, and turns by no more degrees.
_FLAT, _TURN = 0.1, 1.0
# Planes that meet at less, as a sine, have no common line.
_SAME_PLANE = 0.02
# The side of a crease is told so far inside of a quadrilateral.
_INSIDE = 1e-6
_LOOK = np.array([0.0, 0.5, 1.0])


@dataclass(frozen=True, eq=False)
class OneSidedPoints(QuadPoints):
    """Derivatives at borders of quadrilaterals are those of their own side: they may jump there."""

    def jets(self, quad: Ints, s: Floats, t: Floats, order: int) -> list[Floats]:
        """See `QuadPoints`."""
        values = super().jets(quad, s, t, 0)
        if not order:
            return values
        s, t = (np.clip(x, _INSIDE, 1 - _INSIDE) for x in (s, t))
        return values + super().jets(quad, s, t, order)[1:]


class Planes(NamedTuple):
    """Plane regions: the plane of each, normal (P, 3) and offset (P,), as its triangles are seen; region: (F,), the
    number of the plane of every triangle, -1 for one that is curved; border: (3 F,), the halfedges where a plane ends.
    """

    normal: Floats
    offset: Floats
    region: Ints
    border: Bools

    @property
    def number(self) -> int:
        """How many planes there are."""
        return len(self.offset)


@dataclass(frozen=True, eq=False)
class CreasedDomain(QuadDomain):
    """The quadrilaterals of curved triangles, three each, and the planes of the others.

    Vertices are those of the triangulation, the middles of its edges, and the centroids of its triangles; an edge of
    the triangulation is halved. at_plane: (E,), the plane beside an edge, -1 for none; smooth_edge: (E,), those that
    are no creases. half: (2 E', ), the edge of every half of an edge of the triangulation, the one at the start of its
    reference halfedge first, -1 for one between planes. places: (V, 3), those of all vertices, on their planes.
    """

    planes: Planes
    half: Ints
    at_plane: Ints
    smooth_edge: Bools
    places: Floats

    @property
    def group_of_faces(self) -> Ints:
        """The planes, and every curved triangle three times."""
        return np.concatenate([np.arange(self.planes.number), np.repeat(self.pair[self.planes.region < 0], 3)])

    @property
    def smooth(self) -> Bools:
        """The edges at which two faces are to have common tangent planes, (E,)."""
        return self.smooth_edge


def creased_domain(surface: OrbifoldSurface, tolerance: float) -> CreasedDomain:
    """The faces of a surface with creases: a plane for every plane region, three quadrilaterals for other triangles.

    tolerance: of the faces, of which a plane region may use a tenth. On a nonorientable surface no region is plane.
    """
    basis = surface.basis
    assert isinstance(basis, ElementBasis)
    d = basis.domain
    corners, edge, ends = thirds(d, d.corners)
    points = OneSidedPoints(surface, corners, np.repeat(d.patch, 3), np.repeat(d.placement, 3, axis=0))
    planes = _planes(points, d, _FLAT * tolerance, surface.orbifold.orientable and not d.same.any())
    curved = np.repeat(planes.region < 0, 3)
    used, number = np.unique(edge[curved], return_inverse=True)
    halves = 2 * d.edge_count
    along = np.zeros(len(ends), dtype=np.bool_)
    along[halves:] = True
    halfedge, plane = np.arange(3 * d.face_count), np.full(len(ends), -1)
    along[2 * d.edge] = along[2 * d.edge + 1] = ~d.sharp
    flat = halfedge[planes.region[halfedge // 3] >= 0]
    plane[2 * d.edge[flat]] = plane[2 * d.edge[flat] + 1] = planes.region[flat // 3]
    half = np.full(len(ends), -1)
    half[used] = np.arange(len(used))
    group = np.where(planes.region < 0, planes.number + np.cumsum(planes.region < 0) - 1, planes.region)
    return CreasedDomain(
        _subset(points, curved),
        number.reshape(-1, 4),
        np.ones((int(curved.sum()), 4), dtype=np.bool_),
        ends[used],
        surface.orbifold.orientable,
        d,
        group,
        None,
        True,
        planes,
        half[:halves],
        plane[used],
        along[used],
        _places(points, d, planes),
    )


def _subset(points: OneSidedPoints, which: Bools) -> OneSidedPoints:
    return OneSidedPoints(points.surface, points.corners[which], points.patch[which], points.placement[which])


def _planes(points: OneSidedPoints, d: GeodesicTriangulation, sag: float, orientable: bool) -> Planes:
    """The regions between creases that are plane; of two in one plane side by side only one."""
    open_edges = np.flatnonzero(~d.creased)
    links = coo_array((np.ones(len(open_edges)), (open_edges // 3, d.twin[open_edges] // 3)), (d.face_count,) * 2)
    count, region = connected_components(links, directed=False)
    s, t = (x.ravel() for x in np.meshgrid(_LOOK, _LOOK))
    quad = np.repeat(np.arange(3 * d.face_count), len(s))
    where, fs, ft = points.jets(quad, np.tile(s, 3 * d.face_count), np.tile(t, 3 * d.face_count), 1)
    across = np.cross(fs, ft)
    owner = np.repeat(region, 3 * len(s))
    normal, offset, good = np.zeros((count, 3)), np.zeros(count), np.zeros(count, dtype=np.bool_)
    order = np.argsort(owner, kind="stable")
    for r, own in enumerate(np.split(order, np.searchsorted(owner[order], np.arange(1, count)))):
        centre = where[own].mean(axis=0)
        n = np.linalg.svd(where[own] - centre, full_matrices=False)[2][2]
        n = n if n @ across[own].sum(axis=0) > 0 else -n
        normal[r], offset[r] = n, n @ centre
        cosine = across[own] @ n / np.maximum(np.linalg.norm(across[own], axis=1), np.finfo(float).tiny)
        good[r] = np.abs((where[own] - centre) @ n).max() <= sag and cosine.min() >= np.cos(np.radians(_TURN))
    good &= orientable
    here, there = region[np.arange(3 * d.face_count) // 3], region[d.twin // 3]
    for a, b in zip(here.tolist(), there.tolist(), strict=True):
        if a != b and good[a] and good[b] and np.linalg.norm(np.cross(normal[a], normal[b])) < _SAME_PLANE:
            good[b] = False
    number = np.where(good, np.cumsum(good) - 1, -1)
    return Planes(normal[good], offset[good], number[region], good[here] & (here != there))


def _places(points: OneSidedPoints, d: GeodesicTriangulation, planes: Planes) -> Floats:
    """Where all vertices lie: on the surface, and as near to that as can be on the planes that they belong to."""
    count = d.vertex_count + d.edge_count + d.face_count
    face, c = np.divmod(np.arange(3 * d.face_count), 3)
    quad = 3 * face + c
    zero, one = np.zeros(len(quad)), np.ones(len(quad))
    own = (d.vertex.ravel(), d.vertex_count + d.edge, d.vertex_count + d.edge_count + face)
    found = np.empty((count, 3))
    for vertex, s, t in zip(own, (zero, one, one), (zero, zero, one), strict=True):
        found[vertex] = points.jets(quad, s, t, 0)[0]
    region = planes.region[face]
    on = np.unique(np.concatenate([np.stack([v, region], axis=1)[region >= 0] for v in own[:2]]), axis=0)
    at, first = np.unique(on[:, 0], return_index=True)
    for vertex, mine in zip(at.tolist(), np.split(on[:, 1], first)[1:], strict=True):
        lacks = planes.offset[mine] - planes.normal[mine] @ found[vertex]
        found[vertex] += np.linalg.pinv(planes.normal[mine], rcond=_SAME_PLANE / 2) @ lacks
    return found
