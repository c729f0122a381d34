"""Points spread over the faces of a mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def points_of_faces(vertices: Floats, triangles: Ints, count: int) -> tuple[Ints, Floats]:
    """Points spread at random over triangles, and the triangle of each."""
    rng = np.random.default_rng(7)
    corners = vertices[triangles]
    area = np.linalg.norm(np.cross(*np.moveaxis(np.diff(corners, axis=1), 1, 0)), axis=1)
    face = np.searchsorted(np.cumsum(area) / area.sum(), (np.arange(count) + rng.uniform(size=count)) / count)
    weights = rng.dirichlet(np.ones(3), count)
    return face, np.einsum("nc,nci->ni", weights, corners[face])
