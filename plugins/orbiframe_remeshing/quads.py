"""Quadrilaterals: three of every triangle, with all their corners on the surface."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import Points, Polyhedron
from orbiframe_remeshing.crease_points import crease_points
from orbiframe_remeshing.edges import Edges, edges_of
from orbiframe_remeshing.lifted_edges import lifted
from orbiframe_remeshing.relaxation import mended, stepped
from orbiframe_remeshing.surface_mesh import SurfaceMesh, element, jets_at

Ints = NDArray[np.intp]

# Steps to the middle of all that is round a vertex. Of halves of squares and of rhombs with 60 degrees the least angles
# are 45 and 30; those below this are mended one by one.
_STEPS, _POOR = 8, 20.0


def quadrilaterals(mesh: SurfaceMesh) -> Polyhedron:
    """Every triangle in three: from its corners to the middles of its edges and to its centroid.

    Middles and centroids are taken in X first, and then all vertices go to the middle of their faces in space. V
    vertices become 6 V - 5 chi, less 2 for each on a boundary: those of the triangles come first, then the middles of
    edges, then the centroids.
    """
    triangles, count = mesh.triangles, len(mesh.places)
    edges = edges_of(triangles, count)
    middle, centre = _numbers(triangles, edges.key, count)
    added = _middles(mesh, edges), _between(mesh, *triangles.T)
    new = Points(*(np.concatenate(pair) for pair in zip(*added, strict=True)))
    whole = SurfaceMesh(
        mesh.surface,
        Points(*(np.concatenate(pair) for pair in zip(mesh.points, new, strict=True))),
        np.concatenate([mesh.jets, jets_at(mesh.surface, new)], axis=1),
        _halves(triangles, middle, centre),
        None if mesh.creases is None else _halved(mesh.creases, edges, count),
    )
    for _ in range(_STEPS):
        whole = stepped(whole)
    placed = mended(whole, _POOR).polyhedron()
    # The corners of a half, and after them the middle of the edge before its corner.
    faces = np.column_stack([whole.triangles[: triangles.size], np.roll(middle, 1, axis=1).ravel()])
    made = Polyhedron.from_faces(placed.vertices, faces).with_vertices(placed.vertices, placed.normals)
    return replace(made, unit=placed.unit)


def _middles(mesh: SurfaceMesh, edges: Edges) -> Points:
    """The middles of edges, (E,), those of creases on the creases, and those of the boundary on the boundary."""
    found = _between(mesh, edges.a, edges.b)
    if mesh.rim is not None:
        return _replaced(found, edges.places(mesh.rim.ends), mesh.rim.along(0.5))
    sharp = np.flatnonzero(edges.among(mesh.creases))
    if not len(sharp):
        return found
    chords = (mesh.places[edges.a[sharp]] + mesh.places[edges.b[sharp]]) / 2
    return _replaced(found, sharp, crease_points(mesh.surface, chords))


def _replaced(points: Points, some: Ints, others: Points) -> Points:
    """Points of which some are others."""
    patch, x = points.patch.copy(), points.x.copy()
    patch[some], x[some] = others.patch, others.x
    return Points(patch, x)


def _halved(ends: Ints, edges: Edges, count: int) -> Ints:
    """The halves of edges with given ends, (2 n, 2)."""
    kept = np.flatnonzero(edges.among(ends))
    return np.concatenate([np.stack([end[kept], count + kept], axis=1) for end in (edges.a, edges.b)])


def _between(mesh: SurfaceMesh, first: Ints, *others: Ints) -> Points:
    """The centroids in X of vertices that are joined, (n,) each.

    They are weighted by the fourth roots of the area element: then the speed in space along an edge is the same at both
    ends.
    """
    orbifold, x = mesh.surface.orbifold, mesh.points.x
    weight = np.sqrt(np.sqrt(element(mesh.jets)))[:, None]
    total = weight[first] * x[first]
    for other in others:
        total = total + weight[other] * lifted(orbifold, mesh.points, first, other)
    return orbifold.settled(Points(mesh.points.patch[first], orbifold.geometry.project(total)))


def _halves(triangles: Ints, middle: Ints, centre: Ints) -> Ints:
    """The quadrilaterals cut by their diagonals from the centroid: those of the first halves, then the others."""
    inside = np.broadcast_to(centre[:, None], triangles.shape)
    first = np.stack([triangles, middle, inside], axis=2)
    second = np.stack([triangles, inside, np.roll(middle, 1, axis=1)], axis=2)
    return np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])


def _numbers(triangles: Ints, key: Ints, count: int) -> tuple[Ints, Ints]:
    """The vertex at the middle of the edge after every corner, (F, 3), and that at the centroid, (F,)."""
    head = np.roll(triangles, -1, axis=1)
    own = np.minimum(triangles, head) * np.intp(count) + np.maximum(triangles, head)
    return count + np.searchsorted(key, own), count + len(key) + np.arange(len(triangles))
