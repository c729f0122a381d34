"""Regular faces: the shape that the triangles of a polyhedron would have if all its faces were regular."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.face_diagonals import cut_into_triangles
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]


def regular_triangles(polyhedron: Polyhedron) -> Floats:
    """The triangles of `triangulated(polyhedron)` in the plane, (T, 3, 2), where every face is a regular polygon.

    All sides have length 1 and corners run counterclockwise, so that the triangles of neighbouring faces fit along
    their common edge: together they are a surface with a flat metric and cones at the vertices.
    """
    cut = cut_into_triangles(polyhedron)
    size = polyhedron.face_sizes[polyhedron.face]
    turn = 2 * np.pi * (np.arange(len(polyhedron.tail)) - polyhedron.offsets[polyhedron.face]) / size
    radius = 0.5 / np.sin(np.pi / size)
    return cut.with_middles(np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=-1))[cut.corners]
