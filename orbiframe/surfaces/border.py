"""Border: the boundary of a surface beside that of its mesh, and how it bends within the surface."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.special import roots_legendre

from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.meshes.loops import boundary_loops
from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.orbifolds.atlas import Points
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.point_location import Locator

if TYPE_CHECKING:
    from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Parts of an edge of the refined mesh that are taken for straight, and points of it for means and integrals.
_PARTS, _GAUSS = 8, 4
_SECTIONS, _GOLDEN = 30, (np.sqrt(5) - 1) / 2


class Border(NamedTuple):
    """How near the boundary of a surface is to that of its mesh, in diagonals: root mean squares and maxima.

    mesh_to_surface, surface_to_mesh and vertices_to_surface: each (rms, max), where the last are the given vertices on
    the boundary; loops: how many there are; length: that of the boundary of the mesh; least_element: the least area of
    the surface at the boundary per area of the mesh there: 1 where the map is as on the mesh, 0 where it folds.
    """

    mesh_to_surface: tuple[float, float]
    surface_to_mesh: tuple[float, float]
    vertices_to_surface: tuple[float, float]
    loops: int
    length: float
    least_element: float | None


def border_of(surface: OrbifoldSurface) -> Border:
    """The border of a surface for a mesh of unit size with a boundary."""
    flat, border = surface.refinement.polyhedron, surface.triangulation.border
    ends = flat.vertices[np.stack([flat.tail[border], flat.head[border]], axis=1)]
    curve = _curve(surface, border)
    nodes, weights = roots_legendre(_GAUSS)
    share = ((1 + nodes) / 2)[:, None]
    samples = ends[:, None, 0] * (1 - share) + ends[:, None, 1] * share
    on_curve, on_mesh = _to_segments(curve.reshape(-1, 2, 3)), _to_segments(ends)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    parts = np.linalg.norm(curve[:, :, 1] - curve[:, :, 0], axis=2)
    given = np.unique(flat.tail[border])
    given = given[given < len(surface.refinement.coarse.vertices)]
    return Border(
        _mean(on_curve.distance(samples.reshape(-1, 3)), (length[:, None] * weights).ravel()),
        _mean(on_mesh.distance(curve.mean(axis=2).reshape(-1, 3)), parts.ravel()),
        _mean(on_curve.distance(flat.vertices[given]), np.ones(len(given))),
        len(boundary_loops(surface.own_mesh)),
        float(length.sum()),
        _least_element(surface, border),
    )


def _curve(surface: OrbifoldSurface, border: Ints) -> Floats:
    """The boundary of the surface before it is placed, as short segments, (b, parts, 2, 3)."""
    at = np.linspace(0, 1, _PARTS + 1)
    points = _along(surface, border, at)
    there = surface.basis.values(points, surface.coefficients).reshape(len(border), _PARTS + 1, 3)
    return np.stack([there[:, :-1], there[:, 1:]], axis=2)


def _along(surface: OrbifoldSurface, border: Ints, at: Floats) -> Points:
    """The points of X/H at shares of halfedges, (b * s,)."""
    rows, face = np.arange(len(border)), border // 3
    barycentric = np.zeros((len(border), len(at), 3))
    barycentric[rows, :, border % 3] = 1 - at
    barycentric[rows, :, (border + 1) % 3] = at
    return surface.triangulation.locate(np.repeat(face, len(at)), barycentric.reshape(-1, 3))


def _to_segments(ends: Floats) -> NearestPoints:
    """Distances to segments, (n, 2, 3): triangles without area."""
    first = 2 * np.arange(len(ends))
    return NearestPoints(Polyhedron.from_faces(ends.reshape(-1, 3), np.stack([first, first + 1, first + 1], axis=1)))


def _mean(away: Floats, weights: Floats) -> tuple[float, float]:
    return float(np.sqrt(weights @ away**2 / weights.sum())), float(away.max())


def _least_element(surface: OrbifoldSurface, border: Ints) -> float | None:
    """See `Border`; the area of the mesh on X is that of its triangles about each vertex. None without derivatives."""
    if not isinstance(surface.basis, DifferentiableBasis):
        return None
    triangulation, flat = surface.triangulation, surface.refinement.polyhedron
    assert triangulation.inside is not None
    area = np.where(triangulation.inside, np.linalg.norm(vector_areas(flat), axis=1), 0)
    image = np.where(triangulation.inside, triangulation.areas, 0)
    around, on_x = (np.bincount(flat.tail, weights=np.repeat(table, 3)) for table in (area, image))
    vertex = np.unique(flat.tail[border])
    d = surface.basis.jets(Points(triangulation.patch[vertex], triangulation.points[vertex]), surface.coefficients, 1)
    element = np.linalg.norm(np.cross(d[1], d[2]), axis=1)
    return float((element * on_x[vertex] / np.maximum(around[vertex], np.finfo(float).tiny)).min())


def inside(surface: OrbifoldSurface, points: Points) -> NDArray[np.bool_]:
    """Which points of X/H belong to the surface, (n,), and do not lie beyond its boundary."""
    found = np.ones(len(points.patch), dtype=np.bool_)
    if surface.triangulation.inside is not None:
        location = Locator(GeodesicTriangulation.of_map(surface.triangulation)).locate(points)
        found[location.order] = surface.triangulation.inside[location.face]
    return found


def nearest_on_border(surface: OrbifoldSurface, targets: Floats) -> tuple[Points, Floats]:
    """The points of the boundary nearest to targets, (n, 3), and their distances, before the surface is placed.

    The two nearest of many points of the boundary, which may lie on two edges, then golden sections about each along
    its edge.
    """
    border, at = surface.triangulation.border, (np.arange(_PARTS) + 0.5) / _PARTS
    tree = cKDTree(surface.basis.values(_along(surface, border, at), surface.coefficients))
    found = [_searched(surface, border, near, targets) for near in np.asarray(tree.query(targets, 2)[1]).T]
    better = found[1][2] < found[0][2]
    halfedges, share, away = (np.where(better, other, one) for one, other in zip(*found, strict=True))
    return _on_edges(surface, halfedges, share), away


def _searched(surface: OrbifoldSurface, border: Ints, near: Ints, targets: Floats) -> tuple[Ints, Floats, Floats]:
    """The nearest points about some of many points of the boundary: the halfedge, the share of it and the distance."""
    edge, part = np.divmod(near, _PARTS)
    middle, halfedges = (part + 0.5) / _PARTS, border[edge]
    low, high = np.maximum(middle - 1 / _PARTS, 0), np.minimum(middle + 1 / _PARTS, 1)
    for _ in range(_SECTIONS):
        left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        nearer = _away(surface, halfedges, left, targets) < _away(surface, halfedges, right, targets)
        low, high = np.where(nearer, low, left), np.where(nearer, right, high)
    share = (low + high) / 2
    return halfedges, share, _away(surface, halfedges, share, targets)


def _on_edges(surface: OrbifoldSurface, halfedges: Ints, share: Floats) -> Points:
    """A point of X/H on each halfedge, (n,)."""
    rows, barycentric = np.arange(len(share)), np.zeros((len(share), 3))
    barycentric[rows, halfedges % 3], barycentric[rows, (halfedges + 1) % 3] = 1 - share, share
    return surface.triangulation.locate(halfedges // 3, barycentric)


def _away(surface: OrbifoldSurface, halfedges: Ints, share: Floats, targets: Floats) -> Floats:
    there = surface.basis.values(_on_edges(surface, halfedges, share), surface.coefficients)
    return np.asarray(np.linalg.norm(there - targets, axis=1))


def turning(surface: OrbifoldSurface, number: int = 4) -> float:
    """By how much the boundary of a surface turns within it: the integral of its geodesic curvature, and its corners.

    Positive where the boundary turns towards the surface, as that of a disc does: 2 pi for a flat one. With the total
    curvature it is 2 pi chi (Gauss and Bonnet; see do Carmo, Differential Geometry of Curves and Surfaces, 4-5). Edges
    of the refined mesh are geodesics of X, along which the covariant Hessian gives second derivatives. number: of Gauss
    points of each.
    """
    border = surface.triangulation.border
    if not len(border):
        return 0.0
    nodes, weights = roots_legendre(number)
    at = np.concatenate([[0.0], (1 + nodes) / 2, [1.0]])
    points = _along(surface, border, at)
    geometry, shape = surface.orbifold.geometry, (len(border), len(at))
    x = points.x.reshape(*shape, 3)
    length = geometry.distance(x[:, 0], x[:, -1])
    # Unit tangents of the geodesics in the frame of each point: towards the end, and at the end away from the start.
    ahead = np.where(
        (np.arange(len(at)) == shape[1] - 1)[:, None], -geometry.log(x, x[:, :1]), geometry.log(x, x[:, -1:])
    )
    frame = geometry.frame(x)
    u = np.stack([geometry.inner(x, ahead, frame[..., k]) for k in range(2)], axis=-1)
    u /= np.linalg.norm(u, axis=-1, keepdims=True)
    d = surface._derivatives(points, 2).reshape(6, *shape, 3)
    first = u[..., :1] * d[1] + u[..., 1:] * d[2]
    second = u[..., :1] ** 2 * d[3] + 2 * u[..., :1] * u[..., 1:] * d[4] + u[..., 1:] ** 2 * d[5]
    normal = np.cross(d[1], d[2]) * surface.triangulation.face_signs[border // 3, None, None]
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    bend = np.einsum("bsi,bsi->bs", normal, np.cross(first, second)) / np.einsum("bsi,bsi->bs", first, first)
    # How far the parameter of the segment runs along the geodesic is no matter of arc length: weights of the chord.
    speed = _speed(surface, border, at[1:-1])
    along = float(((bend[:, 1:-1] * speed) @ (weights / 2)).sum())
    return along + _corners(surface, border, first, normal) if length.min() > 0 else along


def _speed(surface: OrbifoldSurface, border: Ints, at: Floats) -> Floats:
    """The length in X that a point at a share of a halfedge runs per share, (b, s)."""
    lifts, face, corner = surface.triangulation.lifts, border // 3, border % 3
    a, b = lifts[face, corner], lifts[face, (corner + 1) % 3]
    geometry = surface.orbifold.geometry
    c, k = geometry.versine(a, b)[:, None], geometry.curvature
    # p = (1 - t) a + t b has rho^2 = 1 - 2 K t (1 - t) c, and x = p / rho moves at the speed |a ^ b| / rho^2.
    wedge = np.sqrt(np.maximum(2 * c - k * c**2, 0))
    return np.asarray(wedge / (1 - 2 * k * at * (1 - at) * c))


def _corners(surface: OrbifoldSurface, border: Ints, first: Floats, normal: Floats) -> float:
    """The sum of the exterior angles at the vertices of the boundary."""
    mesh = surface.triangulation.polyhedron
    vertex = np.concatenate([mesh.tail[border], mesh.head[border]])
    away = np.concatenate([first[:, 0], -first[:, -1]])
    # Seen along the way away from a vertex, the surface lies on the left, with the normal turned where it does not.
    up = np.concatenate([normal[:, 0], -normal[:, -1]])
    order = np.argsort(vertex, kind="stable").reshape(-1, 2)
    a, b, n = away[order[:, 0]], away[order[:, 1]], up[order[:, 0]]
    angle = np.arctan2(np.einsum("vi,vi->v", n, np.cross(a, b)), np.einsum("vi,vi->v", a, b)) % (2 * np.pi)
    return float((np.pi - angle).sum())
