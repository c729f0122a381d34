"""Edges seen from both of their triangles: normals that the two sides share, and in which direction the edge runs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]


def shared_normals(domain: GeodesicTriangulation) -> Floats:
    """One normal for every edge, as long as the edge, seen from both of its triangles: (3 F, 3) by halfedges.

    The normal looks into the triangle of the reference halfedge; the gluing of a halfedge takes the normal of its twin
    to its own, so that derivatives along it mean the same on both sides. See `edge_normals`, whose all look inwards.
    """
    inwards = edge_normals(domain).reshape(-1, 3)
    return np.asarray(np.where(domain.reference[:, None], inwards, -inwards))


def along_reference(domain: GeodesicTriangulation) -> NDArray[np.bool_]:
    """Each halfedge starts where the reference halfedge of its edge does, (3 F,)."""
    return np.asarray(domain.reference | domain.same)


def edge_normals(domain: GeodesicTriangulation) -> Floats:
    """Normals of the edges that look into their triangles, as long as the edges, (F, 3, 3).

    n = |e| J w / sqrt(w J w) with w = v_c x v_(c + 1) and J = diag(K, 1, 1), in the frame of each triangle: a vector
    that is tangent to X and orthogonal to the edge all along it. The gluing takes the normal of the twin to -n.
    """
    x = domain.corners
    across = np.cross(x, np.roll(x, -1, axis=1))
    normal = across * np.array([domain.geometry.curvature, 1.0, 1.0])
    length = np.sqrt((across * normal).sum(axis=-1))
    return np.asarray(normal * (domain.edge_lengths.reshape(-1, 3) / length)[..., None])
