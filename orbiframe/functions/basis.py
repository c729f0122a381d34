"""Basis: finitely many functions on X/H, evaluated as sparse matrices."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe.orbifolds.atlas import Points
from orbiframe.orbifolds.orbifold import Orbifold

Floats = NDArray[np.float64]

JET_KINDS = (1, 3, 6, 12)  # how many matrices the jets of order 0, 1, 2 and 3 have
_CHUNK = 1 << 16


class Basis(ABC):
    """Functions b_1, ..., b_size on X/H.

    A basis is built by `(orbifold, triangulation, *, options)`; the same input gives the same basis, bit for bit.
    smoothness: the number of continuous derivatives (math.inf for C^infinity). crease_unknowns: how many unknowns a
    vertex, an edge and a triangle of the domain have, for functions that may be only continuous across the creases of
    a triangulation that has some; None for functions that keep none.

    >>> import numpy as np
    >>> from orbiframe import fit
    >>> surface = fit("dataset:torus", basis={"name": "ps2", "size": 60}).surface
    >>> points = surface.points([0, 1], [[1, 0, 0], [0, 1, 0]])
    >>> rows = surface.basis.design_matrix(points)
    >>> rows.shape == (2, surface.basis.size), np.allclose(rows.sum(axis=1), 1)
    (True, True)
    """

    orbifold: Orbifold
    size: int
    smoothness: float
    crease_unknowns: ClassVar[tuple[int, int, int] | None] = None

    @abstractmethod
    def design_matrix(self, points: Points) -> csr_array:
        """The values of all functions at n points, sparse (n, size)."""

    def values(self, points: Points, coefficients: Floats) -> Floats:
        """The values (n, q) of q combinations of the functions, with coefficients (size, q), at n points."""
        parts = [self.design_matrix(part) @ coefficients for part in chunks_of(points)]
        return np.concatenate(parts)


class DifferentiableBasis(Basis):
    """A basis that knows its covariant derivatives."""

    def design_matrix(self, points: Points) -> csr_array:
        """The values of all functions at n points, sparse (n, size): the jets of order 0."""
        return self.jet_matrices(points, 0)[0]

    @abstractmethod
    def jet_matrices(self, points: Points, order: int) -> list[csr_array]:
        """Values and covariant derivatives up to order 0, 1, 2 or 3, each sparse (n, size): 1, 3, 6 or 12 of them.

        In the orthonormal frame (e1, e2) = `geometry.frame(x)` at each point: b; D1, D2; D11, D12, D22, where Dij is
        the covariant Hessian; D1;11, D1;12, D1;22, D2;11, D2;12, D2;22, where Dk;ij is the covariant derivative of the
        Hessian along e_k.
        """

    def jets(self, points: Points, coefficients: Floats, order: int) -> Floats:
        """The same for q combinations of the functions, with coefficients (size, q): (1, 3, 6 or 12, n, q)."""
        parts = [
            np.stack([matrix @ coefficients for matrix in self.jet_matrices(part, order)]) for part in chunks_of(points)
        ]
        return np.concatenate(parts, axis=1)


class PiecewiseBasis(DifferentiableBasis):
    """A basis of piecewise polynomials or their products: its surfaces have exact patches."""


def lifted(basis: Basis, coefficients: Floats) -> Callable[[Floats], Floats]:
    """A function on X/H, of coefficients (size, 1), as an invariant function on X in the frame of patch 0.

    The result takes points (n, 3) of X to values (n,).
    """

    def values(x: Floats) -> Floats:
        return basis.values(Points(np.zeros(len(x), dtype=np.intp), x), coefficients)[:, 0]

    return values


def chunks_of(points: Points) -> list[Points]:
    """The points in parts that bound the memory of design matrices; at least one."""
    bounds = range(0, max(len(points.patch), 1), _CHUNK)
    return [Points(points.patch[b : b + _CHUNK], points.x[b : b + _CHUNK]) for b in bounds]
