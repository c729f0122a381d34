"""Curved triangles: elements of an order on the even triangles of a surface."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np

from orbiframe import Polyhedron
from orbiframe.surfaces import CurvedMesh, GeodesicFaces, curved_mesh, node_exponents
from orbiframe_remeshing.lifted_edges import lifted
from orbiframe_remeshing.surface_mesh import Rim, SurfaceMesh

# What angles in X may lack to 2 pi, in radians.
_ROUNDING = 1e-6


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
    if not (faces.whole if mesh.rim is None else _unfolded(faces, mesh)):
        warnings.warn(
            "some elements are folded, where the surface is narrow or bends much within one of them; take more "
            "vertices, and look at the Jacobians",
            stacklevel=2,
        )
    found = curved_mesh(mesh.surface, faces, order)
    return found if mesh.rim is None else _with_rim(found, mesh, mesh.rim)


def _unfolded(faces: GeodesicFaces, mesh: SurfaceMesh) -> bool:
    """Whether the angles in X at every vertex off the boundary add up to 2 pi: where triangles fold they are more."""
    x = faces.corners
    angles = np.abs(faces.orbifold.geometry.angle(x, np.roll(x, -1, axis=1), np.roll(x, 1, axis=1)))
    total = np.bincount(mesh.triangles.ravel(), weights=angles.ravel(), minlength=len(mesh.places))
    return bool(np.abs(total[~mesh.fixed] - 2 * np.pi).max(initial=0.0) < _ROUNDING)


def _with_rim(curved: CurvedMesh, mesh: SurfaceMesh, rim: Rim) -> CurvedMesh:
    """The elements with their nodes on the boundary moved along it: the sides of triangles are geodesics of X."""
    count, triangles = len(mesh.places), mesh.triangles
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    side = np.concatenate([start * count + end, end * count + start])
    order = np.argsort(side, kind="stable")
    at = order[np.searchsorted(side[order], rim.ends[:, 0] * count + rim.ends[:, 1])]
    face, corner = np.divmod(at % len(start), 3)
    corner, other = np.where(at < len(start), [corner, (corner + 1) % 3], [(corner + 1) % 3, corner])
    exponents, nodes = node_exponents(curved.order), curved.nodes.copy()
    for k in range(1, curved.order):
        wanted = np.zeros((len(face), 3), dtype=np.intp)
        wanted[np.arange(len(face)), corner], wanted[np.arange(len(face)), other] = curved.order - k, k
        place = (exponents[None] == wanted[:, None]).all(axis=2).argmax(axis=1)
        nodes[curved.elements[face, place]] = mesh.surface.evaluate(rim.along(k / curved.order))
    return replace(curved, nodes=nodes)
