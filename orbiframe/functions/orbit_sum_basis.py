"""Orbit sum basis: one profile about each centre, summed over the group and divided by the sum of all."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe.errors import FitError
from orbiframe.functions.basis import JET_KINDS, DifferentiableBasis
from orbiframe.functions.lifted_centres import LiftedCentres
from orbiframe.functions.orbit_sum import Pairs, in_blocks
from orbiframe.functions.quotient_kernels import merged_counts, put_rows, quotient_rows, quotient_values
from orbiframe.orbifolds.atlas import Points
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.workers.threads import in_threads

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Result = TypeVar("Result")


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

    def profile_jet(self, t: Floats, order: int) -> tuple[Floats, ...]:
        """f at t and its derivatives up to this order, at least; what `profile` gives unless a basis knows better."""
        del order
        return self.profile(t)

    def jet_matrices(self, points: Points, order: int) -> list[csr_array]:
        """See `DifferentiableBasis`. Raises FitError at a point that no function reaches.

        Order 3 needs f''' from the profile: FitError where it gives none.
        """
        blocks = list(self._blocks(points, order, lambda block: block))
        count = np.zeros(len(points.patch), dtype=np.intp)
        for block in blocks:
            count[block.pairs.rows] = block.reached
        start = np.concatenate([[0], np.cumsum(count)])
        pattern = start.astype(np.int32 if start[-1] < 2**31 else np.int64)
        column = np.empty(start[-1], dtype=pattern.dtype)
        # An array for each: one for all would be so large that every use of it asks the system for new memory.
        jets = [np.empty(start[-1]) for _ in range(JET_KINDS[order])]

        def enter(block: _Block) -> None:
            place, there = np.concatenate([[0], np.cumsum(block.reached)]), start[block.pairs.rows]
            own = np.empty((len(jets), place[-1]))
            lost = quotient_rows(*self._described(block), place, there, column, own, np.empty(len(jets)))
            _require_covered(points, block, lost)
            for values, target in zip(own, jets, strict=True):
                put_rows(values, place, there, target)

        for _ in in_threads(enter, blocks):
            pass
        return [_matrix(values, column, pattern, self.size) for values in jets]

    def jets(self, points: Points, coefficients: Floats, order: int) -> Floats:
        """See `DifferentiableBasis`; found without matrices."""
        given = np.ascontiguousarray(coefficients, dtype=np.float64)
        values = np.empty((JET_KINDS[order], len(points.patch), given.shape[1]))

        def enter(block: _Block) -> None:
            width = int(block.reached.max(initial=0))
            room = np.empty(width, dtype=np.int32), np.empty((len(values), width)), np.empty(len(values))
            lost = quotient_values(*self._described(block), block.pairs.rows, room, given, values)
            _require_covered(points, block, lost)

        for _ in self._blocks(points, order, enter):
            pass
        return values

    def values(self, points: Points, coefficients: Floats) -> Floats:
        """See `Basis`; found without a matrix."""
        return np.asarray(self.jets(points, coefficients, 0)[0])

    def _blocks(self, points: Points, order: int, task: Callable[[_Block], Result]) -> Iterator[Result]:
        """What a task makes of the pairs of points and lifts, block by block."""
        return in_blocks(self._lifted, points, lambda pairs: task(self._block(pairs, order)), slopes=order > 0)

    def _block(self, pairs: Pairs, order: int) -> _Block:
        found = self.profile_jet(pairs.versine / self.support[pairs.column], order)
        if len(found) <= order:
            raise self._unknown()
        profile = tuple(found[min(kind, len(found) - 1)] for kind in range(4))
        count = np.empty(len(pairs.rows), dtype=np.intp)
        merged_counts(pairs.start, pairs.column, count)
        return _Block(pairs, tuple(np.ascontiguousarray(part, dtype=np.float64) for part in profile), count)

    def _described(self, block: _Block) -> tuple[Any, ...]:
        """A block as compiled code takes it: the curvature, the pairs and the profile."""
        pairs = block.pairs
        described = pairs.start, pairs.column, pairs.versine, pairs.slope, self.support
        return float(self.orbifold.geometry.curvature), described, block.profile

    def _unknown(self) -> FitError:
        return FitError(
            f"the profile of {type(self).__name__} gives f, f' and f'' alone; third derivatives need f''' too, as its "
            "fourth result"
        )


class _Block(NamedTuple):
    """Pairs of points and lifts, f, f', f'' and f''' of each, (p,), and how many functions reach each point, (r,)."""

    pairs: Pairs
    profile: tuple[Floats, ...]
    reached: Ints


def _require_covered(points: Points, block: _Block, lost: int) -> None:
    """Raises FitError where compiled code names a row that no function reaches."""
    if lost < 0:
        return
    row = block.pairs.rows[lost]
    raise FitError(
        f"no function reaches point {row} (patch {points.patch[row]}, x = {points.x[row]}); make the functions wider "
        "(option width or reach) or use more of them (option size)"
    )


def _matrix(values: Floats, column: NDArray[Any], start: NDArray[Any], size: int) -> csr_array:
    matrix = csr_array((values, column, start), shape=(len(start) - 1, size))
    matrix.has_sorted_indices = True
    return matrix
