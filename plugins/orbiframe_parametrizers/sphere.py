"""Sphere: the map of a surface with chi > 0 to S^2 or P^2, by circle packing and Moebius centring."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from orbiframe import Atlas, Geometry, MapError, Orbifold, Polyhedron, Triangulation, surface_type
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.double_cover import DoubleCover, double_cover
from orbiframe_parametrizers.edge_weights import WEIGHTS
from orbiframe_parametrizers.moebius import centred_caps
from orbiframe_parametrizers.plane_layout import harmonic_layout, packed_layout

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_SMOOTHINGS = 30


def sphere(
    polyhedron: Polyhedron,
    geometry: Geometry,
    group: object | None = None,
    *,
    weights: Literal["auto", "cotangent", "mean-value", "packing"] = "auto",
) -> Triangulation:
    """The map to S^2, or of a projective plane to P^2 through its double cover.

    One face is taken away and the rest is packed with circles in the plane (Koebe, Andreev, Thurston: possible for
    every triangulation), projected to the sphere and centred by a Moebius map. weights: "cotangent" and "mean-value"
    replace the circle centres by a harmonic map to the plane with one pole, which follows the metric of the mesh;
    "auto" takes the one of the three that has no fold and the smallest median angle distortion. Raises MapError if
    none is an embedding.
    """
    surface = surface_type(polyhedron)
    if surface.euler_characteristic <= 0 or geometry.curvature != 1:
        raise MapError(f"a surface with chi = {surface.euler_characteristic} does not live on {geometry.name}")
    if group is not None:
        raise MapError("the map to the sphere takes no group; leave it out (group.method = 'mesh')")
    target = _Sphere(polyhedron, geometry) if surface.orientable else _ProjectivePlane(polyhedron, geometry)
    names = ["cotangent", "mean-value", "packing"] if weights == "auto" else [weights]
    made = [result for name in names for result in target.attempts(name)]
    embedded = [result for result in made if result.not_positive == 0]
    if not embedded:
        raise MapError(
            "the map to the sphere has folded triangles: parts of the mesh are too long and thin for double precision; "
            "shorten them, or refine the mesh (map.vertices)"
        )
    return min(embedded, key=lambda result: float(np.median(result.angle_distortion)))


@dataclass(frozen=True, eq=False)
class _Sphere:
    mesh: Polyhedron
    geometry: Geometry

    def attempts(self, name: str) -> Iterator[Triangulation]:
        points = _spherical(self.mesh, name)
        if points is not None:
            atlas = _one_patch(self.geometry, np.eye(3)[None])
            patch, transition = (np.zeros(n, dtype=np.intp) for n in (len(points), len(self.mesh.tail)))
            orbifold = Orbifold(atlas, 2, True, 4 * np.pi)
            yield Triangulation(orbifold, self.mesh, patch, points, transition, "trivial", name)


@dataclass(frozen=True, eq=False)
class _ProjectivePlane:
    mesh: Polyhedron
    geometry: Geometry

    def attempts(self, name: str) -> Iterator[Triangulation]:
        cover = double_cover(self.mesh)
        points = _spherical(cover.polyhedron, name)
        if points is None:
            return
        # The centring is unique, so that the sheets are antipodal up to rounding and the choice of the face.
        points = self.geometry.project(points - points[cover.mate])
        atlas = _one_patch(self.geometry, np.stack([np.eye(3), -np.eye(3)]))
        patch = np.zeros(len(self.mesh.vertices), dtype=np.intp)
        orbifold = Orbifold(atlas, 1, False, 2 * np.pi)
        transition = _sheet_changes(cover)
        yield Triangulation(orbifold, self.mesh, patch, points[cover.chosen], transition, "antipodal map", name)


def _sheet_changes(cover: DoubleCover) -> Ints:
    """1 on the halfedges (H,) whose ends lie over different sheets of chosen points, else 0."""
    return (cover.tail != cover.chosen[cover.below[cover.tail]]).astype(np.intp) ^ (
        cover.head != cover.chosen[cover.below[cover.head]]
    ).astype(np.intp)


def _one_patch(geometry: Geometry, isometry: Floats) -> Atlas:
    count = len(isometry)
    ends = np.zeros(count, dtype=np.intp)
    ends[0] = -1
    return Atlas(geometry, np.array([np.pi]), ends, ends, np.arange(count), isometry)


def _spherical(mesh: Polyhedron, name: str) -> Floats | None:
    """The vertices on the unit sphere, (V, 3), or None where the weights are not finite."""
    normals = _normals(mesh)
    size = np.linalg.norm(normals, axis=1)
    hole = int(np.argmax(size))
    if name == "packing":
        packing = packed(mesh, 0, without_face=hole)
        z, radii = packed_layout(mesh, packing.angles, hole), packing.radii
    else:
        weights = WEIGHTS[name](mesh)
        if not np.isfinite(weights).all():
            return None
        z, radii = harmonic_layout(mesh, weights, hole), np.zeros(len(mesh.vertices))
    areas = np.bincount(mesh.tail, weights=np.repeat(size, 3), minlength=len(z))
    points = centred_caps(z, radii, areas)
    return points if name == "packing" else _unfolded(mesh, points)


def _unfolded(mesh: Polyhedron, points: Floats) -> Floats:
    """The points with folds smoothed away, as they occur beside the pole: means of neighbours on and around folds."""
    weights = WEIGHTS["mean-value"](mesh)
    near = np.zeros(len(points), dtype=np.bool_)
    for _ in range(_SMOOTHINGS):
        corners = points[mesh.triangles]
        folded = np.linalg.det(corners) <= 0
        if not folded.any():
            break
        near[mesh.triangles[folded]] = True
        for _ in range(2):
            near[mesh.triangles[near[mesh.triangles].any(axis=1)]] = True
        moved = np.flatnonzero(near[mesh.tail])
        mean = np.zeros_like(points)
        np.add.at(mean, mesh.tail[moved], weights[moved, None] * points[mesh.head[moved]])
        length = np.linalg.norm(mean, axis=1, keepdims=True)
        points = np.where(near[:, None] & (length > 0), mean / np.where(length > 0, length, 1.0), points)
    return points


def _normals(mesh: Polyhedron) -> Floats:
    p = mesh.vertices[mesh.triangles]
    return np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
