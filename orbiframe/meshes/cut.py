"""Cut: the faces of a polyhedron as triangles between its corners and new points inside of faces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Cut:
    """The faces of a polyhedron cut into triangles, in the order of the faces.

    corners: (T, 3), corners (halfedges) of the polyhedron, or H + k for new point k; face: (T,), the face of each
    triangle; between: (K, 2), the two corners of a face that each new point is the middle of.
    """

    polyhedron: Polyhedron
    corners: Ints
    face: Ints
    between: Ints

    @property
    def sides(self) -> tuple[Ints, Ints]:
        """The corners at which the sides of all triangles start and end, (3T,) each."""
        return self.corners.ravel(), np.roll(self.corners, -1, axis=1).ravel()

    @property
    def on_outline(self) -> Bools:
        """The sides (3T,) that are edges of the polyhedron."""
        start, end = self.sides
        following = np.concatenate([self.polyhedron.next, np.full(len(self.between), -1)])
        return np.asarray(following[start] == end)

    @property
    def vertex(self) -> Ints:
        """The vertex of every corner and new point, (H + K,); those of new points follow those of the polyhedron."""
        return np.concatenate([self.polyhedron.tail, len(self.polyhedron.vertices) + np.arange(len(self.between))])

    def with_middles(self, table: Floats) -> Floats:
        """A table of the corners (H, ...) with rows for the new points, the means of the two they lie between."""
        return np.concatenate([table, table[self.between[:, 0]] / 2 + table[self.between[:, 1]] / 2])
