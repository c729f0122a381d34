"""Meshes with creases, and their maps, sites and surfaces, made once and shared by tests."""

from __future__ import annotations

from functools import cache

import numpy as np
from fitted import DATASETS, REGISTRY

from orbiframe.delaunay.crease_domain import creased
from orbiframe.delaunay.crease_sites import Asked
from orbiframe.files import gate
from orbiframe.fitting import pipeline
from orbiframe.fitting.config import Config
from orbiframe.fitting.pipeline import Result
from orbiframe.meshes.bending import sharp_edges
from orbiframe.meshes.bisection import Bisection, bisected
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.triangulations.triangulation import Triangulation


def cylinder(sides: int, rows: int = 1) -> Polyhedron:
    """A cylinder of radius 1/2 and height 1 about the third axis: its vertices lie on it, as do its straight edges."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angle) / 2, np.sin(angle) / 2], axis=1)
    vertices = np.concatenate([np.column_stack([ring, np.full(sides, k / rows)]) for k in range(rows + 1)])
    walls = [
        [k * sides + i, k * sides + (i + 1) % sides, (k + 1) * sides + (i + 1) % sides, (k + 1) * sides + i]
        for k in range(rows)
        for i in range(sides)
    ]
    lid = [rows * sides + i for i in range(sides)]
    return Polyhedron.from_faces(vertices, [*walls, list(range(sides))[::-1], lid])


def rounded_bar(steps: int = 6, width: float = 4.0, radius: float = 0.5) -> Polyhedron:
    """A prism over a square with two round corners: planes that end in quarters of a cylinder, along its length."""
    turn = np.pi / 2 * np.arange(steps + 1) / steps
    arc = radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    inner = width - radius
    other = np.stack([-arc[:, 1], arc[:, 0]], axis=1) + np.array([radius, inner])
    outline = np.concatenate([arc + inner, other, np.array([[0, 0], [width, 0]])])
    count = len(outline)
    vertices = np.concatenate([np.column_stack([outline, np.full(count, z)]) for z in (0.0, 3.0)])
    walls = [[i, (i + 1) % count, count + (i + 1) % count, count + i] for i in range(count)]
    return triangulated(
        Polyhedron.from_faces(vertices, [*walls, list(range(count))[::-1], list(range(count, 2 * count))])
    )


def wedge() -> Polyhedron:
    """A prism over a thin triangle, whose edge along the third axis turns by 166 degrees."""
    outline = np.array([[0, 0], [4, 0], [4, 1]])
    vertices = np.concatenate([np.column_stack([outline, np.full(3, z)]) for z in (0.0, 2.0)])
    return Polyhedron.from_faces(vertices, [[2, 1, 0], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]])


@cache
def mesh_of(name: str) -> Polyhedron:
    """A mesh by name, triangles only."""
    made = {"cylinder": lambda: cylinder(24), "rounded bar": rounded_bar, "wedge": wedge}
    return triangulated(made[name]() if name in made else gate.read(DATASETS / name, REGISTRY))


@cache
def mapped(name: str, angle: float = 30, size: int = 400) -> tuple[Triangulation, Bisection]:
    """The map of a mesh with creases and sites for clough-tocher, and the refinement that was mapped."""
    result = fitted_with_creases(name, angle, size)
    return result.surface.triangulation, result.surface.refinement


@cache
def fitted_with_creases(name: str, angle: float = 30, size: int = 400, *overrides: str) -> Result:
    """The fit of a mesh with creases."""
    words = [f"basis.size={size}", f"data.creases={angle}", "output.refine=1", *overrides]
    return pipeline.fit(mesh_of(name), Config.load(overrides=words), REGISTRY)


@cache
def flat_map(name: str, longest: float = 0.04) -> tuple[Triangulation, Bisection]:
    """The map of a mesh as the pipeline makes it, without creases."""
    mesh = mesh_of(name)
    refinement = bisected(mesh, longest * mesh.diagonal, True)
    geometry = REGISTRY.geometry(len(mesh.vertices) - mesh.edge_count + mesh.face_count)
    method = {"s2": "sphere"}.get(geometry.name, "harmonic")
    return REGISTRY.load("parametrizer", method)(refinement.polyhedron, geometry, None), refinement


@cache
def placed(name: str, size: int = 300, angle: float = 30) -> Triangulation:
    """The same with creases and sites for ps2."""
    triangulation, refinement = flat_map(name)
    return creased(triangulation, sharp_edges(refinement.polyhedron, angle), Asked(size, (3, 0, 0)))
