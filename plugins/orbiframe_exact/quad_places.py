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
    assert domain.into is not None
    surface = domain.points.surface
    mesh = surface.triangulation.polyhedron
    found = Locator(domain.triangles).locate(surface.vertex_points)
    quad = domain.pair[found.face]
    x = np.einsum("nij,nj->ni", domain.into[found.face], found.columns[:, :, 0])
    s, t = domain.points.parameters(quad, x)
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    each = np.repeat(np.linalg.norm(np.cross(b - a, c - a), axis=1), 3)
    about = np.bincount(mesh.triangles.ravel(), weights=each, minlength=len(mesh.vertices))
    return quad, s, t, about[found.order]
