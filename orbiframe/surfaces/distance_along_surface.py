"""Geodesic distance: how long the shortest ways along a surface in space are."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from orbiframe.components.one_line import one_line
from orbiframe.errors import FitError, UsageError
from orbiframe.meshes.heat_distance import heat_distances
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.wave_front import front_distances, through_sides
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.nearest import nearest_points
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Triangles on the surface along which distances are measured; equations on very many take long.
_TRIANGLES = {"front": 150_000, "heat": 40_000}


@dataclass(frozen=True, eq=False)
class GeodesicDistance:
    """The distance along a surface from a source.

    mesh: triangles on the surface, inscribed; points: those of X/H under its vertices; values: (V,), the distance
    there, inf where no way leads.
    """

    mesh: Polyhedron
    points: Points
    values: Floats

    __repr__ = one_line

    def at(self, places: ArrayLike) -> Floats:
        """The distance (n,) at points of the surface in space (n, 3), through triangles about the nearest vertex."""
        x = np.asarray(places, dtype=np.float64).reshape(-1, 3)
        nearest = self._tree.query(x)[1]
        start, order = self._corners
        count = start[nearest + 1] - start[nearest]
        row = np.repeat(np.arange(len(x)), count)
        within = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
        corners = self.mesh.triangles[order[np.repeat(start[nearest], count) + within] // 3]
        found = np.full(len(x), np.inf)
        for k in range(3):
            a, b = corners[:, k], corners[:, (k + 1) % 3]
            p, q = self.mesh.vertices[a], self.mesh.vertices[b]
            sides = np.linalg.norm([q - p, x[row] - p, x[row] - q], axis=2)
            np.minimum.at(found, row, through_sides(self.values[a], self.values[b], *sides))
        return found

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.mesh.vertices)

    @cached_property
    def _corners(self) -> tuple[Ints, Ints]:
        """The corners of the mesh at each vertex: those of vertex v are order[start[v] : start[v + 1]]."""
        corners = self.mesh.triangles.ravel()
        counts = np.bincount(corners, minlength=len(self.mesh.vertices))
        return np.concatenate([[0], np.cumsum(counts)]), np.argsort(corners, kind="stable")


def geodesic_distance(
    surface: OrbifoldSurface, sources: Points | ArrayLike, *, method: str = "front", triangles: int | None = None
) -> GeodesicDistance:
    """The distance along the surface from the nearest of some points.

    sources: points of X/H, or (n, 3) points in space, whose nearest points on the surface are meant. method: "front", a
    wave front that goes from triangle to triangle of a fine mesh on the surface, right to some thousandths of the
    largest; or "heat", by the flow of heat, smooth and a few percent off. triangles: how many that mesh has at least;
    by default 150,000, for heat 40,000. The error falls with their size. On a surface with a boundary, ways stay within
    it. Raises FitError for sources that are not there, UsageError for another method.

    >>> from orbiframe import fit
    >>> from orbiframe.surfaces import geodesic_distance
    >>> surface = fit("dataset:torus", size=300).surface
    >>> found = geodesic_distance(surface, [[1.4, 0, 0]], triangles=20_000)
    >>> across = surface.nearest([[0.6, 0, 0]])[0]  # half round the tube, whose radius is 0.4
    >>> print(found.at(surface.evaluate(across)).round(2))
    [1.26]
    """
    if method not in _TRIANGLES:
        raise UsageError(f"the method is {method!r}; it must be one of {', '.join(_TRIANGLES)}")
    begin = _in_space(surface, sources)
    faces = len(surface.triangulation.own_faces)
    least = _TRIANGLES[method] if triangles is None else triangles
    mesh, points = surface.tessellation(max(1, int(np.ceil(np.sqrt(least / faces)))), bisected=True)
    found = GeodesicDistance(mesh, points, np.zeros(len(mesh.vertices)))
    nearest = np.asarray(found._tree.query(begin)[1], dtype=np.intp)
    if method == "heat":
        return replace(found, values=heat_distances(mesh, np.unique(nearest)))
    return replace(found, values=front_distances(mesh, *_about(found, begin, nearest)))


def _in_space(surface: OrbifoldSurface, sources: Points | ArrayLike) -> Floats:
    """The sources as points of the surface in space, (n, 3)."""
    if isinstance(sources, Points):
        places = sources
    else:
        given = np.asarray(sources, dtype=np.float64)
        if given.ndim not in (1, 2) or given.shape[-1] != 3:
            raise FitError(f"the sources have the shape {given.shape}; give points in space as (n, 3)")
        places = nearest_points(surface, given.reshape(-1, 3))[0]
    if not len(places.patch):
        raise FitError("there is no source; give at least one point")
    return surface.evaluate(places)


def _about(found: GeodesicDistance, x: Floats, nearest: Ints) -> tuple[Ints, Floats]:
    """The vertices of the triangles about the vertices nearest to points x (n, 3), and how far they are from these."""
    start, order = found._corners
    vertices = [np.unique(found.mesh.triangles[order[start[v] : start[v + 1]] // 3]) for v in nearest]
    place = np.repeat(x, [len(part) for part in vertices], axis=0)
    vertex = np.concatenate(vertices)
    return vertex, np.linalg.norm(found.mesh.vertices[vertex] - place, axis=1)
