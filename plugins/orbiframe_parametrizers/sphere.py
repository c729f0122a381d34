"""Sphere: the map of a surface with chi > 0 to S^2 or P^2, by circle packing and Moebius centring."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from orbiframe import Atlas, Geometry, MapError, Orbifold, Polyhedron, Triangulation, surface_type
from orbiframe.groups import MarkedGroup
from orbiframe.triangulations import crowding_of
from orbiframe_parametrizers.advice import CROWDED, advice
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.crowded_sphere import medoid_face, patched_sphere
from orbiframe_parametrizers.developing import with_patch_radii
from orbiframe_parametrizers.double_cover import DoubleCover, double_cover
from orbiframe_parametrizers.edge_weights import WEIGHTS
from orbiframe_parametrizers.moebius import Centred, centred_caps
from orbiframe_parametrizers.plane_layout import Layout, harmonic_layout, packed_layout

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_SMOOTHINGS = 30
_EQUAL = 1e-9
_CROWDED = 8.0  # digits lost in one patch, from which on a map in many is better


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
    "auto" takes the one of the three that has no fold and the smallest median angle distortion. Where thin limbs would
    be crowded into fewer digits than a double has, the pole is the face in the middle of the mesh, and the map is one
    in patches that shrink with its scale. The faces of an
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
    attempts = [result for name in names if (result := target.mapped(name)) is not None]
    best = _least_distorted(attempts)
    if isinstance(target, _Sphere) and (best is None or crowding_of(best).digits_lost > _CROWDED):
        attempts += [result for name in names if (result := target.in_patches(name)) is not None]
        best = _least_distorted([result for result in attempts if result.orbifold.atlas.patch_count > 1]) or best
    if best is None:
        raise MapError(f"no map to the sphere without a fold was found; {advice(polyhedron, *attempts)}")
    return best if group is None else replace(best, group=group.source)


def _least_distorted(attempts: Sequence[Triangulation]) -> Triangulation | None:
    """The map with the least median angle distortion of those without a fold, None for none.

    One that has lost 13 digits comes after all others.
    """
    embedded = [result for result in attempts if result.not_positive == 0]

    def rank(result: Triangulation) -> tuple[bool, float]:
        return crowding_of(result).digits_lost >= CROWDED, float(np.median(result.angle_distortion))

    return min(embedded, key=rank, default=None)


@dataclass(frozen=True, eq=False)
class _Sphere:
    mesh: Polyhedron
    geometry: Geometry

    def mapped(self, name: str) -> Triangulation | None:
        """The map in one patch, with the largest face as pole."""
        points = _spherical(self.mesh, name, self.geometry)
        return None if points is None else _in_one_patch(self.mesh, self.geometry, points, name)

    def in_patches(self, name: str) -> Triangulation | None:
        """The map in patches that shrink with its scale, with the face in the middle as pole."""
        try:
            layout, centred = _centred(self.mesh, name, medoid_face(self.mesh))
            made = patched_sphere(self.mesh, self.geometry, layout, centred)
        except MapError:
            return None
        return with_patch_radii(replace(made, points=_unfolded(made), weights=name))


@dataclass(frozen=True, eq=False)
class _ProjectivePlane:
    mesh: Polyhedron
    geometry: Geometry

    def mapped(self, name: str) -> Triangulation | None:
        cover = double_cover(self.mesh)
        points = _spherical(cover.polyhedron, name, self.geometry)
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


def _in_one_patch(mesh: Polyhedron, geometry: Geometry, points: Floats, name: str) -> Triangulation:
    """The map that takes the vertices of a sphere to such points (V, 3) of S^2."""
    orbifold = Orbifold(_one_patch(geometry, np.eye(3)[None]), 2, True, 4 * np.pi)
    patch, transition = (np.zeros(n, dtype=np.intp) for n in (len(points), len(mesh.tail)))
    return Triangulation(orbifold, mesh, patch, points, transition, "trivial", name)


def _spherical(mesh: Polyhedron, name: str, geometry: Geometry) -> Floats | None:
    """The vertices on the unit sphere, (V, 3), or None where degenerate or crowded triangles leave no way."""
    try:
        _, centred = _centred(mesh, name, _largest_face(mesh))
    except MapError:
        return None
    points = centred.centres
    return points if name == "packing" else _unfolded(_in_one_patch(mesh, geometry, points, name))


def _centred(mesh: Polyhedron, name: str, hole: int) -> tuple[Layout, Centred]:
    """The mesh without one face in the plane, and on the sphere, balanced. Raises MapError where there is none."""
    areas = np.zeros(len(mesh.vertices))
    np.add.at(areas, mesh.tail, np.repeat(_double_areas(mesh), 3))
    layout, radii = _planar(mesh, name, hole)
    if not (np.isfinite(layout.z).all() and areas.any()):
        raise MapError("the mesh has no layout in the plane")
    return layout, centred_caps(layout.z, radii, areas)


def _largest_face(mesh: Polyhedron) -> int:
    """The largest face; of equals the one whose centre comes first, so that the order of the faces does not matter."""
    size = _double_areas(mesh)
    largest = np.flatnonzero(size >= (1 - _EQUAL) * size.max())
    centre = mesh.vertices[mesh.triangles[largest]].mean(axis=1)
    squares = np.round(centre / (_EQUAL * (mesh.diagonal or 1.0)))
    return int(largest[np.lexsort(squares.T[::-1])[0]])


def _planar(mesh: Polyhedron, name: str, hole: int) -> tuple[Layout, Floats]:
    """Circles in the plane: centres, nan where the weights are not finite, and radii (V,), 0 for points."""
    if name == "packing":
        packing = packed(mesh, 0, without_face=hole)
        return packed_layout(mesh, packing.angles, hole), packing.radii
    weights, none = WEIGHTS[name](mesh), np.zeros(len(mesh.vertices))
    if not np.isfinite(weights).all():
        return Layout(np.full(len(none), np.nan, dtype=np.complex128), np.zeros(0, dtype=np.complex128)), none
    return harmonic_layout(mesh, weights, hole), none


def _unfolded(made: Triangulation) -> Floats:
    """The points without the folds that occur beside the pole: means of neighbours on and around them."""
    mesh, geometry = made.polyhedron, made.orbifold.geometry
    isometry = made.orbifold.atlas.isometry[made.transition]
    weights = WEIGHTS["mean-value"](mesh)
    near = np.zeros(len(made.points), dtype=np.bool_)
    for _ in range(_SMOOTHINGS):
        folded = ~(geometry.triangle_area(*np.moveaxis(made.lifts, 1, 0)) > 0)
        if not folded.any():
            break
        near[mesh.triangles[folded]] = True
        for _ in range(2):
            near[mesh.triangles[near[mesh.triangles].any(axis=1)]] = True
        moved = np.flatnonzero(near[mesh.tail])
        mean = np.zeros_like(made.points)
        heads = geometry.act(isometry[moved], made.points[mesh.head[moved]])
        np.add.at(mean, mesh.tail[moved], weights[moved, None] * heads)
        length = np.linalg.norm(mean, axis=1, keepdims=True)
        points = np.where(near[:, None] & (length > 0), mean / np.where(length > 0, length, 1.0), made.points)
        made = replace(made, points=points)
    return made.points


def _double_areas(mesh: Polyhedron) -> Floats:
    """Twice the areas of the triangles in space, (F,)."""
    p = mesh.vertices[mesh.triangles]
    return np.asarray(np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1))
