"""Fitted surfaces: one smooth surface for each component of a mesh, with the vertices that it belongs to."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe import Config, OrbifoldSurface, Polyhedron, Registry, fit
from orbiframe.meshes import require_closed_surface

Ints = NDArray[np.intp]

# Twice differentiable functions, and as many of them as a mesh of some thousand vertices can determine.
_BASIS = "basis.name=ps6"
_LEAST, _MOST = 1500, 3000


class FittedSurface(NamedTuple):
    """A surface, the part of the mesh that it was fitted to, and the numbers of that part's vertices in the mesh."""

    surface: OrbifoldSurface
    part: Polyhedron
    vertices: Ints
    means: str


def fitted_surfaces(
    mesh: Polyhedron,
    config: Path | None,
    options: list[str],
    registry: Registry,
    progress: Callable[[str, float | None], None],
    *,
    least: int = _LEAST,
) -> list[FittedSurface]:
    """The smooth surfaces of the components of a mesh, by the configuration; in C2 splines unless that says else.

    least: the least number of functions, as far as the most that are taken without being asked for.
    Raises what `fit` raises.
    """
    boundary = Config.load(config, options, registry).boundary
    require_closed_surface(mesh, several=True, boundary=boundary != "error")
    found = []
    for vertices, part in _parts(mesh):
        size = int(np.clip(max(len(vertices), least), _LEAST, _MOST))
        settings = Config.load(config, [_BASIS, f"basis.size={size}", *options], registry)
        result = fit(part, settings, registry, progress)
        found.append(FittedSurface(result.surface, part, vertices, result.report["data"]["means"]))
    return found


def _parts(mesh: Polyhedron) -> list[tuple[Ints, Polyhedron]]:
    """The components, each with the numbers of its vertices; vertices in no face belong to none."""
    count = len(mesh.vertices)
    links = coo_array((np.ones(len(mesh.tail)), (mesh.tail, mesh.head)), shape=(count, count))
    label = connected_components(links, directed=False)[1]
    parts = []
    for number in np.unique(label[mesh.tail]):
        vertices = np.flatnonzero(label == number)
        sizes = mesh.face_sizes[label[mesh.tail[mesh.offsets[:-1]]] == number]
        corners = np.searchsorted(vertices, mesh.tail[label[mesh.tail] == number])
        offsets = np.concatenate([[0], np.cumsum(sizes)])
        parts.append((vertices, Polyhedron.from_corners(mesh.vertices[vertices], offsets, corners)))
    return parts
