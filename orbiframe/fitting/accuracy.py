"""Accuracy: how far a surface and the mesh are from each other, both ways, in diagonals of the mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import FitError
from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.functions.feet import feet_of, foot_step
from orbiframe.functions.samples import Samples, places
from orbiframe.functions.smooth_samples import at_samples
from orbiframe.meshes.edge_paths import first_largest
from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.meshes.sizes import vector_areas
from orbiframe.meshes.submesh import submesh
from orbiframe.surfaces.border import Border, border_of
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]

# A surface that leaves the ball about the mesh by more than its radius is no approximation.
_TOO_FAR = 1.0
# Feet farther than this share of the spacing of functions, and this share of all that are worst, are found exactly.
_NEAR, _WORST = 0.1, 0.01
# So many places are told where the error is largest, so far apart, in diagonals.
PLACES, APART = 6, 0.08


class Place(NamedTuple):
    """A point in space, and its distance to the other of mesh and surface."""

    distance: float
    place: tuple[float, float, float]


class Distances(NamedTuple):
    """Root mean square and mean of distances, and where they are largest: the farthest place first."""

    rms: float
    mean: float
    places: tuple[Place, ...]

    @property
    def max(self) -> float:
        """The largest distance."""
        return self.places[0].distance

    @property
    def place(self) -> tuple[float, float, float]:
        """The point in space that has it."""
        return self.places[0].place


class Accuracy(NamedTuple):
    """Distances of the mesh to the surface, of the surface to the mesh, and of the given vertices to the surface.

    normals: the root mean square of the angle between normals of facets and of the surface at the feet, in degrees;
    at_vertices: (V,), the distances of the vertices of the refined mesh to the surface: where functions are missing;
    border: how well the boundary of the surface is that of the mesh, None where there is none; arcs: the distances of
    points of the arcs that bent facets beside creases stand for, None where they are not asked for.
    """

    to_surface: Distances
    to_mesh: Distances
    vertices: Distances
    normals: float
    at_vertices: Floats
    border: Border | None = None
    arcs: Distances | None = None

    def against(self, smooth: bool) -> tuple[float, float]:
        """Root mean square and maximum of the distance to what the mesh means: vertices, arcs, or facets both ways."""
        parts = (self.vertices,) if smooth else (self.to_surface, self.to_mesh)
        parts = parts if self.arcs is None else (self.arcs,)
        return max(part.rms for part in parts), max(part.max for part in parts)


def accuracy_of(surface: OrbifoldSurface, arcs: Samples | None = None) -> Accuracy:
    """The accuracy of a surface for a mesh of unit size; arcs: what its bent facets stand for, if that is to be told.

    Samples of the mesh go to their foot points on the surface, and the points of the surface over them to the nearest
    point of the mesh; a surface without derivatives is measured at the parameters of the samples. Raises FitError for a
    surface that is worse than its own centroid.
    """
    flat, given = surface.refinement.polyhedron, len(surface.refinement.coarse.vertices)
    everywhere = places(replace(surface.triangulation, polyhedron=flat))
    inside = surface.triangulation.inside
    # Of a mesh with a boundary only what belongs to it is seen: first its vertices, then its centroids.
    own = np.arange(len(everywhere.weights)) if inside is None else np.flatnonzero(everywhere.weights > 0)
    samples, count = everywhere.take(own), int(np.searchsorted(own, len(flat.vertices)))
    given = int(np.searchsorted(own, given))
    there, away, normals = _seen(surface, samples, given)
    _require_sane(there, samples.values, samples.weights)
    mesh = flat if inside is None else submesh(flat, inside).mesh
    back = NearestPoints(mesh).distance(there)
    border = None if inside is None else _sound(border_of(surface), surface.basis.size)
    at_vertices = np.zeros(len(flat.vertices))
    at_vertices[own[:count]] = away[:count]
    return Accuracy(
        _distances(away, samples.weights, samples.values),
        _distances(back, samples.weights, there),
        _distances(away[:given], samples.weights[:given], samples.values[:given]),
        _tilt(normals[count:], vector_areas(flat)[own[count:] - len(flat.vertices)]),
        at_vertices,
        border,
        None if arcs is None else _of_arcs(surface, arcs),
    )


def stray_of(surface: OrbifoldSurface, accuracy: Accuracy) -> float:
    """The largest distance of the mesh from the surface, in sizes of the facets: the root of twice the area of each."""
    refinement = surface.refinement
    size = np.sqrt(2 * np.linalg.norm(vector_areas(refinement.facets), axis=1))
    there = at_samples(surface.triangulation, refinement, size)[: len(accuracy.at_vertices)]
    return float((accuracy.at_vertices / np.maximum(there, np.finfo(float).tiny)).max())


def _of_arcs(surface: OrbifoldSurface, samples: Samples) -> Distances:
    """The distances of samples from a surface, each counted by the area that it stands for."""
    counted = samples.take(np.flatnonzero(samples.shares > 0))
    away = _seen(surface, replace(counted, weights=counted.shares), 0)[1]
    return _distances(away, counted.shares, counted.values)


def _seen(surface: OrbifoldSurface, samples: Samples, given: int) -> tuple[Floats, Floats, Floats]:
    """The points of a surface over samples, the distances of the samples to it, and the normals at their feet.

    Feet near by are found on the parabolic surface that touches at the sample, those that matter most by Newton's
    method: so are those of the first samples, as many as are given.
    """
    basis, coefficients, targets = surface.basis, surface.coefficients, samples.values
    if not isinstance(basis, DifferentiableBasis):
        there = surface.evaluate(samples.points)
        return there, np.asarray(np.linalg.norm(there - targets, axis=1)), np.full(there.shape, np.nan)
    jets = basis.jets(samples.points, coefficients, 2)
    spacing = float(np.sqrt(samples.weights.sum() / basis.size))
    u, v = foot_step(jets, targets, spacing).T[..., None]
    slopes = jets[1] + u * jets[3] + v * jets[4], jets[2] + u * jets[4] + v * jets[5]
    way = u * (jets[1] + slopes[0]) / 2 + v * (jets[2] + slopes[1]) / 2
    left, normals = targets - jets[0] - way, np.cross(*slopes)
    away = np.linalg.norm(left, axis=1)
    if surface.triangulation.crease is not None:
        # Beside a crease parameters change fast along the surface, which is no distance from it.
        size = np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)
        away = np.abs(np.einsum("ni,ni->n", left, normals)) / size
    far = (np.linalg.norm(way, axis=1) > _NEAR * spacing) | (away >= np.quantile(away, 1 - _WORST))
    chosen = np.append(np.arange(given), np.flatnonzero(far))
    start = samples.take(chosen)
    away[chosen] = feet_of(basis, coefficients, start.points, start.values, spacing, jets=jets[:, chosen]).distance
    return jets[0], away, normals


def _tilt(normals: Floats, vectors: Floats) -> float:
    """The angle between facets and the normals of the surface, up to their signs, in degrees."""
    area, size = np.linalg.norm(vectors, axis=1), np.linalg.norm(normals, axis=1)
    cosine = np.abs(np.einsum("fi,fi->f", normals, vectors)) / np.maximum(area * size, np.finfo(float).tiny)
    return float(np.degrees(np.sqrt(area @ np.arccos(np.minimum(cosine, 1.0)) ** 2 / area.sum())))


def _require_sane(there: Floats, values: Floats, weights: Floats) -> None:
    """Raises FitError for a surface that is no better than the centroid of the mesh, or far outside of the mesh."""
    share = weights / weights.sum()
    centroid = share @ values
    constant = float(np.sqrt(share @ ((values - centroid) ** 2).sum(axis=1)))
    rms = float(np.sqrt(share @ ((values - there) ** 2).sum(axis=1)))
    if not rms < constant:
        raise FitError(
            f"the surface is off by {rms:.2g} of the diagonal, and a single point by {constant:.2g}: so few functions "
            "do not follow this mesh; raise the option size, or choose another basis (basis.name = 'gaussian')"
        )
    radius = float(np.linalg.norm(values - centroid, axis=1).max())
    reached = float(np.linalg.norm(there - centroid, axis=1).max())
    if reached > (1 + _TOO_FAR) * radius:
        raise FitError(
            f"the surface reaches {reached / radius:.2g} times as far from its middle as the mesh: so few functions do "
            "not follow this mesh; raise the option size or the option fairing, or choose another basis"
        )


def _sound(border: Border, size: int) -> Border:
    """The boundary of a surface; raises FitError for one that goes as far from that of the mesh as that is large."""
    farthest = border.surface_to_mesh[1]
    if not farthest <= _TOO_FAR / 2:
        raise FitError(
            f"the boundary of the surface goes {farthest:.2g} diagonals away from that of the mesh: beside holes it "
            f"does not determine {size} functions; take fewer, such as --size {max(size // 8, 50)}, or fill small holes"
        )
    return border


def _distances(away: Floats, weights: Floats, where: Floats) -> Distances:
    share = weights / weights.sum()
    return Distances(float(np.sqrt(share @ away**2)), float(share @ away), tuple(_farthest(away, where)))


def _farthest(away: Floats, where: Floats) -> Iterator[Place]:
    """The places of the largest distances, none near one before it."""
    left = away.copy()
    for _ in range(PLACES):
        worst = first_largest(left)
        if not left[worst] >= 0:
            return
        x, y, z = (float(number) for number in where[worst])
        yield Place(float(away[worst]), (x, y, z))
        left[np.linalg.norm(where - where[worst], axis=1) < APART] = -1.0
