"""Samples of a mesh with creases: of every vertex on a crease one for each side of it, with the normals of facets."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.delaunay.crease_domain import crease_triangulation
from orbiframe.functions.arcs import Arcs
from orbiframe.functions.samples import Samples, joined, places
from orbiframe.functions.smooth_samples import lengths
from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.crease_sides import corner_sides, side_normals
from orbiframe.meshes.sizes import vector_areas
from orbiframe.meshes.subdivision import grid_of
from orbiframe.orbifolds.atlas import Points
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.point_location import Locator
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Planes beside a crease hold it: a sample of theirs on it counts so many times.
_ON_CREASE = 12.0
# What may be wrong with an arc, as a share of its height.
_LIFTED = 0.1
# How far inside of a triangle the side of a corner is told, as a share of the triangle.
_INSIDE = 1e-7
# A facet whose arc is higher than this share of the distance of functions stands for something curved.
_SAGITTA = 0.002
# Triangles of the domain with fewer samples get as many more as the square of the density says.
_FEW, _DENSITY = 16, 4


class Sides(NamedTuple):
    """The sides of the vertices of a mesh with creases: the side of each corner (H,), and of each side its vertex (S,),
    whether that lies on a crease (S,), and a point of X/H just inside of the side.
    """

    corner: Ints
    vertex: Ints
    parted: Bools
    points: Points

    @classmethod
    def of(cls, triangulation: Triangulation) -> Sides:
        """The sides of the vertices of a map with creases."""
        mesh, crease = triangulation.polyhedron, triangulation.crease
        assert crease is not None
        side = corner_sides(mesh, crease)
        first = np.unique(side, return_index=True)[1]
        vertex = mesh.tail[first]
        on_crease = np.zeros(len(mesh.vertices), dtype=np.bool_)
        on_crease[mesh.tail[crease]] = on_crease[mesh.head[crease]] = True
        barycentric = np.full((len(first), 3), _INSIDE / 2)
        barycentric[np.arange(len(first)), first % 3] = 1 - _INSIDE
        inside = triangulation.locate(first // 3, barycentric)
        parted = on_crease[vertex]
        patch = np.where(parted, inside.patch, triangulation.patch[vertex])
        x = np.where(parted[:, None], inside.x, triangulation.points[vertex])
        return cls(side, vertex, parted, Points(patch, x))


def crease_samples(
    triangulation: Triangulation, refinement: Bisection, spacing: float, *, curved: Literal["none", "bent", "all"]
) -> Samples:
    """The sides of vertices and the face centroids of a mesh with creases, weighted by area in space.

    Facets that no edge beside the creases bends by more than 3 degrees are flat: their samples have normals and keep
    their parameters. Those of others slide along the surface, but for those on creases. curved: which facets stand for
    something curved: "none", "all", or "bent", those that are bent. Of curved facets the vertices are the truth, and
    edges that do not bend, as those along a cylinder; other samples count the less, the higher the arc over them is
    against the spacing of the functions.
    """
    flat = refinement.polyhedron
    sides, everywhere = Sides.of(triangulation), places(triangulation)
    arcs = Arcs.of(refinement, _of_facets(triangulation.sharp, refinement))
    fine_height, at_side = arcs.height[arcs.facet], np.zeros(len(sides.vertex))
    np.maximum.at(at_side, sides.corner, arcs.over_corners.ravel())
    area = np.linalg.norm(vector_areas(flat), axis=1)
    bent = np.concatenate([_total(sides, np.where(fine_height > 0, area, 0)) > 0, fine_height > 0])
    share = _shares(np.concatenate([at_side, fine_height]) / (_SAGITTA * spacing), curved)
    plain = np.concatenate([_total(sides, area / 12), 0.75 * area])
    weights = share * plain
    weights[: len(sides.vertex)] *= np.where(sides.parted & ~bent[: len(sides.vertex)], _ON_CREASE, 1.0)
    if curved == "bent":
        weights[: len(sides.vertex)] *= np.where(bent[: len(sides.vertex)], 4.0, 1.0)
    if curved != "none":
        weights[: len(sides.vertex)] += _at_given(sides, refinement, area, (fine_height > 0) | (curved == "all"))
    bent |= curved == "all"
    normals = np.concatenate([side_normals(flat, sides.corner), _unit(vector_areas(flat))])
    normals[bent] = np.nan
    values = np.concatenate([flat.vertices[sides.vertex], flat.vertices[flat.triangles].mean(axis=1)])
    if curved == "bent":
        values += _lifts(arcs, sides)
    chosen = np.concatenate([sides.vertex, len(flat.vertices) + np.arange(flat.face_count)])
    long = np.maximum(_lengths_of_facets(triangulation, refinement)[chosen], spacing)
    centroids = slice(len(flat.vertices), None)
    points = Points(
        np.concatenate([sides.points.patch, everywhere.points.patch[centroids]]),
        np.concatenate([sides.points.x, everywhere.points.x[centroids]]),
    )
    samples = Samples(
        points,
        values,
        weights,
        everywhere.stretch[chosen],
        plain,
        np.where(bent, long, spacing),
        2,
        normals=normals,
        still=~bent | np.concatenate([sides.parted, np.zeros(flat.face_count, dtype=np.bool_)]),
    )
    lifted = arcs if curved == "bent" else None
    few = _within_small(triangulation, refinement, samples, bent[len(sides.vertex) :], share, long, lifted)
    samples = joined(samples, few)
    return samples.take(np.flatnonzero((samples.weights > 0) | (samples.shares > 0)))


def _within_small(
    triangulation: Triangulation,
    refinement: Bisection,
    samples: Samples,
    bent: Bools,
    share: Floats,
    long: Floats,
    arcs: Arcs | None,
) -> Samples:
    """More samples in the triangles of the domain that have few: beside corners these are no larger than those of the
    mesh, and some function would reach no sample.
    """
    domain, flat = crease_triangulation(triangulation), refinement.polyhedron
    count = np.bincount(Locator(domain).locate(samples.points).face, minlength=domain.face_count)
    few = np.flatnonzero(count < _FEW)
    grid = grid_of(_DENSITY).mean(axis=1)
    x = domain.geometry.project(np.einsum("kc,fci->fki", grid, domain.corners[few]))
    x = domain.geometry.settle(domain.geometry.act(domain.placement[few][:, None], x)).reshape(-1, 3)
    points = Points(np.repeat(domain.patch[few], len(grid)), x)
    fine = GeodesicTriangulation.of_map(triangulation)
    location = Locator(fine).locate(points)
    face, weights = np.empty(len(x), dtype=np.intp), np.empty((len(x), 3))
    inside = np.linalg.solve(np.swapaxes(fine.corners[location.face], 1, 2), location.columns[:, :, :1])[..., 0]
    face[location.order], weights[location.order] = location.face, inside / inside.sum(axis=1, keepdims=True)
    corners = flat.vertices[flat.triangles[face]]
    stretch = samples.stretch[-flat.face_count :][face]
    area = np.repeat(domain.areas[few], len(grid)) / len(grid) / np.maximum(stretch, np.finfo(float).tiny)
    normals = _unit(vector_areas(flat))[face]
    normals[bent[face]] = np.nan
    first = len(share) - flat.face_count
    values = np.einsum("nc,nci->ni", weights, corners)
    if arcs is not None:
        values += arcs.lifts(face, weights)
    return Samples(
        points,
        values,
        area * share[first:][face],
        stretch,
        area,
        long[first:][face],
        samples.order,
        normals=normals,
        still=~bent[face],
    )


def _lifts(arcs: Arcs, sides: Sides) -> Floats:
    """From all sides of vertices and all centroids to the arcs over them, (S + G, 3)."""
    first, count = np.unique(sides.corner, return_index=True)[1], len(arcs.facet)
    corners, centroids = np.eye(3)[first % 3], np.full((count, 3), 1 / 3)
    return arcs.lifts(np.append(first // 3, np.arange(count)), np.concatenate([corners, centroids]))


def _lengths_of_facets(triangulation: Triangulation, refinement: Bisection) -> Floats:
    return lengths(triangulation, refinement, np.linalg.norm(vector_areas(refinement.facets), axis=1))


def _shares(height: Floats, curved: str) -> Floats:
    """What is left of the weights of samples by the heights of the arcs over them."""
    if curved == "bent":
        return np.asarray(1 / (1 + (_LIFTED * height) ** 2))
    return np.full(len(height), 0.0 if curved == "all" else 1.0)


def crease_of_facets(triangulation: Triangulation, refinement: Bisection) -> Bools:
    """The halfedges of the facets that are creases, (H,), from those of the refined mesh."""
    assert triangulation.crease is not None
    return _of_facets(triangulation.crease, refinement)


def _of_facets(marked: Bools, refinement: Bisection) -> Bools:
    facet, corner = np.divmod(np.arange(len(refinement.facets.tail)), 3)
    barycentric = np.zeros((len(facet), 3))
    barycentric[np.arange(len(facet)), corner] = 0.4375 + 1 / 64 + 1 / 1024
    barycentric[np.arange(len(facet)), (corner + 1) % 3] = 1 - barycentric.max(axis=1)
    fine, weights = replace(refinement, coarse=refinement.facets, log=None).locate(facet, barycentric)
    return np.asarray(marked[3 * fine + (np.abs(weights).argmin(axis=1) + 1) % 3])


def _at_given(sides: Sides, refinement: Bisection, area: Floats, curved: Bools) -> Floats:
    """What the sides of given vertices count for beside curved facets, (S,): a third of the area of those about."""
    facets = refinement.facets
    around = np.bincount(
        facets.tail,
        weights=np.linalg.norm(vector_areas(facets), axis=1)[facets.face] / 3,
        minlength=len(facets.vertices),
    )
    weight, chosen = np.zeros(len(sides.vertex)), np.flatnonzero(sides.vertex < len(refinement.coarse.vertices))
    share = _total(sides, np.where(curved, area, 0.0))
    whole = np.bincount(sides.vertex, weights=_total(sides, area), minlength=int(sides.vertex.max()) + 1)
    vertex = sides.vertex[chosen]
    weight[chosen] = around[vertex] * share[chosen] / np.maximum(whole[vertex], np.finfo(float).tiny)
    return weight


def _total(sides: Sides, of_face: Floats) -> Floats:
    """The sum of a quantity of triangles over those on each side, (S,)."""
    return np.asarray(np.bincount(sides.corner, weights=np.repeat(of_face, 3)), dtype=float)


def _unit(vectors: Floats) -> Floats:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.maximum(length, np.finfo(float).tiny))
