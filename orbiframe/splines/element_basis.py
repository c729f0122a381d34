"""ElementBasis: piecewise polynomials on X/H, given by one sparse matrix from unknowns to Bernstein coefficients."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe.functions.basis import JET_KINDS, PiecewiseBasis
from orbiframe.functions.jet_quotient import divide_jets
from orbiframe.orbifolds.atlas import Points
from orbiframe.splines.bernstein import coefficient_count
from orbiframe.splines.bernstein_kernels import evaluate_nets, fill_rows, polynomial_tables, unknowns_of_triangles
from orbiframe.splines.galerkin import nearest_to_one
from orbiframe.splines.spline_values import spline_values
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.point_location import Location, Locator, require_found

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_BLOCK = 1024  # points that are located, then evaluated


class ElementBasis(PiecewiseBasis):
    """Functions that are homogeneous polynomials of one degree on every micro triangle of a geodesic triangulation.

    A function on X/H is f = F restricted to X, where F is a polynomial in R^3 on the cone over each micro triangle.
    The matrix C takes the unknowns to the Bernstein coefficients of all micro triangles; values, derivatives, scalar
    products and exact patches follow from the corners of the micro triangles, the degree and C alone.

    domain: the triangulation; degree; micro_triangles: (F, m, 3, 3), the corners of the micro triangles [triangle,
    micro, corner, coordinate] in the frame of their triangle, vectors in R^3 that need not lie on X; matrix: C, sparse
    (F m n, size) with n = (degree + 1)(degree + 2) / 2 (splines: sections 3.2 and 3.3 of the paper).

    Constants are no homogeneous polynomials of odd degree in S^2 and H^2. There the functions are divided by W, the
    function of the space that is nearest to 1: the rational space S/W, in which constants are exact; `weights` are the
    coefficients of W, None where nothing is divided. rational: False keeps the plain polynomials.
    """

    def __init__(
        self,
        domain: GeodesicTriangulation,
        degree: int,
        micro_triangles: Floats,
        matrix: csr_array,
        smoothness: float,
        *,
        rational: bool = True,
    ) -> None:
        self.orbifold = domain.orbifold
        self.domain = domain
        self.degree = degree
        self.micro_triangles = micro_triangles
        self.matrix = matrix
        self.size = matrix.shape[1]
        self.smoothness = smoothness
        divided = rational and degree % 2 == 1 and domain.geometry.curvature != 0
        self.weights = nearest_to_one(self) if divided else None

    def jet_matrices(self, points: Points, order: int) -> list[csr_array]:
        """See `PiecewiseBasis`."""
        location = self.locator.locate(points, frames=order > 0)
        face = np.empty_like(location.face)
        face[location.order] = location.face
        start, column, slot = self._pattern
        count = np.diff(start)[face]
        row_start = np.concatenate([[0], np.cumsum(count)])
        values = np.zeros((JET_KINDS[order], row_start[-1]))
        matrix = self.matrix.indptr, self.matrix.data, slot
        fill_rows((location, *self._search, self._shape), matrix, polynomial_tables(self.degree), row_start, values)
        if self.weights is not None:
            values = divide_jets(values, self._polynomial_jets(location, self.weights[:, None], order)[..., 0], count)
        within = np.arange(row_start[-1]) - np.repeat(row_start[:-1] - start[face], count)
        index = np.int32 if row_start[-1] < 2**31 else np.int64
        columns, pattern = column[within].astype(index), row_start.astype(index)
        return [csr_array((row, columns, pattern), shape=(len(face), self.size)) for row in values]

    def net(self, coefficients: Floats) -> Floats:
        """The Bernstein coefficients of q functions from their coefficients (size, q): (F, m, n, q)."""
        return np.asarray(self.matrix @ coefficients).reshape(
            *self.micro_triangles.shape[:2], -1, coefficients.shape[1]
        )

    def values(self, points: Points, coefficients: Floats) -> Floats:
        """See `Basis`; evaluated from the Bernstein coefficients, without a design matrix."""
        rational = self.weights is not None
        nets = self.net(coefficients if self.weights is None else np.column_stack([coefficients, self.weights]))
        tables = polynomial_tables(self.degree)
        patch, x = np.asarray(points.patch, dtype=np.intp), np.asarray(points.x, dtype=np.float64)
        values = np.empty((len(x), coefficients.shape[1]))
        room = (
            np.empty(_BLOCK, dtype=np.intp),
            np.empty((_BLOCK, 3)),
            np.empty(tables.counts[0]),
            np.empty((3, self.degree + 1)),
        )
        failed = spline_values(
            (patch, x),
            self.locator.grid,
            self.locator.steps,
            self._search,
            nets.reshape(-1, *nets.shape[2:]),
            (self.degree, tables.multinomials[0], rational),
            room,
            values,
        )
        require_found(failed, points)
        return values

    def jets(self, points: Points, coefficients: Floats, order: int) -> Floats:
        """See `PiecewiseBasis`; evaluated from the Bernstein coefficients, without a design matrix."""
        location = self.locator.locate(points, frames=order > 0)
        if self.weights is None:
            return self._polynomial_jets(location, coefficients, order)
        both = self._polynomial_jets(location, np.column_stack([coefficients, self.weights]), order)
        jets, total = np.ascontiguousarray(both[..., :-1]), both[..., -1]
        width = np.full(jets.shape[1], jets.shape[2])
        return divide_jets(jets.reshape(len(jets), -1), total, width).reshape(jets.shape)

    def _polynomial_jets(self, location: Location, coefficients: Floats, order: int) -> Floats:
        values = np.empty((JET_KINDS[order], len(location.face), coefficients.shape[1]))
        place = location, *self._search, self._shape
        evaluate_nets(place, self.net(coefficients), polynomial_tables(self.degree), values)
        return values

    @cached_property
    def locator(self) -> Locator:
        """Finds the triangle of a point."""
        return Locator(self.domain)

    @property
    def _shape(self) -> tuple[int, int]:
        """The curvature and the degree."""
        return self.domain.geometry.curvature, self.degree

    @cached_property
    def _search(self) -> tuple[Floats, Floats, int]:
        """How to find micro triangles: matrices to barycentric coordinates, fans (see `_fans`), how many there are."""
        fans = _fans(self.domain, self.micro_triangles)
        micro_triangles = self.domain.corners[:, None] if fans.shape[1] else self.micro_triangles
        return (
            np.ascontiguousarray(np.linalg.inv(np.swapaxes(micro_triangles, -1, -2))),
            fans,
            self.micro_triangles.shape[1],
        )

    @cached_property
    def _pattern(self) -> tuple[Ints, Ints, Ints]:
        """The unknowns that matter on each triangle: start (F + 1,), columns, and for every nonzero of C its place."""
        rows = self.micro_triangles.shape[1] * coefficient_count(self.degree)
        start, column, place = unknowns_of_triangles(self.matrix.indptr, self.matrix.indices, rows, self.size)
        return start, column, place


def _fans(domain: GeodesicTriangulation, micro_triangles: Floats) -> Floats:
    """Splits that are fans about a point Z, as numbers: (F, 3) or (F, 9), and (F, 0) for any other split.

    Three micro triangles (v_c, v_(c + 1), Z), or six: 2 c and 2 c + 1 are (v_c, R_c, Z) and (v_(c + 1), R_c, Z). Three
    numbers 1 / z_i with Z = sum z_i v_i, and for R_c = mu v_c + nu v_(c + 1) the pairs mu, nu.
    """
    x = domain.corners
    ends = np.stack([x, np.roll(x, -1, axis=1)], axis=2).reshape(-1, 6, 3)
    six, three = micro_triangles.shape[1] == 6, micro_triangles.shape[1] == 3
    if not (
        (six and np.array_equal(micro_triangles[:, :, 0], ends))
        or (
            three
            and np.array_equal(micro_triangles[:, :, 0], x)
            and np.array_equal(micro_triangles[:, :, 1], ends[:, 1::2])
        )
    ):
        return np.zeros((len(micro_triangles), 0))
    inverse = np.linalg.inv(np.swapaxes(x, 1, 2))
    z = np.einsum("fij,fj->fi", inverse, micro_triangles[:, 0, 2])
    if three:
        return np.ascontiguousarray(1 / z)
    r = np.einsum("fij,fcj->fci", inverse, micro_triangles[:, ::2, 1])
    share = np.stack([r[:, range(3), range(3)], r[:, range(3), (1, 2, 0)]], axis=2)
    return np.ascontiguousarray(np.concatenate([1 / z, share.reshape(-1, 6)], axis=1))
