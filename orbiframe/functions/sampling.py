"""Sampling: the coordinate functions of a mesh as samples on X/H."""

from __future__ import annotations

import numpy as np

from orbiframe.orbifolds.atlas import Points
from orbiframe.functions.samples import Samples
from orbiframe.meshes.surface_type import vector_areas
from orbiframe.triangulations.triangulation import Triangulation


def coordinate_samples(triangulation: Triangulation) -> Samples:
    """The positions in space at the vertices and the face centroids, weighted by area in space.

    A vertex has a twelfth of the area of each of its triangles, a centroid three quarters: exact for quadratic
    functions on each triangle. The stretch at a vertex is that of its faces together.
    """
    mesh = triangulation.polyhedron
    area = np.linalg.norm(vector_areas(mesh), axis=1)
    count = len(mesh.vertices)
    around = np.bincount(mesh.tail, weights=np.repeat(area, 3), minlength=count)
    image = np.bincount(mesh.tail, weights=np.repeat(triangulation.areas, 3), minlength=count)
    centroids = triangulation.locate(np.arange(mesh.face_count), np.full((mesh.face_count, 3), 1 / 3))
    points = Points(
        np.concatenate([triangulation.patch, centroids.patch]), np.concatenate([triangulation.points, centroids.x])
    )
    values = np.concatenate([mesh.vertices, mesh.vertices[mesh.triangles].mean(axis=1)])
    weights = np.concatenate([around / 12, 0.75 * area])
    tiny = np.finfo(float).tiny
    stretch = np.concatenate([image / np.maximum(around, tiny), triangulation.areas / np.maximum(area, tiny)])
    kept = weights > 0
    return Samples(Points(points.patch[kept], points.x[kept]), values[kept], weights[kept], stretch[kept])
