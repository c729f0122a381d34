"""Influence: how the points of a surface move with the vertices of its mesh, and with its coefficients.

While map, functions, weights and fairing stay, the linear fit is a linear map: positions of vertices go to values at
the samples, these to coefficients by the factored equations, and these to points. One column of it, that of the vertex
that is picked, is a solution with the factor that is there; a picture while the vertex is dragged is the points before
plus this column times the way of the vertex.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array

from orbiframe import Basis, DifferentiableBasis, OrbifoldSurface, Points, Samples
from orbiframe.functions import PreparedFitter
from orbiframe.triangulations import GeodesicTriangulation, Locator

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_KEPT = 256  # columns of vertices


class Influence:
    """The linear maps from vertices (V, 3) and coefficients (size, 3) to points and derivatives at `points`.

    signs: (n,), of normals. jets: one sparse matrix (n, size) for the points, and two for the derivatives along the
    axes of X, of which the second has the sign, so that their cross product is the normal; none for functions that have
    none.
    """

    def __init__(
        self, surface: OrbifoldSurface, samples: Samples, points: Points, signs: Floats, fitter: PreparedFitter
    ) -> None:
        self.jets = _jets(surface.basis, points, signs)
        self._moved: Callable[[Floats], Floats] = fitter.prepared(surface.basis, samples)
        self._shares = shares_of_vertices(surface, samples.points)
        self.of_vertex = lru_cache(_KEPT)(self._of_vertex)

    def _of_vertex(self, vertex: int) -> Floats:
        """How much the coefficients move with a vertex, (size,)."""
        column = self._shares[:, [vertex]].toarray()
        return np.asarray(self._moved(column)[:, 0])

    def of_vertices(self, moves: Floats) -> Floats:
        """How the coefficients (size, 3) move where the vertices (V, 3) move so."""
        return np.asarray(self._moved(np.asarray(self._shares[:, : len(moves)] @ moves)))

    def shown(self, coefficients: Floats) -> Floats:
        """Points and derivatives, (1 or 3, n, d), of coefficients (size, d)."""
        return np.stack([np.asarray(matrix @ coefficients) for matrix in self.jets])

    def handles(self, count: int) -> tuple[Ints, Floats]:
        """For every function the one of the first `count` points where it is largest, and how large it is there."""
        values = csc_array(self.jets[0][:count])
        size = values.shape[1]
        place, peak = np.zeros(size, dtype=np.intp), np.zeros(size)
        for k in range(size):
            part = slice(values.indptr[k], values.indptr[k + 1])
            if part.stop > part.start:
                best = int(np.argmax(np.abs(values.data[part])))
                place[k], peak[k] = values.indices[part][best], values.data[part][best]
        return place, peak


def shares_of_vertices(surface: OrbifoldSurface, points: Points) -> csc_array:
    """How much of each vertex of the triangles of the input there is in the mesh at points of X/H, sparse (n, V)."""
    flat, refinement = surface.triangulation, surface.refinement
    domain = GeodesicTriangulation.of_map(flat)
    found = Locator(domain).locate(points)
    weights = np.linalg.solve(np.swapaxes(domain.corners[found.face], 1, 2), found.columns)[:, :, 0]
    weights = np.maximum(weights, 0)
    weights /= weights.sum(axis=1, keepdims=True)
    count = len(points.patch)
    in_fine = csr_array(
        (weights.ravel(), (np.repeat(found.order, 3), flat.polyhedron.triangles[found.face].ravel())),
        shape=(count, len(flat.points)),
    )
    face, barycentric = refinement.origins()
    corners = refinement.coarse.triangles[face]
    in_coarse = csr_array(
        (barycentric.ravel(), (np.repeat(np.arange(len(face)), 3), corners.ravel())),
        shape=(len(face), len(refinement.coarse.vertices)),
    )
    return csc_array(in_fine @ in_coarse)


def _jets(basis: Basis, points: Points, signs: Floats) -> list[csr_array]:
    if not isinstance(basis, DifferentiableBasis):
        return [basis.design_matrix(points)]
    value, first, second = basis.jet_matrices(points, 1)
    return [value, first, csr_array(second.multiply(signs[:, None]))]
