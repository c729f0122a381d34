"""Bending: how a triangle mesh bends at its edges, and how much of that in sharp ones."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

SHARP = np.radians(40)
_ROUNDING = 1e-6


class Bending(NamedTuple):
    """angle: (H,), by which the normal turns across each halfedge, 0 to pi, the same for twins; share: how much of the
    sum of length times angle over all edges lies in edges sharper than 40 degrees, 0 where nothing bends.
    """

    angle: Floats
    share: float


def sharp_edges(mesh: Polyhedron, degrees: float) -> Bools:
    """The halfedges across which a mesh bends by so many degrees or more, (H,)."""
    return np.asarray(bending(mesh).angle >= np.radians(degrees) - _ROUNDING)


def bending(mesh: Polyhedron) -> Bending:
    """The bending of a mesh; open edges and faces without area bend nothing."""
    normal = vector_areas(mesh)
    size = np.linalg.norm(normal, axis=1)
    unit = normal / np.maximum(size, np.finfo(float).tiny)[:, None]
    here, there = unit[mesh.face], unit[mesh.face[mesh.twin]] * np.where(mesh.same, -1.0, 1.0)[:, None]
    angle = 2 * np.arctan2(np.linalg.norm(here - there, axis=1), np.linalg.norm(here + there, axis=1))
    angle[(size[mesh.face] == 0) | (size[mesh.face[mesh.twin]] == 0) | (mesh.twin < 0)] = 0
    amount = mesh.edge_lengths * angle
    total = amount.sum()
    return Bending(angle, float(amount[angle > SHARP].sum() / total) if total > 0 else 0.0)
