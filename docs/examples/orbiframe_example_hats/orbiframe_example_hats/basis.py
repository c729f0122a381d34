"""Hats: polynomial bumps (1 - t)^4 about evenly spread centres."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import Orbifold, Points, Triangulation
from orbiframe.functions import OrbitSumBasis
from orbiframe.meshes import edge_graph, farthest_points

Floats = NDArray[np.float64]


class Hats(OrbitSumBasis):
    """Bumps (1 - t)^4, where t is 0 at the centre and 1 at the rim, summed over the group and divided by their sum.

    size: how many functions; reach: the area of a bump, over the area that is nearest to its centre.
    """

    smoothness = 3

    def __init__(
        self, orbifold: Orbifold, triangulation: Triangulation, *, size: int = 500, reach: float = 12.0
    ) -> None:
        mesh = triangulation.polyhedron
        spacing = farthest_points(edge_graph(mesh), size)
        nearest = spacing.owner[mesh.tail]
        area = np.bincount(nearest, np.repeat(triangulation.areas / 3, 3), minlength=size)
        centres = Points(triangulation.patch[spacing.chosen], triangulation.points[spacing.chosen])
        super().__init__(orbifold, centres, reach * area / (2 * np.pi))

    def profile(self, t: Floats) -> tuple[Floats, ...]:
        """(1 - t)^4 and its first two derivatives, and 0 from t = 1 on."""
        rest = np.maximum(1 - t, 0)
        return rest**4, -4 * rest**3, 12 * rest**2
