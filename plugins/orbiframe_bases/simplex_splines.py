"""Bases of simplex splines on X/H: sets of knots, their functions, evaluation by shared recursion."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import lsmr

from orbiframe import DifferentiableBasis, FitError, Points
from orbiframe.functions import divide_jets
from orbiframe.planes import triangle_rule
from orbiframe.triangulations import GeodesicTriangulation, Locator
from orbiframe_bases import simplex_kernels as kernels
from orbiframe_bases.simplex_program import Program
from orbiframe_bases.simplex_reach import Reach, hull_bounds, reach

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_KINDS = (1, 3, 6, 12)
# Functions this small against the others are sums that cancel.
_ZERO = 1e-8


@dataclass(frozen=True, eq=False)
class KnotSets:
    """Sets of knots, and the functions that are made of their simplex splines.

    Output o of set e is factor[e, o] M_o, times the linear function lead[e, o] where there is one, and belongs to
    function column[e, o]: a function is the sum of all outputs that belong to it, over all lifts.

    program: which simplex splines of a set are wanted; face: (E,), the triangle in whose frame the knots (E, K, 3) are;
    factor: (E, outputs); lead: (E, outputs, 3) or (0, 0, 3); column: (E, outputs); size: how many functions.
    """

    program: Program
    face: Ints
    knots: Floats
    factor: Floats
    lead: Floats
    column: Ints
    size: int


class _Place(NamedTuple):
    """Located points, in an order of their own, with the curvature and the degree."""

    order: Ints
    face: Ints
    columns: Floats
    shape: tuple[int, int]


class SimplexSplines(DifferentiableBasis):
    """Functions on X/H that are sums of homogeneous simplex splines, restricted to X (paper, section 3.3).

    Piecewise homogeneous polynomials of one degree. Constants are none of odd degree in S^2 and H^2: there all is
    divided by W, the function of the space that is nearest to 1, with the coefficients `weights`.

    Raises FitError where W is not positive, and for knots on more than a half-sphere: triangles that are too large.
    """

    def __init__(self, domain: GeodesicTriangulation, degree: int, knot_sets: KnotSets) -> None:
        self.orbifold, self.domain, self.degree = domain.orbifold, domain, degree
        self.weights: Floats | None = None
        self.knot_sets, self.size = knot_sets, knot_sets.size
        self.knot_sets = self._without_zeros()
        self.size = self.knot_sets.size
        self.smoothness = degree + 1 - most_coplanar(knot_sets)
        if degree % 2 == 1 and domain.geometry.curvature != 0:
            self.weights = self._nearest_to_one()

    def jet_matrices(self, points: Points, order: int) -> list[csr_array]:
        """See `DifferentiableBasis`."""
        place = self._place(points)
        start, column, slots = self._pattern
        face = place.face[np.argsort(place.order)]
        count = np.diff(start)[face]
        row_start = np.concatenate([[0], np.cumsum(count)])
        values = np.zeros((_KINDS[order], row_start[-1]))
        kernels.fill_columns(place, self._reach, self._steps, self._program, self._family, row_start, slots, values)
        if self.weights is not None:
            values = divide_jets(values, self._sums(place, self.weights[:, None], order)[..., 0], count)
        within = np.arange(row_start[-1]) - np.repeat(row_start[:-1] - start[face], count)
        return [_compressed(row, column[within], row_start, self.size) for row in values]

    def values(self, points: Points, coefficients: Floats) -> Floats:
        """See `Basis`; evaluated without a design matrix."""
        return np.asarray(self.jets(points, coefficients, 0)[0])

    def jets(self, points: Points, coefficients: Floats, order: int) -> Floats:
        """See `DifferentiableBasis`; evaluated without a design matrix."""
        place = self._place(points)
        if self.weights is None:
            return self._sums(place, coefficients, order)
        both = self._sums(place, np.column_stack([coefficients, self.weights]), order)
        jets, total = np.ascontiguousarray(both[..., :-1]), both[..., -1]
        width = np.full(len(place.face), jets.shape[2])
        return np.asarray(divide_jets(jets.reshape(len(jets), -1), total, width).reshape(jets.shape))

    def _sums(self, place: _Place, coefficients: Floats, order: int) -> Floats:
        values = np.zeros((_KINDS[order], len(place.face), coefficients.shape[1]))
        kernels.evaluate(
            place,
            self._reach,
            self._steps,
            self._program,
            self._family,
            self.knot_sets.column,
            np.ascontiguousarray(coefficients, dtype=np.float64),
            values,
        )
        return values

    def _place(self, points: Points) -> _Place:
        return _Place(*self.locator.locate(points, frames=True), (self.domain.geometry.curvature, self.degree))

    def _without_zeros(self) -> KnotSets:
        """The same without functions that are zero everywhere: sums whose parts cancel, told by quadrature points."""
        matrix = self.design_matrix(quadrature(self.domain, self.degree + 2)[0])
        height = abs(matrix).max(axis=0).toarray().ravel()
        kept = height > _ZERO * height.max()
        if kept.all():
            return self.knot_sets
        del self._pattern
        column = (np.cumsum(kept) - 1)[self.knot_sets.column]
        factor = self.knot_sets.factor * kept[self.knot_sets.column]
        return replace(self.knot_sets, column=np.maximum(column, 0), factor=factor, size=int(kept.sum()))

    def _nearest_to_one(self) -> Floats:
        """The coefficients of the function that is nearest to 1 in the mean square, by quadrature on the triangles."""
        points, weights = quadrature(self.domain, self.degree + 2)
        root = np.sqrt(weights)
        matrix = diags_array(root) @ self.design_matrix(points)
        scale = 1 / np.sqrt(np.maximum((matrix.multiply(matrix)).sum(axis=0), np.finfo(float).tiny))
        found = lsmr(matrix @ diags_array(scale), root, atol=1e-13, btol=1e-13, maxiter=1000)[0] * scale
        least = float((self.design_matrix(points) @ found).min())
        if not least > 0.05:
            raise FitError(
                f"the function of the space that is nearest to 1 falls to {least:.3g}; the triangles are too large for "
                f"degree {self.degree} in {self.domain.geometry.name}: take more (option size) or an even degree"
            )
        return np.asarray(found)

    @cached_property
    def locator(self) -> Locator:
        """Finds the triangle of a point."""
        return Locator(self.domain)

    @cached_property
    def _bounds(self) -> Floats:
        return np.ascontiguousarray(hull_bounds(self.domain, self.knot_sets.knots))

    @cached_property
    def _reach(self) -> Reach:
        return reach(self.locator, self.knot_sets.face, self.knot_sets.knots, self._bounds)

    @cached_property
    def _steps(self) -> tuple[Floats, Floats, Floats]:
        """What the recursion needs for every set: bounds, rows and heights."""
        rows, height = self.knot_sets.program.rows(self.knot_sets.knots)
        return self._bounds, np.ascontiguousarray(rows), height

    @property
    def _program(self) -> tuple[Ints, Ints, Ints, Ints]:
        program = self.knot_sets.program
        return program.start, program.child, program.orders, program.outputs

    @property
    def _family(self) -> tuple[Floats, Floats]:
        return self.knot_sets.factor, self.knot_sets.lead

    @cached_property
    def _pattern(self) -> tuple[Ints, Ints, Ints]:
        """The functions that matter on each triangle: start (F + 1,), columns, and places of outputs, (c, o)."""
        first, element, _ = self._reach
        triangle = np.repeat(np.arange(self.domain.face_count), np.diff(first))
        key = triangle[:, None] * np.int64(self.size) + self.knot_sets.column[element]
        found, place = np.unique(key, return_inverse=True)
        face, column = np.divmod(found, self.size)
        start = np.searchsorted(face, np.arange(self.domain.face_count + 1))
        return start, column, place.reshape(key.shape) - start[triangle][:, None]


def quadrature(domain: GeodesicTriangulation, points: int) -> tuple[Points, Floats]:
    """Points of X/H on all triangles, points^2 on each, with the weights of their areas."""
    barycentric, weights = triangle_rule(points)
    flat = np.einsum("qc,fci->fqi", barycentric, domain.corners)
    x = domain.geometry.project(flat)
    places = np.einsum("fij,fqj->fqi", domain.placement, x).reshape(-1, 3)
    return Points(np.repeat(domain.patch, len(weights)), places), (domain.areas[:, None] * weights).ravel()


def most_coplanar(knot_sets: KnotSets) -> int:
    """The largest number of knots of one simplex spline in a plane through the origin: 2 in general position.

    A simplex spline of m knots is C^(m - q - 2) across a plane that holds q of them.
    """
    return max(
        _most_in_a_plane(knot_sets.knots[:, list(knot_sets.program.states[o])])
        for o in set(knot_sets.program.outputs.tolist())
    )


def _most_in_a_plane(knots: Floats) -> int:
    triples = np.array(list(combinations(range(knots.shape[1]), 3)))
    p, q, r = np.moveaxis(knots[:, triples], 2, 0)
    normal = np.cross(p, q - p)
    sine = np.abs(np.einsum("eti,eti->et", normal, r - p))
    scale = np.linalg.norm(normal, axis=2) * np.linalg.norm(r - p, axis=2)
    flat = np.argwhere(sine <= 1e-8 * scale)
    if not len(flat):
        return 2
    unit = np.linalg.svd(knots[flat[:, 0]][np.arange(len(flat))[:, None], triples[flat[:, 1]]])[2][:, 2]
    height = np.abs(np.einsum("ni,nki->nk", unit, knots[flat[:, 0]]))
    return int((height <= 1e-8).sum(axis=1).max())


def _compressed(values: Floats, column: Ints, row_start: Ints, size: int) -> csr_array:
    """A sparse matrix without the zeros that are stored."""
    kept = np.flatnonzero(values)
    index = np.int32 if len(values) < 2**31 else np.int64
    start = np.searchsorted(kept, row_start)
    shape = (len(row_start) - 1, size)
    return csr_array((values[kept], column[kept].astype(index), start.astype(index)), shape=shape)
