"""Hybrid splines of Liu and Schumaker: C1 functions on whole triangles, rational blends of cubics."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe import DifferentiableBasis, Orbifold, Points, Triangulation
from orbiframe.delaunay import domain_for
from orbiframe.functions import divide_jets
from orbiframe.splines import ElementBasis, coefficient_count, exponents
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe_bases.hermite import CubicHermite

Floats = NDArray[np.float64]

_UNIT = np.eye(3, dtype=np.intp)
_Nets = Callable[[Floats, Floats], Floats]
# Where l1 l2 + l2 l3 + l3 l1 is smaller, the point is a vertex up to rounding.
_AT_VERTEX = 1e-12


class Hybrid(DifferentiableBasis):
    """C1 functions with a gradient at every vertex and one number at every edge, on whole triangles (paper, 3.4).

    On a triangle F = sum over the boundary of c_a B_a + 6 l1 l2 l3 (A_1 c_1 + A_2 c_2 + A_3 c_3), where l are the
    barycentric coordinates, c_k the coefficient that makes F smooth across the edge opposite to corner k, and
    A_1 = l2 l3 / (l1 l2 + l2 l3 + l3 l1) and so on blend the three (Liu and Schumaker, 1996; the unknowns are those of
    `clough-tocher`). F is homogeneous of degree 3; in S^2 and H^2 all functions are divided by the one that has the
    data of 1. Second derivatives are bounded, but have no limit at the vertices: there, those of the boundary part are
    returned; third derivatives grow like 1/r at distance r.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself.
    """

    smoothness = 1

    def __init__(
        self, orbifold: Orbifold, triangulation: Triangulation | GeodesicTriangulation, *, size: int = 1000
    ) -> None:
        domain = domain_for(orbifold, triangulation, size, (3, 1, 0))
        data = CubicHermite(domain)
        self.orbifold, self.domain, self.size = orbifold, domain, data.unknowns.size
        self.weights = data.one if domain.geometry.curvature else None
        self._boundary = _pieces(domain, 3, data, _boundary_nets)
        self._inside = _pieces(domain, 5, data, _inside_nets)
        mixed = np.tile((exponents(2).max(axis=1) == 1) / 2, domain.face_count)
        self._divisor = ElementBasis(domain, 2, domain.corners[:, None], csr_array(mixed[:, None]), 0)

    def jet_matrices(self, points: Points, order: int) -> list[csr_array]:
        """See `DifferentiableBasis`."""
        boundary, inside = (part.jet_matrices(points, order) for part in (self._boundary, self._inside))
        divisor = self._divisor.jets(points, np.ones((1, 1)), order)[..., 0]
        start, column, count = boundary[0].indptr, boundary[0].indices, np.diff(boundary[0].indptr)
        values = np.stack([matrix.data for matrix in boundary])
        values += _divided(np.stack([matrix.data for matrix in inside]), divisor, count)
        if self.weights is not None:
            one = np.add.reduceat(values * self.weights[column], start[:-1], axis=1) if len(count) else divisor
            values = divide_jets(values, one, count)
        return [csr_array((row, column, start), shape=boundary[0].shape) for row in values]


def _divided(jets: Floats, divisor: Floats, count: NDArray[np.intp]) -> Floats:
    """The jets of the inner part over those of l1 l2 + l2 l3 + l3 l1; nothing at the vertices."""
    vertex = np.abs(divisor[0]) < _AT_VERTEX
    jets[:, np.repeat(vertex, count)] = 0
    divisor[0, vertex] = 1
    return divide_jets(jets, divisor, count)


def _pieces(domain: GeodesicTriangulation, degree: int, data: CubicHermite, nets: _Nets) -> ElementBasis:
    """Piecewise polynomials with these nets; all of them have the same pattern, that of all unknowns of a triangle."""
    count = data.unknowns.local_size
    pattern = np.ones((1, coefficient_count(degree), count), dtype=np.bool_)
    matrix = data.unknowns.assembled(lambda faces: nets(*data.forms(faces))[:, None], pattern)
    return ElementBasis(domain, degree, domain.corners[:, None], matrix, 0, rational=False)


def _boundary_nets(corner: Floats, wanted: Floats) -> Floats:
    """The cubic part, (N, 10, m): B(v_c, v_c, u) from the corners, nothing in the middle."""
    del wanted
    nets = np.zeros((len(corner), 10, corner.shape[3]))
    for c in range(3):
        for m in range(3):
            nets[:, _number(2 * _UNIT[c] + _UNIT[(c + m) % 3])] = corner[:, c, m]
    return nets


def _inside_nets(corner: Floats, wanted: Floats) -> Floats:
    """6 l1 l2 l3 (l2 l3 c_1 + ...) in degree 5, (N, 21, m); the multinomials of these monomials are 30."""
    del corner
    nets = np.zeros((len(wanted), 21, wanted.shape[2]))
    for edge in range(3):
        nets[:, _number(1 + _UNIT[edge] + _UNIT[(edge + 1) % 3])] = wanted[:, edge] / 5
    return nets


def _number(exponent: NDArray[np.intp]) -> int:
    """The number of an exponent."""
    return int(np.flatnonzero((exponents(int(exponent.sum())) == exponent).all(axis=1))[0])
