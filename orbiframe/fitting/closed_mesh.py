"""Closed mesh: what is mapped to X/H for a mesh with a boundary, and which of its triangles belong to the mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import ConfigError
from orbiframe.fitting.config import Boundary, Config
from orbiframe.fitting.correspondence import Correspondence
from orbiframe.fitting.mapping import Mapping
from orbiframe.fitting.size import LEAST_SIZE
from orbiframe.fitting.stages import Stages
from orbiframe.meshes.closing import Closing, closed_by
from orbiframe.meshes.face_diagonals import cut_into_triangles, triangulated
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import area
from orbiframe.meshes.surface_type import surface_type

# A collar is as wide as so many functions of mean spacing.
_FUNCTIONS_ACROSS = 6.0


def mapping_of(mesh: Polyhedron, config: Config, stages: Stages, like: Correspondence | None = None) -> Mapping:
    """The maps of a mesh of unit size; one with a boundary is closed first, as the configuration says.

    "auto" takes the double of an annulus or a Möbius band, which is flat, else the collar. Raises TopologyError for
    boundary loops that cannot be closed. like: whose map is taken over, and how that mesh was closed.
    """
    if (mesh.twin >= 0).all():
        triangles = stages("triangles", triangulated, mesh)
        return Mapping(mesh, triangles, surface_type(mesh), config, stages, like=like)
    if config.data.creases is not None:
        raise ConfigError(
            "creases (data.creases) are kept on closed meshes only so far; leave them out, or close the mesh in a mesh "
            "editor"
        )
    how = _way(mesh, config.boundary)
    if like is not None:
        whole, own = like.closed(triangulated(mesh))
        return Mapping(whole, whole, surface_type(whole), config, stages, own, how, like)
    return _closed(mesh, how, config, stages)


def _way(mesh: Polyhedron, boundary: Boundary) -> Closing:
    """How the mesh is closed; a mesh with a boundary is refused before where the configuration says so."""
    if boundary in ("cap", "collar", "double"):
        return boundary
    return "double" if surface_type(mesh).euler_characteristic == 0 else "collar"


def _size(config: Config) -> int:
    """The number of functions that is asked for, or the least that is taken."""
    size = config.basis.options.get("size")
    return LEAST_SIZE if size is None else int(size)


def _closed(mesh: Polyhedron, how: Closing, config: Config, stages: Stages) -> Mapping:
    width = _FUNCTIONS_ACROSS * float(np.sqrt(area(mesh) / _size(config)))
    whole = stages("closing", closed_by, mesh, how, width)
    triangles = stages("triangles", triangulated, whole)
    own: NDArray[np.bool_] = cut_into_triangles(whole).face < mesh.face_count
    return Mapping(whole, triangles, surface_type(whole), config, stages, own, how)
