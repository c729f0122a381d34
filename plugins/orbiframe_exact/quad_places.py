"""Quad places: where the vertices of the mesh lie in the quadrilaterals of a domain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.triangulations import Locator
from orbiframe_exact.quad_domain import QuadDomain

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def places_in_quads(domain: QuadDomain) -> tuple[Ints, Floats, Floats, Floats]:
    """The quadrilateral, the parameters s and t, and the area about every vertex of the refined mesh, (n,) each."""
    surface = domain.points.surface
    mesh = surface.triangulation.polyhedron
    found = Locator(domain.triangles).locate(surface.vertex_points)
    quad, x = _in_quads(domain, found.face, found.columns[:, :, 0])
    s, t = domain.points.parameters(quad, x)
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    each = np.repeat(np.linalg.norm(np.cross(b - a, c - a), axis=1), 3)
    about: Floats = np.bincount(mesh.triangles.ravel(), weights=each, minlength=len(mesh.vertices)).astype(float)
    return quad, s, t, about[found.order]


def _in_quads(domain: QuadDomain, face: Ints, x: Floats) -> tuple[Ints, Floats]:
    """The quadrilaterals of points x (n, 3) of triangles, and the points in their frames.

    A point of a triangle that is divided belongs to the corner of which it has most.
    """
    if domain.into is not None:
        return domain.pair[face], np.einsum("nij,nj->ni", domain.into[face], x)
    corners = domain.points.corners.reshape(-1, 3, 4, 3)[face, :, 0]
    share = np.linalg.solve(np.swapaxes(corners, 1, 2), x[:, :, None])[:, :, 0]
    return 3 * face + share.argmax(axis=1), x
