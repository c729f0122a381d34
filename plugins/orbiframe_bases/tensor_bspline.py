"""Tensor products of periodic B-splines on flat tori and Klein bottles."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe import GeometryError, Orbifold, Points, Triangulation, UsageError
from orbiframe.orbifolds import FlatLattice
from orbiframe.splines import TensorBasis
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe_bases.degrees import require_degree
from orbiframe_bases.periodic_bsplines import PeriodicBSplines

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# The directions (e_k, ...) of the rows of a jet of order 3.
_KINDS: tuple[tuple[int, ...], ...] = (
    (),
    *((k,) for k in (0, 1)),
    *((0, 0), (0, 1), (1, 1)),
    *((k, *ij) for k in (0, 1) for ij in ((0, 0), (0, 1), (1, 1))),
)


class TensorBSpline(TensorBasis):
    """Products of periodic B-splines in the two lattice coordinates (u, v) of a torus or Klein bottle (paper, 3.2).

    On the torus B_i(u) B_j(v) for n1 and n2 knots of period 1. On the Klein bottle, where H contains the glide
    (u, v) -> (u + 1, -v), the u-knots go on with period 1, the v-knots are symmetric, and every function is the sum of
    one product on the double cover with its image under the glide. Either way there are n1 n2 functions, they are
    linearly independent, not negative, and add up to 1; degree less multiplicity of a knot continuous derivatives.

    size: how many functions, shared out between the directions as the surface is long in them, in space where the map
    of a mesh is given, in X otherwise; counts: n1 and n2 instead; degree: at least 1; knots_u, knots_v: the knots of
    one period instead of uniform ones, rising, from 0 to below 1, each at most `degree` times.

    Raises GeometryError on other surfaces, UsageError for an option out of range.
    """

    def __init__(
        self,
        orbifold: Orbifold,
        triangulation: Triangulation | GeodesicTriangulation,
        *,
        size: int = 1000,
        degree: int = 3,
        counts: tuple[int, int] | None = None,
        knots_u: Sequence[float] | None = None,
        knots_v: Sequence[float] | None = None,
    ) -> None:
        require_degree("tensor-bspline", degree, 1)
        if size < 1:
            raise UsageError(f"tensor-bspline has the size {size}; it must be at least 1")
        _require_flat(orbifold)
        self.orbifold, self.degree = orbifold, degree
        self.lattice = FlatLattice.of(orbifold)
        n1, n2 = counts or _counts(triangulation, self.lattice, size)
        u = _knots("knots_u", knots_u, n1, degree)
        v = _knots("knots_v", knots_v, n2, degree)
        self.counts = len(u), len(v)
        self.size = len(u) * len(v)
        period = 2.0 if self.lattice.glide else 1.0
        self.u = PeriodicBSplines(np.concatenate([u, u + 1]) if self.lattice.glide else u, degree, period)
        self.v = PeriodicBSplines(v, degree, 1.0)
        if self.lattice.glide:
            _require_symmetric(v)
        self.smoothness = min(self.u.smoothness, self.v.smoothness)

    @property
    def number(self) -> Ints:
        """The function that each product B_i(u) B_j(v) belongs to: (n1, n2), on the Klein bottle (2 n1, n2)."""
        number = np.arange(self.size).reshape(self.counts)
        if not self.lattice.glide:
            return number
        # f(u + 1, -v) = f(u, v): the coefficient of (i + n1, s(j)) is that of (i, j), s the reflection.
        return np.concatenate([number, number[:, self.v.reflection]])

    @property
    def knots(self) -> tuple[Floats, Floats]:
        """See `TensorBasis`."""
        return self.u.knots, self.v.knots

    def net(self, coefficients: Floats) -> Floats:
        """See `TensorBasis`."""
        return np.asarray(coefficients[self.number])

    def jet_matrices(self, points: Points, order: int) -> list[csr_array]:
        """See `DifferentiableBasis`; the frames are flat, so covariant derivatives are plain ones."""
        place = self.lattice.coordinates(points)
        i, u = self.u.values(place[:, 0], order)
        j, v = self.v.values(place[:, 1], order)
        turn = self.lattice.directions(points.patch)
        column = self.number[i[:, :, None], j[:, None, :]].reshape(len(place), (self.degree + 1) ** 2)
        kinds = _KINDS[: (1, 3, 6, 12)[order]]
        return [self._matrix(column, _derivative(u, v, turn, kind)) for kind in kinds]

    def _matrix(self, column: Ints, values: Floats) -> csr_array:
        count, width = column.shape
        start = np.arange(0, count * width + 1, width)
        matrix = csr_array((values.ravel(), column.flatten(), start), shape=(count, self.size))
        matrix.sum_duplicates()
        return matrix


def _derivative(u: Floats, v: Floats, turn: Floats, directions: tuple[int, ...]) -> Floats:
    """The derivative of all products along some frame vectors, by the chain rule: (n, (degree + 1)^2)."""
    count = turn.shape[0]
    total = np.zeros((count, u.shape[2], v.shape[2]))
    for axes in product((0, 1), repeat=len(directions)):
        factor = np.ones(count)
        for axis, e in zip(axes, directions, strict=True):
            factor = factor * turn[:, axis, e]
        in_v = sum(axes)
        total += (factor[:, None] * u[len(axes) - in_v])[:, :, None] * v[in_v][:, None, :]
    return total.reshape(count, u.shape[2] * v.shape[2])


def _require_flat(orbifold: Orbifold) -> None:
    if orbifold.euler_characteristic:
        raise GeometryError(
            f"tensor-bspline needs a torus or Klein bottle, and this surface has Euler characteristic "
            f"{orbifold.euler_characteristic}; take ps2 (C1) or ps6 (C2), which exist on every surface"
        )


def _knots(name: str, given: Sequence[float] | None, count: int, degree: int) -> Floats:
    """The knots of one period: those given, or uniform ones."""
    if given is None:
        if count < 1:
            raise UsageError(f"option counts of tensor-bspline has the entry {count}; each must be at least 1")
        return np.arange(count) / count
    knots = np.asarray(given, dtype=np.float64)
    wrong = np.flatnonzero(~((knots >= 0) & (knots < 1) & (np.diff(knots, prepend=0.0) >= 0)))
    if knots.ndim != 1 or not len(knots) or len(wrong):
        place = f"; number {wrong[0]} is {knots[wrong[0]]}" if len(wrong) else ""
        raise UsageError(f"option {name} of tensor-bspline must rise from 0 or more to less than 1{place}")
    value, times = np.unique(knots, return_counts=True)
    if times.max() > degree:
        raise UsageError(
            f"option {name} of tensor-bspline repeats {value[times.argmax()]} {times.max()} times; at most {degree}, "
            "the degree, keep the functions continuous"
        )
    return knots


def _require_symmetric(v: Floats) -> None:
    mirrored = np.sort(np.mod(-v, 1.0))
    wrong = np.flatnonzero(np.abs(mirrored - v) > 1e-12)
    if len(wrong):
        raise UsageError(
            f"knots_v of a Klein bottle must be symmetric under v -> 1 - v; number {wrong[0]} is {v[wrong[0]]}, its "
            f"mirror image needs {mirrored[wrong[0]]}"
        )


def _counts(triangulation: Triangulation | GeodesicTriangulation, lattice: FlatLattice, size: int) -> tuple[int, int]:
    """n1 and n2 with about `size` products, in the ratio of the lengths in the two directions."""
    length = np.linalg.norm(lattice.basis, axis=0)
    if isinstance(triangulation, Triangulation):
        length = _lengths_in_space(triangulation, lattice)
    first = max(round(float(np.sqrt(size * length[0] / length[1]))), 1)
    return first, max(round(size / first), 1)


def _lengths_in_space(triangulation: Triangulation, lattice: FlatLattice) -> Floats:
    """The root mean squares of |dX/du| and |dX/dv| of the polyhedron X(u, v) in space, (2,)."""
    mesh, lifts = triangulation.polyhedron, triangulation.lifts
    patch = triangulation.patch[mesh.triangles[:, 0]]
    edges = np.swapaxes(lifts[:, 1:, 1:] - lifts[:, :1, 1:], 1, 2)
    in_lattice = lattice.directions(patch) @ edges
    corners = mesh.vertices[mesh.triangles]
    in_space = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
    slopes = in_space @ np.linalg.inv(in_lattice)
    area = np.abs(np.linalg.det(in_lattice))
    return np.asarray(np.sqrt(np.einsum("f,fik,fik->k", area, slopes, slopes) / area.sum()))
