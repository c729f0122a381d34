"""Sphere: the map of a surface with chi > 0 to S^2 or P^2, by circle packing and Moebius centring."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from orbiframe import Atlas, Geometry, MapError, Orbifold, Polyhedron, Triangulation, surface_type
from orbiframe.groups import MarkedGroup
from orbiframe_parametrizers.advice import advice
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.double_cover import DoubleCover, double_cover
from orbiframe_parametrizers.edge_weights import WEIGHTS
from orbiframe_parametrizers.moebius import centred_caps
from orbiframe_parametrizers.plane_layout import harmonic_layout, packed_layout

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_SMOOTHINGS = 30
_EQUAL = 1e-9


def sphere(
    polyhedron: Polyhedron,
    geometry: Geometry,
    group: MarkedGroup | None = None,
    *,
    weights: Literal["auto", "cotangent", "mean-value", "packing"] = "auto",
) -> Triangulation:
    """The map to S^2, or of a projective plane to P^2 through its double cover.

    One face is taken away and the rest is packed with circles in the plane (Koebe, Andreev, Thurston: possible for
    every triangulation), projected to the sphere and centred by a Moebius map. weights: "cotangent" and "mean-value"
    replace the circle centres by a harmonic map to the plane with one pole, which follows the metric of the mesh;
    "auto" takes the one of the three that has no fold and the smallest median angle distortion. The faces of an
    orientable surface must be oriented alike. The group is the trivial one or the antipodal map, also where it has a
    name. Raises MapError if faces are not oriented alike, if the surface or the named group does not live on the
    geometry, or if no map is an embedding.
    """
    surface = surface_type(polyhedron)
    if surface.euler_characteristic <= 0 or geometry.curvature != 1:
        raise MapError(f"a surface with chi = {surface.euler_characteristic} does not live on {geometry.name}")
    if surface.orientable and polyhedron.same.any():
        raise MapError("the faces of the mesh are not oriented alike; orient them before they are mapped to the sphere")
    if group is not None and group.group.geometry.curvature != 1:
        raise MapError(f"{group.source} does not live on {geometry.name}; set group.method = 'finite'")
    target = _Sphere(polyhedron, geometry) if surface.orientable else _ProjectivePlane(polyhedron, geometry)
    names = ["cotangent", "mean-value", "packing"] if weights == "auto" else [weights]
    made = [target.mapped(name) for name in names]
    embedded = [result for result in made if result is not None and result.not_positive == 0]
    if not embedded:
        attempts = [result for result in made if result is not None]
        raise MapError(f"the map to the sphere has folded triangles; {advice(polyhedron, *attempts)}")
    best = min(embedded, key=lambda result: float(np.median(result.angle_distortion)))
    return best if group is None else replace(best, group=group.source)


@dataclass(frozen=True, eq=False)
class _Sphere:
    mesh: Polyhedron
    geometry: Geometry

    def mapped(self, name: str) -> Triangulation | None:
        points = _spherical(self.mesh, name)
        if points is None:
            return None
        orbifold = Orbifold(_one_patch(self.geometry, np.eye(3)[None]), 2, True, 4 * np.pi)
        patch, transition = (np.zeros(n, dtype=np.intp) for n in (len(points), len(self.mesh.tail)))
        return Triangulation(orbifold, self.mesh, patch, points, transition, "trivial", name)


@dataclass(frozen=True, eq=False)
class _ProjectivePlane:
    mesh: Polyhedron
    geometry: Geometry

    def mapped(self, name: str) -> Triangulation | None:
        cover = double_cover(self.mesh)
        points = _spherical(cover.polyhedron, name)
        if points is None:
            return None
        # The centring is unique, so that the sheets are antipodal up to rounding and the choice of the face.
        points = self.geometry.project(points - points[cover.mate])
        atlas = _one_patch(self.geometry, np.stack([np.eye(3), -np.eye(3)]))
        patch = np.zeros(len(self.mesh.vertices), dtype=np.intp)
        orbifold = Orbifold(atlas, 1, False, 2 * np.pi)
        transition = _sheet_changes(cover)
        return Triangulation(orbifold, self.mesh, patch, points[cover.chosen], transition, "antipodal map", name)


def _sheet_changes(cover: DoubleCover) -> Ints:
    """1 on the halfedges (H,) whose ends lie over different sheets of chosen points, else 0."""
    is_chosen = np.zeros(len(cover.below), dtype=np.bool_)
    is_chosen[cover.chosen] = True
    return np.asarray(is_chosen[cover.tail] != is_chosen[cover.head], dtype=np.intp)


def _one_patch(geometry: Geometry, isometry: Floats) -> Atlas:
    count = len(isometry)
    ends = np.zeros(count, dtype=np.intp)
    ends[0] = -1
    return Atlas(geometry, np.array([np.pi]), ends, ends, np.arange(count), isometry)


def _spherical(mesh: Polyhedron, name: str) -> Floats | None:
    """The vertices on the unit sphere, (V, 3), or None where degenerate or crowded triangles leave no way."""
    size = np.linalg.norm(_normals(mesh), axis=1)
    areas = np.zeros(len(mesh.vertices))
    np.add.at(areas, mesh.tail, np.repeat(size, 3))
    try:
        z, radii = _planar(mesh, name, _hole(mesh, size))
        if not (np.isfinite(z).all() and areas.any()):
            return None
        points = centred_caps(z, radii, areas)
    except MapError:
        return None
    return points if name == "packing" else _unfolded(mesh, points)


def _hole(mesh: Polyhedron, size: Floats) -> int:
    """The largest face; of equals the one whose centre comes first, so that the order of the faces does not matter."""
    largest = np.flatnonzero(size >= (1 - _EQUAL) * size.max())
    centre = mesh.vertices[mesh.triangles[largest]].mean(axis=1)
    squares = np.round(centre / (_EQUAL * (mesh.diagonal or 1.0)))
    return int(largest[np.lexsort(squares.T[::-1])[0]])


def _planar(mesh: Polyhedron, name: str, hole: int) -> tuple[NDArray[np.complex128], Floats]:
    """Circles in the plane: centres (V,), nan where the weights are not finite, and radii (V,), 0 for points."""
    if name == "packing":
        packing = packed(mesh, 0, without_face=hole)
        return packed_layout(mesh, packing.angles, hole), packing.radii
    weights, none = WEIGHTS[name](mesh), np.zeros(len(mesh.vertices))
    if not np.isfinite(weights).all():
        return np.full(len(none), np.nan, dtype=np.complex128), none
    return harmonic_layout(mesh, weights, hole), none


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
