"""The tessellation of X by all lifts of the faces of a polyhedron that is mapped to X/H (sections 3.3 and 3.4)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.face_diagonals import outline
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.planes.geometry import Geometry
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

_AT_ONCE = 1 << 20


@dataclass(frozen=True, eq=False)
class LiftedFaces:
    """Faces with one number of corners, each lifted to a frame of X/H: patch (F,), corners (F, n, 3)."""

    patch: Ints
    corners: Floats


@dataclass(frozen=True, eq=False)
class FaceCopies:
    """Lifts of faces with one number of corners to one frame of X: corners (m, n, 3).

    home: (m,), whether the copy is the nearest to the origin of its face: one for every face.
    """

    corners: Floats
    home: Bools


@dataclass(frozen=True, eq=False)
class Tessellation:
    """The faces of a polyhedron in X/H, lifted to the patches of their first corners, by their numbers of corners."""

    orbifold: Orbifold
    faces: tuple[LiftedFaces, ...]

    @property
    def geometry(self) -> Geometry:
        """The plane of constant curvature that covers the surface."""
        return self.orbifold.geometry

    @property
    def face_count(self) -> int:
        """Number of faces of X/H."""
        return sum(len(faces.patch) for faces in self.faces)

    @property
    def edge_count(self) -> float:
        """Number of edges of X/H."""
        return sum(faces.corners[..., 0].size for faces in self.faces) / 2

    @cached_property
    def edge_length(self) -> float:
        """The median length of the sides of faces."""
        found = [self.geometry.distance(f.corners, np.roll(f.corners, -1, axis=1)).ravel() for f in self.faces]
        return float(np.median(np.concatenate(found)))

    @classmethod
    def of_map(cls, polyhedron: Polyhedron, refinement: Bisection, triangulation: Triangulation) -> Tessellation:
        """The faces of a polyhedron whose triangles, refined, are mapped to X/H."""
        atlas = triangulation.orbifold.atlas
        steps = refinement.composed(atlas.isometry[triangulation.transition])[outline(polyhedron)]
        faces = tuple(_lifted(polyhedron, triangulation, steps, int(size)) for size in np.unique(polyhedron.face_sizes))
        return cls(triangulation.orbifold, faces)

    @classmethod
    def of_triangulation(cls, triangulation: GeodesicTriangulation) -> Tessellation:
        """The triangles of X/H themselves, such as those of `delaunay`."""
        corners = np.einsum("fij,fkj->fki", triangulation.placement, triangulation.corners)
        return cls(triangulation.orbifold, (LiftedFaces(triangulation.patch, corners),))

    @classmethod
    def of_triangles(cls, triangulation: Triangulation) -> Tessellation:
        """The triangles of a refined mesh that is mapped to X/H, in their order."""
        first = triangulation.patch[triangulation.polyhedron.triangles[:, 0]]
        return cls(triangulation.orbifold, (LiftedFaces(first, triangulation.lifts),))

    def homes(self) -> list[Floats]:
        """For every face, in the order of `faces`, that lift to the frame of patch 0 which is nearest to its origin.

        Arrays (F, n, 3): together they cover X/H once, about the origin.
        """
        middles = [self.geometry.project(faces.corners.sum(axis=1)) for faces in self.faces]
        reach = max(float(self._away(x).max()) for x in middles)
        radius = 2 * reach
        while True:
            patches, isometry = self.orbifold.lifts(0, radius)
            pairs = zip(self.faces, middles, strict=True)
            found = [_nearest(self.geometry, f.patch, x, patches, isometry) for f, x in pairs]
            # A nearer copy has its origin within `reach` of a middle that is no farther than the one found.
            whole = self.geometry.curvature > 0 and radius > np.pi
            if whole or max(float(away.max()) for _, away in found) + reach <= radius:
                moved = [isometry[copy] for copy, _ in found]
                return [np.einsum("fij,fcj->fci", g, f.corners) for g, f in zip(moved, self.faces, strict=True)]
            radius = 1.5 * radius + 0.1

    def _away(self, x: Floats) -> Floats:
        return np.asarray(self.geometry.distance(self.geometry.origin, x))

    def copies(self, radius: float, patch: int = 0, centre: Floats | None = None) -> Iterator[FaceCopies]:
        """All lifts of faces of patches whose origins lie within a radius about `centre`, in a frame with it as origin.

        centre: (3,), in the frame of `patch`, by default its origin.
        """
        geometry = self.geometry
        home = geometry.origin if centre is None else centre
        away = float(geometry.distance(geometry.origin, home))
        patches, isometry = self.orbifold.lifts(patch, radius + away)
        isometry = geometry.inverse(geometry.carry(home)) @ isometry
        near = geometry.distance(geometry.origin, isometry[:, :, 0]) <= radius
        for faces in self.faces:
            yield _copied(geometry, faces, patches[near], isometry[near])


def geodesic_sides(geometry: Geometry, corners: Floats, pieces: int) -> Floats:
    """The sides of polygons with corners (F, n, 3) in X as chains of points, (F n, pieces + 1, 3)."""
    share = np.linspace(0, 1, pieces + 1)[:, None]
    start, end = corners[:, :, None], np.roll(corners, -1, axis=1)[:, :, None]
    return np.asarray(geometry.project((1 - share) * start + share * end).reshape(-1, pieces + 1, 3))


def _lifted(polyhedron: Polyhedron, triangulation: Triangulation, steps: Floats, size: int) -> LiftedFaces:
    """The faces with so many corners; every corner is reached from the one before it."""
    halfedge = polyhedron.offsets[:-1][polyhedron.face_sizes == size][:, None] + np.arange(size)
    vertices = polyhedron.tail[halfedge]
    frame, corners = np.tile(np.eye(3), (len(vertices), 1, 1)), []
    for k in range(size):
        corners.append(np.einsum("fij,fj->fi", frame, triangulation.points[vertices[:, k]]))
        frame = frame @ steps[halfedge[:, k]]
    return LiftedFaces(triangulation.patch[vertices[:, 0]], np.stack(corners, axis=1))


def _nearest(geometry: Geometry, home: Ints, middles: Floats, patches: Ints, isometry: Floats) -> tuple[Ints, Floats]:
    """Which copy of its patch brings the middle (F, 3) of each face nearest to the origin, and how near; else inf."""
    copy, away = np.zeros(len(home), dtype=np.intp), np.full(len(home), np.inf)
    for patch in np.unique(home):
        rows, choices = np.flatnonzero(home == patch), np.flatnonzero(patches == patch)
        for part in np.array_split(rows, 1 + len(rows) * len(choices) // _AT_ONCE) if len(choices) else ():
            there = np.einsum("kij,fj->kfi", isometry[choices], middles[part])
            distance = geometry.distance(geometry.origin, there)
            best = np.argmin(distance, axis=0)
            copy[part], away[part] = choices[best], distance[best, np.arange(len(part))]
    return copy, away


def _copied(geometry: Geometry, faces: LiftedFaces, patches: Ints, isometry: Floats) -> FaceCopies:
    """The faces of every patch, moved to every copy of it."""
    copy, face = np.nonzero(patches[:, None] == faces.patch)
    corners = np.einsum("mij,mkj->mki", isometry[copy], faces.corners[face])
    distance = geometry.distance(geometry.origin, geometry.project(corners.sum(axis=1)))
    order = np.lexsort((distance, face))
    home = np.zeros(len(face), dtype=np.bool_)
    home[order[np.unique(face[order], return_index=True)[1]]] = True
    return FaceCopies(corners, home)
