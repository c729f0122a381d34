"""Sites spread over X/H: by chance, apart from one another by chance, or evenly by Lloyd's steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.delaunay.site_triangulation import SiteTriangulation, delaunay, delaunay_of_vertices
from orbiframe.delaunay.voronoi import circumcentres, circumradii, kites
from orbiframe.errors import MapError
from orbiframe.orbifolds.atlas import Points
from orbiframe.planes.quadrature import triangle_points, triangle_rule
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Points of a triangle with longer edges are drawn from its refinement: few of them would be taken otherwise.
_LONG = 1.0


def vertex_points(triangulation: GeodesicTriangulation) -> Points:
    """The vertices of a triangulation as points of X/H, in the order of their numbers."""
    face, corner = np.divmod(triangulation.vertex_corner, 3)
    return _placed(triangulation, face, triangulation.corners[face, corner])


def uniform_points(triangulation: GeodesicTriangulation, count: int, seed: int = 0) -> Points:
    """`count` points of X/H, independent and uniform in area.

    Triangles are drawn by area; in a triangle flat points p are drawn and kept with a chance that goes like the area
    element rho(p)^-3 over the triangle, where rho(p) is the length of p in the form of X.
    """
    fine = triangulation
    while fine.edge_lengths.max() > _LONG and fine.geometry.curvature:
        fine = fine.refined()
    rng = np.random.default_rng(seed)
    face = np.sort(rng.choice(fine.face_count, size=count, p=fine.areas / fine.areas.sum()))
    x, waiting = np.empty((count, 3)), np.arange(count)
    while len(waiting):
        flat = np.einsum("nc,nci->ni", rng.dirichlet(np.ones(3), len(waiting)), fine.corners[face[waiting]])
        taken = rng.random(len(waiting)) < _relative_density(fine, face[waiting], flat)
        x[waiting[taken]] = fine.geometry.project(flat[taken])
        waiting = waiting[~taken]
    return _placed(fine, face, x)


def poisson_disc(triangulation: GeodesicTriangulation, radius: float, seed: int = 0) -> GeodesicTriangulation:
    """The Delaunay triangulation of random sites that are `radius` apart and leave no room for one more.

    No two sites are nearer than the radius, and no point of X/H is farther than the radius from all of them. Points
    drawn by chance are thinned: the nearest site is always a neighbour, so that one looks at edges only; then the
    centres of the empty circles that are left are filled in, again by chance. On the sphere and the projective plane
    the radius must leave room for sites in every half. Raises MapError for a radius that is not positive.
    """
    if not radius > 0:
        raise MapError(f"the sites are to be {radius} apart; give a positive radius")
    rng = np.random.default_rng(seed)
    count = 16 + int(2 * triangulation.orbifold.area / radius**2)
    sites = delaunay(triangulation, uniform_points(triangulation, count, seed)).triangulation
    sites = _thinned(sites, rng.permutation(sites.vertex_count), radius)
    while len(wide := np.flatnonzero(circumradii(sites) > radius * (1 + 1e-9))):
        old, new = vertex_points(sites), _placed(sites, wide, circumcentres(sites)[wide])
        rank = np.concatenate([np.full(len(old.patch), -1), rng.permutation(len(wide))])
        sites = _joined(sites, old, new, rank, radius)
    return sites


def lloyd(triangulation: GeodesicTriangulation, steps: int = 1, density: ArrayLike = 1.0) -> GeodesicTriangulation:
    """Every vertex moved to the centroid of its Voronoi region, `steps` times: the sites become more even.

    The centroid m of a region lies on the ray of the integral of x over it, which makes the integral of the versine
    c(x, m) least: 1 - cos d, d^2 / 2 or cosh d - 1. density: a weight, or one for every vertex, (V,), linear over the
    triangles; sites come to lie as its fourth root. A vertex goes only so far that all triangles stay positive.
    """
    weight = np.broadcast_to(np.asarray(density, dtype=np.float64), triangulation.vertex_count)
    current = delaunay_of_vertices(triangulation)
    for _ in range(steps):
        current = lloyd_step(current, weight)
    return current.triangulation


def lloyd_step(current: SiteTriangulation, density: ArrayLike = 1.0, fixed: ArrayLike = False) -> SiteTriangulation:
    """A step of Lloyd of the sites of a Delaunay triangulation, of which some are fixed, (n,); density: (n,), as above.

    The numbers of sites stay.
    """
    count = len(current.vertex)
    weight, still = np.empty(count), np.empty(count, dtype=np.bool_)
    weight[current.vertex], still[current.vertex] = density, fixed
    domain = current.triangulation
    target = _centroids(domain, weight)
    here = domain.corners.reshape(-1, 3)[domain.vertex_corner]
    after = delaunay_of_vertices(_towards(domain, np.where(still[:, None], here, target)))
    return SiteTriangulation(after.triangulation, after.vertex[current.vertex])


def _placed(triangulation: GeodesicTriangulation, face: Ints, x: Floats) -> Points:
    """Points in the frames of triangles, as points of X/H."""
    geometry = triangulation.geometry
    return Points(triangulation.patch[face], geometry.settle(geometry.act(triangulation.placement[face], x)))


def _relative_density(triangulation: GeodesicTriangulation, face: Ints, flat: Floats) -> Floats:
    """rho(p)^-3 over its largest value on the triangle, for flat points p.

    In H^2 rho is least, 1, at the corners; on S^2 it is at least the distance of the plane of the corners.
    """
    k = triangulation.geometry.curvature
    if not k:
        return np.ones(len(face))
    rho = np.sqrt(flat[:, 0] ** 2 + k * (flat[:, 1] ** 2 + flat[:, 2] ** 2))
    if k < 0:
        return np.asarray(rho**-3)
    x = triangulation.corners[face]
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    height = np.abs(np.einsum("ni,ni->n", normal, x[:, 0])) / np.linalg.norm(normal, axis=1)
    return np.asarray((height / rho) ** 3)


def _thinned(sites: GeodesicTriangulation, rank: Ints, radius: float) -> GeodesicTriangulation:
    """Without sites that are nearer than the radius to one of lower rank, until no edge is shorter."""
    while True:
        tail, head = sites.vertex.ravel(), np.roll(sites.vertex, -1, axis=1).ravel()
        short = (sites.edge_lengths < radius) & (rank[tail] != rank[head])
        later = np.where(rank[tail] > rank[head], tail, head)
        if not short.any():
            return sites
        kept = np.setdiff1d(np.arange(len(rank)), later[short])
        thinner = delaunay_of_vertices(sites, kept)
        inherited = np.empty(len(kept), dtype=np.intp)
        inherited[thinner.vertex] = rank[kept]
        sites, rank = thinner.triangulation, inherited


def _joined(sites: GeodesicTriangulation, old: Points, new: Points, rank: Ints, radius: float) -> GeodesicTriangulation:
    """Sites with new ones between them, thinned by rank."""
    both = Points(np.concatenate([old.patch, new.patch]), np.concatenate([old.x, new.x]))
    dense = delaunay(sites, both)
    by_vertex = np.empty_like(rank)
    by_vertex[dense.vertex] = rank
    return _thinned(dense.triangulation, by_vertex, radius)


def _centroids(triangulation: GeodesicTriangulation, density: Floats) -> Floats:
    """The centroid of every Voronoi region, in the frame of the reference corner of its vertex, (V, 3).

    Where the density changes so much within a region with obtuse triangles that no centroid is found, the vertex
    itself.
    """
    geometry, parts = triangulation.geometry, kites(triangulation)
    flat = parts.reshape(-1, 3, 3)
    x, area = triangle_points(geometry, flat, 2)
    area *= np.sign(geometry.triangle_area(flat[:, 0], flat[:, 1], flat[:, 2]))[:, None]
    area *= _linear(density[triangulation.vertex]).reshape(-1, 3) @ triangle_rule(2)[0].T
    moment = np.einsum("tq,tqi->ti", area, x).reshape(-1, 3, 2, 3).sum(axis=2)
    home = geometry.act(geometry.inverse(triangulation.corner_frame), moment).reshape(-1, 3)
    vertex = triangulation.vertex.ravel()
    total = np.stack([np.bincount(vertex, weights=home[:, i]) for i in range(3)], axis=1)
    rim = np.hypot(total[:, 1], total[:, 2]) if geometry.curvature < 0 else 0.0
    here = triangulation.corners.reshape(-1, 3)[triangulation.vertex_corner]
    return geometry.project(np.where((total[:, 0] > rim)[:, None], total, here))


def _linear(value: Floats) -> Floats:
    """Values at the corners of triangles (F, 3), carried to the points of their kites, (F, 3, 2, 3)."""
    middle = (value + np.roll(value, -1, axis=1)) / 2
    centre = np.broadcast_to(value.mean(axis=1)[:, None], value.shape)
    first = np.stack([value, middle, centre], axis=-1)
    return np.stack([first, np.stack([value, centre, np.roll(middle, 1, axis=1)], axis=-1)], axis=2)


def _towards(triangulation: GeodesicTriangulation, target: Floats) -> GeodesicTriangulation:
    """Vertices moved to their targets, or as far on the way as keeps all triangles positive."""
    geometry, vertex = triangulation.geometry, triangulation.vertex
    face, corner = np.divmod(triangulation.vertex_corner, 3)
    start, share = triangulation.corners[face, corner], np.ones(len(target))
    while True:
        x = geometry.geodesic(start, target, share)
        moved = replace(triangulation, corners=geometry.settle(geometry.act(triangulation.corner_frame, x[vertex])))
        bad = moved.areas <= 0
        if not bad.any():
            return moved
        share[vertex[bad]] *= np.where(share[vertex[bad]] > 1e-3, 0.5, 0.0)
