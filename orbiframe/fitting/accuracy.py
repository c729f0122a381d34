"""Accuracy: how far a surface and the mesh are from each other, both ways, in diagonals of the mesh."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import FitError
from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.functions.foot_points import foot_points
from orbiframe.functions.samples import Samples, places
from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]

# A surface that leaves the ball about the mesh by more than its radius is no approximation.
_TOO_FAR = 1.0


class Distances(NamedTuple):
    """Root mean square, mean and largest of distances, and the point in space where they are largest."""

    rms: float
    mean: float
    max: float
    place: tuple[float, float, float]


class Accuracy(NamedTuple):
    """Distances of the facets to the surface, of the surface to the facets, and of the vertices to the surface.

    at_vertices: (V,), of the vertices of the refined mesh to the surface, where functions may be missing.
    """

    to_surface: Distances
    to_mesh: Distances
    vertices: Distances
    at_vertices: Floats

    def against(self, smooth: bool) -> tuple[float, float]:
        """Root mean square and maximum of the distance to what the mesh means: its vertices, or both ways."""
        parts = (self.vertices,) if smooth else (self.to_surface, self.to_mesh)
        return max(part.rms for part in parts), max(part.max for part in parts)


def accuracy_of(surface: OrbifoldSurface) -> Accuracy:
    """The accuracy of a surface for a mesh of unit size.

    Samples of the mesh go to their foot points on the surface, and points of the surface over them to the nearest point
    of the mesh; a surface without derivatives is measured at the parameters of the samples. Raises FitError for a
    surface that is worse than its own centroid.
    """
    flat, count = surface.refinement.polyhedron, len(surface.refinement.coarse.vertices)
    samples = places(replace(surface.triangulation, polyhedron=flat))
    there = surface.evaluate(samples.points)
    _require_sane(there, samples)
    away = _foot_distances(surface, samples, there)
    back = NearestPoints(flat).distance(there)
    return Accuracy(
        _distances(away, samples.weights, samples.values),
        _distances(back, samples.weights, there),
        _distances(away[:count], samples.weights[:count], samples.values[:count]),
        away[: len(flat.vertices)],
    )


def _foot_distances(surface: OrbifoldSurface, samples: Samples, there: Floats) -> Floats:
    """The distances of samples to their foot points on the surface."""
    if not isinstance(surface.basis, DifferentiableBasis):
        return np.asarray(np.linalg.norm(there - samples.values, axis=1))
    longest = float(np.sqrt(samples.weights.sum() / surface.basis.size))
    return foot_points(surface.basis, surface.coefficients, samples.points, samples.values, longest)[1]


def _require_sane(there: Floats, samples: Samples) -> None:
    """Raises FitError for a surface that is no better than the centroid of the mesh, or far outside of the mesh."""
    weights = samples.weights / samples.weights.sum()
    centroid = weights @ samples.values
    constant = float(np.sqrt(weights @ ((samples.values - centroid) ** 2).sum(axis=1)))
    rms = float(np.sqrt(weights @ ((samples.values - there) ** 2).sum(axis=1)))
    if not rms < constant:
        raise FitError(
            f"the surface is off by {rms:.2g} of the diagonal, and a single point by {constant:.2g}: so few functions "
            "do not follow this mesh; raise the option size, or choose another basis (basis.name = 'gaussian')"
        )
    radius = float(np.linalg.norm(samples.values - centroid, axis=1).max())
    reached = float(np.linalg.norm(there - centroid, axis=1).max())
    if reached > (1 + _TOO_FAR) * radius:
        raise FitError(
            f"the surface reaches {reached / radius:.2g} times as far from its middle as the mesh: so few functions do "
            "not follow this mesh; raise the option size or the option fairing, or choose another basis"
        )


def _distances(away: Floats, weights: Floats, where: Floats) -> Distances:
    share, worst = weights / weights.sum(), int(np.argmax(away))
    x, y, z = (float(number) for number in where[worst])
    return Distances(float(np.sqrt(share @ away**2)), float(share @ away), float(away[worst]), (x, y, z))
