"""Curved triangles: elements of an order on the even triangles of a surface."""

from __future__ import annotations

import warnings

import numpy as np

from orbiframe import Polyhedron
from orbiframe.surfaces import CurvedMesh, GeodesicFaces, curved_mesh
from orbiframe_remeshing.lifted_edges import lifted
from orbiframe_remeshing.surface_mesh import SurfaceMesh


def curved(mesh: SurfaceMesh, order: int) -> CurvedMesh:
    """The elements that interpolate the surface over the geodesic triangles between the vertices.

    Flips by angles in space know nothing of X: where a triangle has become one that is folded over in X, there is a
    warning.
    """
    orbifold, points, triangles = mesh.surface.orbifold, mesh.points, mesh.triangles
    first = triangles[:, 0]
    corners = [points.x[first], *(lifted(orbifold, points, first, triangles[:, k]) for k in (1, 2))]
    gluing = Polyhedron.from_faces(mesh.places, triangles)
    faces = GeodesicFaces(orbifold, gluing, points.patch[first], np.stack(corners, axis=1))
    if not faces.whole:
        warnings.warn(
            "some elements are folded, where the surface is narrow or bends much within one of them; take more "
            "vertices, and look at the Jacobians",
            stacklevel=2,
        )
    return curved_mesh(mesh.surface, faces, order)
