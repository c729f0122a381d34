"""Girth: how quickly the scale of the map to X/H changes over the surface, and how many functions that asks for.

The scale s is the length in X per length in space. On a long tube of radius r it changes by the factor e over a length
of r, so that 1 / |grad log s| is the girth, found without looking across the tube. The integral E of |grad log s|^2
over the surface is a pure number, the Dirichlet energy of the conformal factor: 8 for a torus, 30 for a ring-shaped
toy, 560 for a fox with thin legs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.sizes import vector_areas
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]

_ROUNDS = 6
# At this energy half of what is asked for goes where the map changes; shapes without thin parts stay even.
_HALF = 150.0


class Girth(NamedTuple):
    """slope: |grad log s| at the vertices, (V,), an inverse length; energy: the integral E of its square."""

    slope: Floats
    energy: float


def girth(triangulation: Triangulation) -> Girth:
    """How the scale of the map changes; log s is averaged with its neighbours a few times against noise of the mesh.

    On triangles that only close the mesh it counts as constant.
    """
    mesh = triangulation.polyhedron
    area = np.maximum(np.linalg.norm(vector_areas(mesh), axis=1), np.finfo(float).tiny)
    around = _around(triangulation, area)
    image = np.maximum(_around(triangulation, triangulation.areas), np.finfo(float).tiny)
    scale = averaged(triangulation, 0.5 * np.log(image / around), _ROUNDS)
    square = (_gradients(triangulation, scale, area) ** 2).sum(axis=1)
    square = square if triangulation.inside is None else square * triangulation.inside
    slope = np.sqrt(averaged(triangulation, _around(triangulation, area * square) / around, 1))
    return Girth(slope, float(area @ square))


def girth_radius(triangulation: Triangulation) -> float:
    """The radius of the thinnest parts: below it |grad log s| lies on 99 % of the surface, as an inverse."""
    slope = girth(triangulation).slope
    size = np.linalg.norm(vector_areas(triangulation.polyhedron), axis=1)
    area = _around(triangulation, size if triangulation.inside is None else size * triangulation.inside)
    order = np.argsort(slope)
    place = np.searchsorted(np.cumsum(area[order]), 0.99 * area.sum())
    return float(1 / max(slope[order[min(place, len(order) - 1)]], np.finfo(float).tiny))


def site_density(triangulation: Triangulation, share: float) -> Floats:
    """How many sites there should be per length at each vertex of the mesh, (V,), up to a factor.

    The square is a mean of two densities per area, both of integral 1: the constant, and that of the energy, which
    counts `share` where the energy is large. Times `triangulation.density`, where the map has one.
    """
    found = girth(triangulation)
    total = np.linalg.norm(vector_areas(triangulation.polyhedron), axis=1).sum()
    part = share * found.energy / (found.energy + _HALF)
    density = np.sqrt((1 - part) / total + part * found.slope**2 / max(found.energy, np.finfo(float).tiny))
    return np.asarray(density if triangulation.density is None else density * triangulation.density)


def site_lengths(triangulation: Triangulation, share: float) -> Floats:
    """The lengths of all halfedges in space times the density of sites, (H,): evenly spread sites have that density."""
    mesh, density = triangulation.polyhedron, site_density(triangulation, share)
    return np.asarray(mesh.edge_lengths * (density[mesh.tail] + density[mesh.head]) / 2)


def averaged(triangulation: Triangulation, values: Floats, rounds: int) -> Floats:
    """Values at the vertices, (V,), half of each and half of the mean of its neighbours, so many times."""
    mesh = triangulation.polyhedron
    degree = np.maximum(np.bincount(mesh.tail, minlength=len(values)), 1)
    for _ in range(rounds):
        values = (values + np.bincount(mesh.tail, weights=values[mesh.head], minlength=len(values)) / degree) / 2
    return values


def _around(triangulation: Triangulation, per_face: Floats) -> Floats:
    """The sum of a quantity of the triangles over those about each vertex."""
    mesh = triangulation.polyhedron
    return np.asarray(np.bincount(mesh.tail, weights=np.repeat(per_face, 3), minlength=len(mesh.vertices)), dtype=float)


def _gradients(triangulation: Triangulation, values: Floats, area: Floats) -> Floats:
    """The gradients in space of the function that is linear on each triangle, (F, 3)."""
    mesh = triangulation.polyhedron
    corners = mesh.vertices[mesh.triangles]
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    normal = vector_areas(mesh) / area[:, None]
    turned = np.cross(normal[:, None], opposite)
    return np.asarray(np.einsum("fc,fci->fi", values[mesh.triangles], turned) / (2 * area[:, None]))
