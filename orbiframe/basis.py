"""Basis: finitely many functions on X/H, evaluated as sparse matrices."""

from __future__ import annotations

from abc import ABC, abstractmethod

from scipy.sparse import csr_array

from orbiframe.atlas import Points
from orbiframe.orbifold import Orbifold


class Basis(ABC):
    """Functions b_1, ..., b_size on X/H.

    A basis is built by `(orbifold, triangulation, *, options)`; the same input gives the same basis, bit for bit.
    smoothness: the number of continuous derivatives (math.inf for C^infinity).
    """

    orbifold: Orbifold
    size: int
    smoothness: float

    @abstractmethod
    def design_matrix(self, points: Points) -> csr_array:
        """The values of all functions at n points, sparse (n, size)."""


class DifferentiableBasis(Basis):
    """A basis that knows its covariant derivatives."""

    @abstractmethod
    def jet_matrices(self, points: Points, order: int) -> list[csr_array]:
        """Values and covariant derivatives up to order 0, 1 or 2, each sparse (n, size).

        In the orthonormal frame (e1, e2) = `geometry.frame(x)` at each point: [b], [b, D1, D2] or
        [b, D1, D2, D11, D12, D22], where Dij is the covariant Hessian.
        """
