"""Refinement: every triangle cut into k^2 triangles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import TopologyError
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Refinement:
    """A triangle mesh and its k-fold refinement.

    coarse, polyhedron: the mesh before and after; density: k; face: (V,) and barycentric: (V, 3), the place of every
    vertex of the fine mesh in the first face of the coarse one that holds it (a vertex in no face is given face 0).
    The first vertices are the coarse ones; the fine triangles of coarse face f are f k^2 to (f + 1) k^2 - 1. origin:
    (F,), the coarse face of every fine one.
    """

    coarse: Polyhedron
    polyhedron: Polyhedron
    density: int
    face: Ints
    barycentric: Floats
    origin: Ints


def refine(polyhedron: Polyhedron, density: int) -> Refinement:
    """Every triangle cut into density^2 triangles by lines parallel to its sides; flat, watertight, same surface.

    Vertices on an edge are shared by the faces on both sides, also where several edges have the same ends. Raises
    TopologyError for a density below 1 or faces that are not triangles.
    """
    if density < 1:
        raise TopologyError(f"a refinement of {density} was asked for; 1 keeps the mesh, 2 quarters every triangle")
    triangles, old, grid = polyhedron.triangles, len(polyhedron.vertices), _grid(density)
    points = _grid_indices(polyhedron, grid)
    count = old + polyhedron.edge_count * (density - 1) + polyhedron.face_count * len(grid.inner)
    # The first face that holds a vertex speaks for it.
    spot = np.full(count, points.size)
    np.minimum.at(spot, points.ravel(), np.arange(points.size))
    face, place = np.divmod(np.where(spot < points.size, spot, 0), points.shape[1])
    weights = grid.barycentric[place]
    new = np.einsum("nc,nci->ni", weights[old:], polyhedron.vertices[triangles[face[old:]]])
    vertices = np.concatenate([polyhedron.vertices, new])
    tail = points[:, grid.triangles.ravel()].ravel()
    twin, same = _fine_twins(polyhedron, grid)
    offsets = np.arange(polyhedron.face_count * density**2 + 1) * 3
    origin = np.repeat(np.arange(polyhedron.face_count), density**2)
    return Refinement(polyhedron, Polyhedron(vertices, offsets, tail, twin, same), density, face, weights, origin)


def grid_of(density: int) -> Floats:
    """The barycentric coordinates of the corners of the triangles that one triangle is cut into, (density^2, 3, 3)."""
    grid = _grid(density)
    return np.asarray(grid.barycentric[grid.triangles.reshape(-1, 3)])


@dataclass(frozen=True, eq=False)
class _Grid:
    """The triangle with k + 1 points on each side: point (i, j) has weights (k - i - j, i, j) / k."""

    density: int
    barycentric: Floats
    sides: Ints
    inner: Ints
    triangles: Ints
    twin: Ints
    border: Ints


@lru_cache(maxsize=16)
def _grid(k: int) -> _Grid:
    pairs = [(i, j) for i in range(k + 1) for j in range(k + 1 - i)]
    number = {pair: n for n, pair in enumerate(pairs)}
    sides = [[number[s, 0] for s in range(k + 1)], [number[k - s, s] for s in range(k + 1)]]
    sides.append([number[0, k - s] for s in range(k + 1)])
    inner = [number[i, j] for i, j in pairs if i > 0 and j > 0 and i + j < k]
    triangles = []
    for i, j in [pair for pair in pairs if sum(pair) < k]:
        triangles.append([number[i, j], number[i + 1, j], number[i, j + 1]])
        if i + j < k - 1:
            triangles.append([number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]])
    halfedge = {(t[c], t[(c + 1) % 3]): 3 * n + c for n, t in enumerate(triangles) for c in range(3)}
    twin = [halfedge.get((b, a), -1) for a, b in halfedge]
    border = [[halfedge[side[s], side[s + 1]] for s in range(k)] for side in sides]
    i, j = np.array(pairs).T
    barycentric = np.stack([k - i - j, i, j], axis=1) / k
    arrays = (np.array(a, dtype=np.intp) for a in (sides, inner, triangles, twin, border))
    return _Grid(k, barycentric, *arrays)


def _grid_indices(polyhedron: Polyhedron, grid: _Grid) -> Ints:
    """The index of every grid point of every face among the vertices of the refinement, (F, points)."""
    k = grid.density
    count, edges = polyhedron.face_count, polyhedron.edge_count
    points = np.empty((count, len(grid.barycentric)), dtype=np.intp)
    along = np.arange(1, k)
    for side in range(3):
        halfedge = np.arange(count) * 3 + side
        forward = polyhedron.representative[halfedge] | polyhedron.same[halfedge]
        step = np.where(forward[:, None], along, k - along)
        points[:, grid.sides[side, 1:k]] = (
            len(polyhedron.vertices) + polyhedron.edge[halfedge][:, None] * (k - 1) + step - 1
        )
        points[:, grid.sides[side, 0]] = polyhedron.tail[halfedge]
    base = len(polyhedron.vertices) + edges * (k - 1)
    points[:, grid.inner] = base + np.arange(count)[:, None] * len(grid.inner) + np.arange(len(grid.inner))
    return points


def _fine_twins(polyhedron: Polyhedron, grid: _Grid) -> tuple[Ints, NDArray[np.bool_]]:
    k = grid.density
    size = 3 * k * k
    count = polyhedron.face_count
    twin = np.where(grid.twin >= 0, np.arange(count)[:, None] * size + grid.twin, -1)
    same = np.zeros((count, size), dtype=np.bool_)
    position = np.arange(k)
    for side in range(3):
        halfedge = np.arange(count) * 3 + side
        other = polyhedron.twin[halfedge]
        across = np.where(polyhedron.same[halfedge][:, None], position, k - 1 - position)
        partner = (other // 3)[:, None] * size + grid.border[(other % 3)[:, None], across]
        twin[:, grid.border[side]] = np.where(other[:, None] >= 0, partner, -1)
        same[:, grid.border[side]] = polyhedron.same[halfedge][:, None]
    return twin.ravel(), same.ravel()
