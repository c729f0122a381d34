"""Small surfaces with exact patches, and points of theirs that are found without the patches."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from orbiframe import Fitter, OrbifoldSurface, Points, Registry, Samples, Triangulation
from orbiframe.functions.samples import coordinate_samples
from orbiframe.meshes.sizes import vector_areas
from orbiframe.orbifolds import FlatLattice
from orbiframe.testing.reference import reference_surface

REGISTRY = Registry.discover()


@cache
def surface_of(name: str, basis: str, **options: object) -> OrbifoldSurface:
    """A reference polyhedron approximated by some functions, moved and scaled in space; shared, so read-only."""
    first = reference_surface(name, "ps2")
    made = REGISTRY.load("basis", basis)(first.orbifold, first.triangulation, **{"size": 120, **options})
    fitter: Fitter = REGISTRY.load("fitter", "least-squares")()
    coefficients = fitter.fit(made, samples_for(first.triangulation, made.size))
    return replace(
        first, basis=made, basis_name=basis, coefficients=coefficients, origin=np.array([1.0, -2.0, 0.5]), scale=1.5
    )


def samples_for(triangulation: Triangulation, size: int) -> Samples:
    """The samples of a map; where there are fewer than functions, with fairness at ten places of every triangle too."""
    data = coordinate_samples(triangulation)
    if len(data.weights) >= size:
        return data
    count = 10 * triangulation.polyhedron.face_count
    face, shares = np.repeat(np.arange(count // 10), 10), np.random.default_rng(0).dirichlet([1, 1, 1], size=count)
    more, none = triangulation.locate(face, shares), np.zeros(count)
    area = np.repeat(np.linalg.norm(vector_areas(triangulation.polyhedron), axis=1) / 10, 10)
    return Samples(
        Points(np.append(data.points.patch, more.patch), np.concatenate([data.points.x, more.x])),
        np.concatenate([data.values, np.zeros((count, 3))]),
        np.append(data.weights, none),
        np.append(data.stretch, np.repeat(triangulation.areas / 10, 10) / np.maximum(area, 1e-300)),
        np.append(0 * data.weights, area),
    )


def round_torus(surface: OrbifoldSurface) -> OrbifoldSurface:
    """The same functions on a torus, with coefficients of a round one: it has an inside, so files can lie about it."""
    lattice = FlatLattice.of(surface.orbifold)

    def places(points: Points) -> np.ndarray:
        u, v = 2 * np.pi * lattice.coordinates(points).T
        return np.stack([(3 + np.cos(v)) * np.cos(u), (3 + np.cos(v)) * np.sin(u), np.sin(v)], axis=1)

    return embedded(surface, places)


def embedded(surface: OrbifoldSurface, places: Callable[[Points], np.ndarray]) -> OrbifoldSurface:
    """The same functions with the coefficients that come nearest to given places, at ten points of every triangle."""
    triangulation = surface.triangulation
    face = np.repeat(np.arange(triangulation.polyhedron.face_count), 10)
    points = triangulation.locate(face, np.random.default_rng(6).dirichlet([1, 1, 1], size=len(face)))
    coefficients = np.linalg.lstsq(surface.basis.design_matrix(points).toarray(), places(points), rcond=None)[0]
    return replace(surface, coefficients=coefficients, origin=np.zeros(3), scale=1.0)


def on_cells(surface: OrbifoldSurface, barycentric: np.ndarray) -> np.ndarray:
    """The surface at barycentric coordinates (m, 3) of each micro triangle, (N, m, 3), by its own evaluation."""
    basis = surface.basis
    flat = np.einsum("mc,fkcj->fkmj", barycentric, basis.micro_triangles)
    inner = basis.domain.geometry.project(flat)
    x = np.einsum("fij,fkmj->fkmi", basis.domain.placement, inner)
    patch = np.broadcast_to(basis.domain.patch[:, None, None], x.shape[:3]).ravel()
    return surface.evaluate(Points(patch, x.reshape(-1, 3))).reshape(-1, len(barycentric), 3)


def at_lattice(surface: OrbifoldSurface, place: np.ndarray) -> np.ndarray:
    """The surface at lattice coordinates (n, 2), by its own evaluation."""
    lattice = surface.basis.lattice
    plane = (place @ lattice.basis.T - lattice.shift[0]) @ np.linalg.inv(lattice.linear[0]).T
    return surface.evaluate(Points(np.zeros(len(place), dtype=np.intp), np.insert(plane, 0, 1.0, axis=1)))
