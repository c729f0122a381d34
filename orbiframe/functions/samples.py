"""Samples: values of functions at points of X/H, with weights; those of a mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import FitError
from orbiframe.meshes.sizes import vector_areas
from orbiframe.orbifolds.atlas import Points
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Samples:
    """What a fitter approximates: d functions at n points of X/H.

    points: n points of X/H; values: (n, d); weights: (n,), positive, of any scale (area in space, say); stretch: (n,),
    area in X per area in space near each point, which turns Laplacians on X/H into Laplacians on the surface. Raises
    FitError if the shapes do not fit, for a value that is not finite, and for a weight or stretch that is negative.
    """

    points: Points
    values: Floats
    weights: Floats
    stretch: Floats

    def __post_init__(self) -> None:
        count = len(self.points.patch)
        shapes = [np.shape(a) for a in (self.points.x, self.values, self.weights, self.stretch)]
        if shapes != [(count, 3), (count, *shapes[1][1:2]), (count,), (count,)] or len(shapes[1]) != 2:
            raise FitError(
                f"{count} samples have points, values, weights and stretch of shapes {shapes}; they must be (n, 3), "
                "(n, d), (n,) and (n,)"
            )
        _require("value", np.all(np.isfinite(self.values), axis=1), self.values, "finite")
        for name, numbers in (("weight", self.weights), ("stretch", self.stretch)):
            _require(name, np.isfinite(numbers) & (numbers >= 0), numbers, "finite and not negative")

    def take(self, chosen: Ints) -> Samples:
        """Some of the samples, in the order of the indices `chosen`."""
        points = Points(self.points.patch[chosen], self.points.x[chosen])
        return Samples(points, self.values[chosen], self.weights[chosen], self.stretch[chosen])


def _require(name: str, good: NDArray[np.bool_] | np.bool_, numbers: Floats, what: str) -> None:
    bad = np.flatnonzero(~good)
    if len(bad):
        raise FitError(f"sample {bad[0]} has the {name} {numbers[bad[0]]}; it must be {what}: check the mesh")


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
