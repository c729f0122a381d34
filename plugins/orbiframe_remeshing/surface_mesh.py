"""Surface mesh: triangles in space with their vertices on a smooth surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe import FitError, OrbifoldSurface, Points, Polyhedron
from orbiframe.functions import DifferentiableBasis

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


class Rim(NamedTuple):
    """The edges of triangles that lie along the boundary of a surface: their ends (n, 2), and where it is between them.

    along: the points of X/H of the boundary at a share of the way from the first end of each edge to the second.
    """

    ends: Ints
    along: Callable[[float], Points]


@dataclass(frozen=True, eq=False)
class SurfaceMesh:
    """Triangles with vertices on a surface, before it is placed in space.

    points: where the vertices lie in X/H; jets: (3, V, 3), their places in space and the two derivatives of the
    surface; triangles: (F, 3), alike in orientation where the surface is orientable; creases: (n, 2), the ends of the
    edges that are creases, and stay; None for none; rim: those at the boundary, which are among these; None for none.
    """

    surface: OrbifoldSurface
    points: Points
    jets: Floats
    triangles: Ints
    creases: Ints | None = None
    rim: Rim | None = None

    @classmethod
    def at(cls, surface: OrbifoldSurface, points: Points, triangles: Ints) -> SurfaceMesh:
        """The mesh with its vertices over points of X/H."""
        return cls(surface, points, jets_at(surface, points), triangles)

    @property
    def places(self) -> Floats:
        """The vertices in space, (V, 3), before the surface is scaled and moved to its place."""
        return np.asarray(self.jets[0])

    @property
    def fixed(self) -> NDArray[np.bool_]:
        """The vertices on creases and on the boundary, which do not move, (V,)."""
        found = np.zeros(len(self.places), dtype=np.bool_)
        found[[] if self.creases is None else self.creases.ravel()] = True
        return found

    @property
    def regular(self) -> Ints:
        """How many triangles there should be at every vertex, (V,): six, on the boundary as its angle asks for."""
        found = np.full(len(self.places), 6)
        if self.rim is not None:
            angle = np.bincount(
                self.triangles.ravel(), weights=corner_angles(self.places, self.triangles).ravel(), minlength=len(found)
            )
            vertex = self.rim.ends[:, 0]
            found[vertex] = np.maximum(np.rint(angle[vertex] / 60), 1)
        return found

    def joined_by(self, triangles: Ints) -> SurfaceMesh:
        """The same vertices with other triangles."""
        return replace(self, triangles=triangles)

    def with_points(self, chosen: Ints, points: Points, jets: Floats) -> SurfaceMesh:
        """Some vertices over other points."""
        patch, x, all_jets = self.points.patch.copy(), self.points.x.copy(), self.jets.copy()
        patch[chosen], x[chosen], all_jets[:, chosen] = points.patch, points.x, jets
        return replace(self, points=Points(patch, x), jets=all_jets)

    def polyhedron(self) -> Polyhedron:
        """The mesh in its place, with the normals of the surface on the side of the first triangle of each vertex."""
        placed = self.surface.origin + self.surface.scale * self.places
        mesh = Polyhedron.from_faces(placed, self.triangles)
        normal = np.cross(self.jets[1], self.jets[2])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)[:, None]
        corner = np.unique(self.triangles, return_index=True)[1]
        facing = np.einsum("vi,vi->v", normal, cross(self.places, self.triangles)[corner // 3])
        outward = normal * np.where(facing < 0, -1.0, 1.0)[:, None]
        return replace(mesh.with_vertices(placed, outward), unit=self.surface.unit)


def jets_at(surface: OrbifoldSurface, points: Points) -> Floats:
    """Values and first derivatives of the functions, (3, n, 3). Raises FitError for a basis that has none."""
    if not isinstance(surface.basis, DifferentiableBasis):
        raise FitError("this basis knows no derivatives, which even triangles need; use one that does, as 'gaussian'")
    return surface.basis.jets(points, surface.coefficients, 1)


def element(jets: Floats) -> Floats:
    """Area in space for area in X at each point, (n,)."""
    return np.asarray(np.linalg.norm(np.cross(jets[1], jets[2]), axis=1))


def cross(places: Floats, triangles: Ints) -> Floats:
    """The normals of triangles (F, 3), each as long as twice its area."""
    a, b, c = (places[triangles[:, k]] for k in range(3))
    return np.asarray(np.cross(b - a, c - a))


def corner_angles(places: Floats, faces: Ints) -> Floats:
    """The angles at all corners of faces with n corners, (F, n), in degrees."""
    x = places[faces]
    ahead, behind = np.roll(x, -1, axis=1) - x, np.roll(x, 1, axis=1) - x
    sine, cosine = np.linalg.norm(np.cross(ahead, behind), axis=2), np.einsum("fci,fci->fc", ahead, behind)
    return np.asarray(np.degrees(np.arctan2(sine, cosine)))


def least_angles(places: Floats, triangles: Ints) -> Floats:
    """The least angle of every triangle, (F,), in degrees."""
    return np.asarray(corner_angles(places, triangles).min(axis=1))


def shortest_edges(places: Floats, triangles: Ints) -> Floats:
    """The length of the shortest edge at every vertex, (V,)."""
    length = np.linalg.norm(places[np.roll(triangles, -1, axis=1)] - places[triangles], axis=2)
    shortest = np.full(len(places), np.inf)
    np.minimum.at(shortest, triangles, np.minimum(length, np.roll(length, 1, axis=1)))
    return shortest
