"""Orbit sum basis: one profile about each centre, summed over the group and divided by the sum of all."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe.errors import FitError
from orbiframe.functions.basis import JET_KINDS, DifferentiableBasis
from orbiframe.functions.jet_quotient import divide_jets
from orbiframe.functions.lifted_centres import LiftedCentres
from orbiframe.functions.orbit_sum import Pairs, reaching_pairs
from orbiframe.orbifolds.atlas import Points
from orbiframe.orbifolds.orbifold import Orbifold

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


class OrbitSumBasis(DifferentiableBasis):
    """Sums over the group of one profile about each centre, divided by the sum of all: a partition of unity.

    phi_i(x) = sum over h in H of f(c(x, h m_i) / c_i) and b_i = phi_i / (phi_1 + ... + phi_size), where c is the
    versine (1 - cos d, d^2/2 or cosh d - 1), m_i the centre, c_i its support and f the profile, zero from 1 on (paper,
    section 3.1). As smooth as the profile: c is analytic.

    centres: `size` points of X/H; support: (size,), positive versines; 2 and more in S^2 reach every point.
    """

    def __init__(self, orbifold: Orbifold, centres: Points, support: Floats) -> None:
        self.orbifold = orbifold
        self.centres = centres
        self.support = support
        self.size = len(support)
        self._lifted = LiftedCentres(orbifold, centres, support)

    @abstractmethod
    def profile(self, t: Floats) -> tuple[Floats, ...]:
        """f, f' and f'' at t >= 0, (n,) each: positive before 1, zero from 1 on; f''' too, for jets of order 3."""

    def jet_matrices(self, points: Points, order: int) -> list[csr_array]:
        """See `DifferentiableBasis`. Raises FitError at a point that no function reaches.

        Order 3 needs f''' from the profile: FitError where it gives none.
        """
        pairs = reaching_pairs(self._lifted, points, slopes=order > 0)
        blocks = [self._jets(block, points, order) for block in pairs]
        return _assemble(blocks, (len(points.patch), self.size), JET_KINDS[order])

    def _jets(self, pairs: Pairs, points: Points, order: int) -> _Block:
        empty = np.flatnonzero(np.diff(pairs.start) == 0)
        if len(empty):
            _uncovered(points, pairs.rows[empty[0]])
        jets = self._profile_jets(pairs, order)
        start, column, jets = _sum_lifts(pairs.start, pairs.column, jets)
        total = np.add.reduceat(jets, start[:-1], axis=1)
        lost = np.flatnonzero(~(total[0] >= np.finfo(float).tiny))
        if len(lost):
            _uncovered(points, pairs.rows[lost[0]])
        return _Block(pairs.rows, start, column, divide_jets(jets, total, np.diff(start)))

    def _profile_jets(self, pairs: Pairs, order: int) -> Floats:
        """The jets of f(c / c_i) from D c and Hess c = (1 - K c) g, 1, 3, 6 or 12 rows, one column per pair."""
        support = self.support[pairs.column]
        f, df, ddf, *third = self.profile(pairs.versine / support)
        if order == 0:
            return np.array(f)[None]
        c1, c2 = pairs.slope.T
        df = df / support
        if order == 1:
            return np.stack([f, df * c1, df * c2])
        ddf = ddf / support**2
        turn = 1 - self.orbifold.geometry.curvature * pairs.versine
        trace = df * turn
        jets = [f, df * c1, df * c2, ddf * c1**2 + trace, ddf * c1 * c2, ddf * c2**2 + trace]
        if order == 3:
            bent = ddf * turn
            drift = bent - self.orbifold.geometry.curvature * df
            jets += _third_jets(pairs.slope.T, bent, drift, self._third(third) / support**3)
        return np.stack(jets)

    def _third(self, given: list[Floats]) -> Floats:
        """f''' from what the profile gives beyond f''."""
        if given:
            return given[0]
        raise FitError(
            f"the profile of {type(self).__name__} gives f, f' and f'' alone; third derivatives need f''' too, as its "
            "fourth result"
        )


def _third_jets(c: Floats, bent: Floats, drift: Floats, third: Floats) -> list[Floats]:
    """The derivatives along w = e_k of the Hessian entries u = e_i, v = e_j of f(c); D_w Hess c = -K c_w g, so they are

    f''' c_u c_v c_w + f'' (1 - K c)(c_w <u, v> + c_u <v, w> + c_v <u, w>) - f' K c_w <u, v>.

    c: (2, n), the derivative of the versine; bent: f'' (1 - K c); drift: bent - K f'; third: f'''.
    """
    return [
        third * c[i] * c[j] * c[k] + (i == j) * drift * c[k] + bent * ((j == k) * c[i] + (i == k) * c[j])
        for k in (0, 1)
        for i, j in ((0, 0), (0, 1), (1, 1))
    ]


class _Block:
    """Rows of a set of sparse matrices with one pattern: rows (r,), start (r + 1,), column (p,), values (m, p)."""

    def __init__(self, rows: Ints, start: Ints, column: Ints, values: Floats) -> None:
        self.rows, self.values = rows, values
        self.column = column.astype(np.int32)
        self.count = np.diff(start)


def _uncovered(points: Points, row: int) -> None:
    raise FitError(
        f"no function reaches point {row} (patch {points.patch[row]}, x = {points.x[row]}); make the functions wider "
        "(option width or reach) or use more of them (option size)"
    )


def _sum_lifts(start: Ints, column: Ints, jets: Floats) -> tuple[Ints, Ints, Floats]:
    """Add what several lifts of one centre contribute to one point; they stand side by side."""
    fresh = np.ones(len(column), dtype=np.bool_)
    fresh[1:] = column[1:] != column[:-1]
    fresh[start[:-1]] = True
    if fresh.all():
        return start, column, jets
    keep = np.flatnonzero(fresh)
    return np.searchsorted(keep, start), column[keep], np.add.reduceat(jets, keep, axis=1)


def _assemble(blocks: list[_Block], shape: tuple[int, int], kinds: int) -> list[csr_array]:
    """Sparse matrices with one shared pattern from blocks of their rows."""
    count = np.zeros(shape[0], dtype=np.intp)
    for block in blocks:
        count[block.rows] = block.count
    start = np.concatenate([[0], np.cumsum(count)])
    pattern = start.astype(np.int32 if start[-1] < 2**31 else np.int64)
    places = [_places(start[block.rows], block.count) for block in blocks]
    column = np.empty(start[-1], dtype=pattern.dtype)
    for block, place in zip(blocks, places, strict=True):
        column[place] = block.column
    matrices = []
    for kind in range(kinds):
        values = np.empty(start[-1])
        for block, place in zip(blocks, places, strict=True):
            values[place] = block.values[kind]
        matrix = csr_array((values, column, pattern), shape=shape)
        matrix.has_sorted_indices = True
        matrices.append(matrix)
    return matrices


def _places(start: Ints, count: Ints) -> Ints:
    """start[0], start[0] + 1, ... for count[0] numbers, then the same from start[1] and so on."""
    return np.arange(count.sum()) + np.repeat(start - np.cumsum(count) + count, count)
