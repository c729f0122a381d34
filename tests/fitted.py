"""Surfaces fitted once and shared by tests."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from orbiframe.components.registry import Registry
from orbiframe.fitting import pipeline
from orbiframe.fitting.config import Config
from orbiframe.fitting.pipeline import Result
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.polyhedra import reference_polyhedra

DATASETS = Path(__file__).parents[1] / "datasets"
REGISTRY = Registry.discover()


def config(size: int, *overrides: str) -> Config:
    return Config.load(overrides=[f"basis.size={size}", "output.refine=1", *overrides])


@cache
def fitted(name: str, size: int = 120) -> Result:
    """The fit of a reference polyhedron, a dataset "….off" or one of the meshes below."""
    return pipeline.fit(mesh_of(name), config(size), REGISTRY)


@cache
def fitted_linearly(name: str, size: int = 120) -> Result:
    """The same by one linear fit: calm surfaces, whose edges are not drawn sharp."""
    linear = config(size, "fitter.name=least-squares", "data.lift=false", "data.means=facets")
    return pipeline.fit(mesh_of(name), linear, REGISTRY)


def mesh_of(name: str) -> Path | Polyhedron:
    if name.endswith(".off"):
        return DATASETS / name
    return MESHES[name]() if name in MESHES else reference_polyhedra()[name]


def grid(along: int, across: int, place: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Polyhedron:
    """A torus of quads at place(u, v), with angles u and v."""
    i, j = np.divmod(np.arange(along * across), across)
    right, up = (i + 1) % along, (j + 1) % across
    faces = np.stack([i * across + j, right * across + j, right * across + up, i * across + up], axis=1)
    return Polyhedron.from_faces(place(2 * np.pi * i / along, 2 * np.pi * j / across), faces)


def round_torus(big: float = 3.0, small: float = 1.0) -> Polyhedron:
    """A torus of revolution, fine enough that its samples lie on it to 1e-3; normals point outwards."""

    def place(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        ring = big + small * np.cos(v)
        return np.stack([ring * np.cos(u), ring * np.sin(u), small * np.sin(v)], axis=1)

    return grid(120, 48, place)


def round_sphere(radius: float = 2.0) -> Polyhedron:
    """An octahedron cut fine and projected to a sphere."""
    from orbiframe.meshes.subdivision import refine

    corners = np.concatenate([np.eye(3), -np.eye(3)])
    faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    fine = refine(Polyhedron.from_faces(corners, faces), 28).polyhedron
    return fine.with_vertices(radius * fine.vertices / np.linalg.norm(fine.vertices, axis=1, keepdims=True))


MESHES = {"round torus": round_torus, "round sphere": round_sphere}
