"""Relaxed: an optimizer that moves every vertex towards the middle of its neighbours while shapes improve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import Triangulation
from orbiframe.plugin import Component, hookimpl

Floats = NDArray[np.float64]


@hookimpl
def orbiframe_components() -> list[Component]:
    """The optimizer of this file."""
    return [Component("optimizer", "relaxed", "relaxed:relaxed", "vertices in the middle of their neighbours")]


def relaxed(triangulation: Triangulation, target: Floats, *, steps: int = 5) -> Triangulation:
    """The map after some steps towards the middle of the neighbours, none of which makes the shapes worse.

    steps: at most so many.
    """
    best, shapes = triangulation, _distortion(triangulation, target)
    for _ in range(steps):
        moved = _towards_neighbours(best, 0.3)
        found = _distortion(moved, target)
        if moved.not_positive or not found < shapes:
            break
        best, shapes = moved, found
    return best


def _towards_neighbours(triangulation: Triangulation, share: float) -> Triangulation:
    """Every vertex a share of the way along the mean of the tangent vectors to its neighbours."""
    mesh, orbifold = triangulation.polyhedron, triangulation.orbifold
    geometry, points = orbifold.geometry, triangulation.points
    here = points[mesh.tail]
    there = geometry.act(orbifold.atlas.isometry[triangulation.transition], points[mesh.head])
    mean = np.zeros_like(points)
    np.add.at(mean, mesh.tail, geometry.log(here, there))
    mean /= np.bincount(mesh.tail, minlength=len(points))[:, None]
    return _with_wide_patches(replace(triangulation, points=geometry.settle(geometry.exp(points, share * mean))))


def _with_wide_patches(triangulation: Triangulation) -> Triangulation:
    """The same map, with patches that reach as far as the triangles at their vertices do now."""
    mesh, orbifold, points = triangulation.polyhedron, triangulation.orbifold, triangulation.points
    geometry, atlas, across = orbifold.geometry, orbifold.atlas, triangulation.transition
    radius = atlas.radius.copy()
    for base, other, step in ((mesh.tail, mesh.head, across), (mesh.head, mesh.tail, atlas.inverse[across])):
        seen = geometry.act(atlas.isometry[step], points[other])
        far = np.maximum(geometry.distance(geometry.origin, seen), geometry.distance(geometry.origin, points[base]))
        np.maximum.at(radius, triangulation.patch[base], far)
    return replace(triangulation, orbifold=replace(orbifold, atlas=replace(atlas, radius=radius)))


def _distortion(triangulation: Triangulation, target: Floats) -> float:
    """The mean of (a/b + b/a)/2 for the singular values of the maps from the wished triangles, by their sides."""
    geometry, corners = triangulation.orbifold.geometry, triangulation.lifts
    found = np.stack([geometry.distance(corners[:, k - 2], corners[:, k - 1]) for k in range(3)], axis=1)
    wished = np.stack([np.linalg.norm(target[:, k - 2] - target[:, k - 1], axis=1) for k in range(3)], axis=1)
    squares = (np.roll(found, 1, axis=1) ** 2 + np.roll(found, 2, axis=1) ** 2 - found**2) * wished**2
    return float(np.mean(squares.sum(axis=1) / (16 * _area(wished) * _area(found))))


def _area(sides: Floats) -> Floats:
    """Heron's area of triangles by their sides (F, 3)."""
    s = sides.sum(axis=1) / 2
    return np.asarray(np.sqrt(np.maximum(s * (s[:, None] - sides).prod(axis=1), 1e-300)))
