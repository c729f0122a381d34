"""Carried map: the map of one mesh to X/H taken over by another mesh of the same surface, point by point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import MapError
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.orbifolds.atlas import Atlas, Points
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Copies of patches are looked for a little farther away than triangles can reach.
_BEYOND = 0.1


def carried(triangulation: Triangulation, mesh: Polyhedron, face: Ints, barycentric: Floats) -> Triangulation:
    """The map of a triangle mesh whose vertices lie at barycentric coordinates (V, 3) in mapped triangles (V,).

    Every edge runs the short way: of all copies of the patch of its head that whose point is nearest to its tail. So
    edges must be short against X/H, as those of refined meshes are. Whether the result covers X/H once is for the
    caller to ask (`not_positive`, `area_defect`). Raises MapError where an edge has no short way.
    """
    points = triangulation.locate(face, barycentric)
    old, geometry = triangulation.orbifold, triangulation.orbifold.geometry
    used, patch = np.unique(points.patch, return_inverse=True)
    half = np.flatnonzero(mesh.representative)
    # From the patch of the smaller number to that of the larger one: one transition for both directions.
    turned = patch[mesh.tail[half]] > patch[mesh.head[half]]
    start = np.where(turned, mesh.head[half], mesh.tail[half])
    end = np.where(turned, mesh.tail[half], mesh.head[half])
    copy, isometry = _short_ways(old, points, start, end)
    kinds, first, kind = np.unique(copy, return_index=True, return_inverse=True)
    moving = kinds >= 0
    ends = patch[start[first[moving]]], patch[end[first[moving]]]
    tables = _with_inverses(isometry[kinds[moving]], geometry.inverse(isometry[kinds[moving]]), *ends)
    inverse = tables[2]
    step = np.where(moving, 2 * np.cumsum(moving) - 1, 0)[kind]
    step = np.where(turned, inverse[step], step)
    transition = np.zeros(len(mesh.tail), dtype=np.intp)
    transition[half] = step
    transition[mesh.twin[half]] = np.where(mesh.same[half], step, inverse[step])
    atlas = Atlas(geometry, np.ones(len(used)), *tables)
    atlas = replace(atlas, radius=_reach(atlas, Points(patch, points.x), mesh, transition))
    orbifold = Orbifold(atlas, old.euler_characteristic, old.orientable, old.area)
    return Triangulation(orbifold, mesh, patch, points.x, transition, triangulation.group, triangulation.weights)


def _short_ways(orbifold: Orbifold, points: Points, start: Ints, end: Ints) -> tuple[Ints, Floats]:
    """For each edge the copy of the patch of its end, seen from its start, -1 for the patch itself; all isometries."""
    geometry, patches, count = orbifold.geometry, np.unique(points.patch), orbifold.atlas.patch_count
    copies = orbifold.copies(patches, orbifold.atlas.radius[patches] + orbifold.atlas.radius.max() + _BEYOND)
    key = patches[copies.base] * count + copies.patch
    order = np.argsort(key, kind="stable")
    wanted = points.patch[start] * count + points.patch[end]
    low, high = (np.searchsorted(key[order], wanted, side) for side in ("left", "right"))
    if (low == high).any():
        raise MapError("an edge of the mesh has no short way in X/H")
    edge = np.repeat(np.arange(len(start)), high - low)
    begin = np.cumsum(high - low) - (high - low)
    option = order[low[edge] + np.arange(len(edge)) - begin[edge]]
    away = geometry.distance(points.x[start[edge]], geometry.act(copies.isometry[option], points.x[end[edge]]))
    best = option[np.lexsort((away, edge))[begin]]
    itself = np.abs(copies.isometry[best] - np.eye(3)).max(axis=(1, 2)) == 0
    return np.where(itself & (points.patch[start] == points.patch[end]), -1, best), copies.isometry


def _with_inverses(forth: Floats, back: Floats, tail: Ints, head: Ints) -> tuple[Ints, Ints, Ints, Floats]:
    """Tail, head, inverse and isometry of the identity and of transitions, each followed by its inverse."""
    number = 2 * np.arange(len(forth))
    pairs = (tail, head), (head, tail), (number + 2, number + 1)
    tails, heads, inverse = (
        np.concatenate([[first], np.stack(pair, axis=1).ravel()])
        for first, pair in zip((-1, -1, 0), pairs, strict=True)
    )
    both = np.stack([forth, back], axis=1).reshape(-1, 3, 3)
    return tails, heads, inverse, np.concatenate([np.eye(3)[None], both])


def _reach(atlas: Atlas, points: Points, mesh: Polyhedron, transition: Ints) -> Floats:
    """How far the triangles with a corner in a patch reach from its origin, (P,)."""
    geometry, reach = atlas.geometry, np.zeros(atlas.patch_count)
    ahead = geometry.act(atlas.isometry[transition], points.x[mesh.head])
    behind = geometry.act(atlas.isometry[atlas.inverse[transition]], points.x[mesh.tail])
    ends = (points.patch, points.x), (points.patch[mesh.tail], ahead), (points.patch[mesh.head], behind)
    for patch, x in ends:
        np.maximum.at(reach, patch, geometry.distance(geometry.origin, x))
    return reach
