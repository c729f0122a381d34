"""Triangulation of X/H: a point of X/H for every vertex of a triangle mesh and a transition for every halfedge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe.atlas import Points
from orbiframe.orbifold import Orbifold
from orbiframe.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Triangulation:
    """The map from a triangle mesh in space to X/H, linear in the projective model on each triangle.

    polyhedron: the triangle mesh in space, with its connectivity; patch: (V,) and points: (V, 3), where each vertex
    lies; transition: (H,), the lifted edge of halfedge h from i to j runs from points[i] to
    atlas.isometry[transition[h]] points[j] in the frame of the patch of i.
    """

    orbifold: Orbifold
    polyhedron: Polyhedron
    patch: Ints
    points: Floats
    transition: Ints

    def lifts(self) -> Floats:
        """The corners of every triangle in the frame of the patch of its first corner, (F, 3, 3): [face, corner]."""
        raise NotImplementedError

    def locate(self, face: Ints, barycentric: Floats) -> Points:
        """The points of X/H at barycentric coordinates (n, 3) in triangles (n,)."""
        raise NotImplementedError
