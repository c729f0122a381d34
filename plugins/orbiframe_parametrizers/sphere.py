"""Sphere: the map of a surface with chi > 0 to S^2 or P^2, by circle packing and Moebius centring."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array

from orbiframe import Atlas, Geometry, MapError, Orbifold, Polyhedron, Triangulation, surface_type
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.double_cover import DoubleCover, double_cover
from orbiframe_parametrizers.edge_weights import WEIGHTS
from orbiframe_parametrizers.moebius import centred_caps
from orbiframe_parametrizers.nested_dissection import dissection_order, factorised

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def sphere(
    polyhedron: Polyhedron,
    geometry: Geometry,
    group: object | None = None,
    *,
    weights: Literal["auto", "cotangent", "packing"] = "auto",
) -> Triangulation:
    """The map to S^2, or of a projective plane to P^2 through its double cover.

    One face is taken away and the rest is packed with circles in the plane (Koebe, Andreev, Thurston: possible for
    every triangulation), projected to the sphere and centred by a Moebius map. weights: "cotangent" replaces the
    circle centres by the harmonic map in the plane, which follows the metric of the mesh; "auto" takes whichever of
    the two has no fold and the smaller median angle distortion. Raises MapError if neither is an embedding.
    """
    surface = surface_type(polyhedron)
    if surface.euler_characteristic <= 0 or geometry.curvature != 1:
        raise MapError(f"a surface with chi = {surface.euler_characteristic} does not live on {geometry.name}")
    if group is not None:
        raise MapError("the map to the sphere takes no group; leave it out (group.method = 'mesh')")
    target = _Sphere(polyhedron, geometry) if surface.orientable else _ProjectivePlane(polyhedron, geometry)
    names = ["cotangent", "packing"] if weights == "auto" else [weights]
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
    hole = int(np.argmax(np.linalg.norm(_normals(mesh), axis=1)))
    packing = packed(mesh, 0, without_face=hole)
    flat = _flat_weights(packing.angles) if name == "packing" else WEIGHTS[name](mesh)
    if name == "packing":
        flat = flat + flat[mesh.twin]
    if not np.isfinite(flat).all():
        return None
    z = _plane_layout(mesh, flat, hole)
    if name == "packing":
        radii = packing.radii
    else:
        # The harmonic map has no circles: points take small ones, of a size that does not matter.
        radii = np.full(len(z), 1e-6 * np.abs(z).max())
    areas = np.bincount(mesh.tail, weights=np.repeat(np.linalg.norm(_normals(mesh), axis=1), 3), minlength=len(z))
    return centred_caps(z, radii, areas)


def _normals(mesh: Polyhedron) -> Floats:
    p = mesh.vertices[mesh.triangles]
    return np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])


def _flat_weights(angles: Floats) -> Floats:
    """Half the cotangent of the angle opposite to every halfedge, (H,), from corner angles (H,)."""
    with np.errstate(divide="ignore"):
        cotangents = 0.5 / np.tan(angles.reshape(-1, 3))
    return np.roll(cotangents, -2, axis=1).ravel()


def _plane_layout(mesh: Polyhedron, weights: Floats, hole: int) -> NDArray[np.complex128]:
    """The vertices in the plane: the corners of the hole clockwise on three unit circles, the rest harmonic.

    With the cotangents of a flat metric this is the isometric layout itself, since linear functions are harmonic.
    The edges of the hole have both ends fixed, so that its missing face does not matter.
    """
    order = dissection_order(mesh.vertices, mesh.tail, mesh.head)
    place = np.empty(len(order), dtype=np.intp)
    place[order] = np.arange(len(order))
    corners = mesh.triangles[hole]
    position = np.zeros(len(order), dtype=np.complex128)
    position[corners] = 2 / np.sqrt(3) * np.exp(1j * (np.pi / 2 - 2 * np.pi / 3 * np.arange(3)))
    fixed = np.zeros(len(order), dtype=np.bool_)
    fixed[corners] = True
    i, j = mesh.tail, mesh.head
    inner = ~fixed[i]
    right = np.zeros(len(order), dtype=np.complex128)
    np.add.at(right, i[inner & fixed[j]], weights[inner & fixed[j]] * position[j[inner & fixed[j]]])
    right[corners] = position[corners]
    diagonal = np.where(fixed, 1.0, np.bincount(i, weights=weights, minlength=len(order)))
    once = np.flatnonzero(inner & ~fixed[j])
    every = np.arange(len(order))
    rows = place[np.concatenate([i[once], every])]
    columns = place[np.concatenate([j[once], every])]
    # A halfedge whose twin runs the same way stands for both directions of its edge.
    data = np.concatenate([-weights[once], diagonal])
    matrix = coo_array((data, (rows, columns)), shape=(len(order), len(order))).tocsc()
    factor = factorised(matrix)
    solution = np.empty_like(right)
    solution[order] = factor.solve(right[order].real) + 1j * factor.solve(right[order].imag)
    return solution
