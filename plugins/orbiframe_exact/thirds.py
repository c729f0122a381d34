"""Thirds: every triangle as three quadrilaterals about its corners, which are convex whatever the triangle is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.triangulations import GeodesicTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def thirds(d: GeodesicTriangulation, x: Floats) -> tuple[Floats, Ints, Ints]:
    """Three quadrilaterals in every triangle: corners (3 F, 4, 3), edges (3 F, 4), and the ends of these, (E, 2).

    x: (F, 3, 3), vectors on the rays of the corners of the triangles, of the same length wherever a vertex is. Edges
    are both halves of every edge of the triangulation, which run to its middle, that at the start of its reference
    halfedge first; then the lines from the middles to the centroids. Vertices are those of the triangulation, the
    middles of its edges, and the centroids.
    """
    middle = (x + np.roll(x, -1, axis=1)) / 2
    centre = np.broadcast_to(x.mean(axis=1, keepdims=True), x.shape)
    corners = np.stack([x, middle, centre, np.roll(middle, 1, axis=1)], axis=2).reshape(-1, 4, 3)
    here = np.arange(3 * d.face_count)
    before = here - here % 3 + (here + 2) % 3
    ahead = d.reference | d.same
    first, last = 2 * d.edge + ~ahead, 2 * d.edge + ahead
    inner = 2 * d.edge_count + here
    edge = np.stack([first, inner, inner[before], last[before]], axis=1)
    start, half = d.vertex.ravel(), np.flatnonzero(d.reference)
    ends = np.empty((2 * d.edge_count + len(here), 2), dtype=np.intp)
    ends[: 2 * d.edge_count : 2, 0] = start[half]
    ends[1 : 2 * d.edge_count : 2, 0] = start[half - half % 3 + (half + 1) % 3]
    ends[: 2 * d.edge_count, 1] = d.vertex_count + np.arange(2 * d.edge_count) // 2
    ends[2 * d.edge_count :, 0] = d.vertex_count + d.edge
    ends[2 * d.edge_count :, 1] = d.vertex_count + d.edge_count + here // 3
    return corners, edge, ends
