"""Elimination: orders in which sparse matrices on a mesh are factored with little fill."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import SuperLU, splu

from orbiframe import MapError, Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_LEAF = 48
_SMALL = 40_000


@dataclass(frozen=True, eq=False)
class Elimination:
    """An order of the vertices of a mesh in which matrices on its edges are factored with little fill.

    order: (V,), the vertices one after the other; place: (V,), where each vertex stands in the order.
    """

    order: Ints
    place: Ints

    @classmethod
    def of(cls, mesh: Polyhedron) -> Elimination:
        """A good order for the edges of a mesh."""
        once = mesh.representative
        order = elimination_order(mesh.vertices, mesh.tail[once], mesh.head[once])
        return cls(order, np.argsort(order))

    def matrix(self, tail: Ints, head: Ints, entries: NDArray[Any], diagonal: NDArray[Any]) -> csc_array[Any]:
        """The Hermitian matrix in this order with entries (E,) at (tail, head), conjugates at (head, tail)."""
        i, j = self.place[tail], self.place[head]
        rows, columns = np.concatenate([i, j, self.place]), np.concatenate([j, i, self.place])
        data = np.concatenate([entries, np.conj(entries), diagonal])
        return coo_array((data, (rows, columns)), shape=(len(self.order),) * 2).tocsc()

    def solver(self, tail: Ints, head: Ints, entries: Floats, diagonal: Floats) -> Callable[[Floats], Floats]:
        """The solution of systems with that matrix for right sides (V,) or (V, k); numbered like the mesh.

        Raises MapError for a singular matrix.
        """
        factors = factorised(self.matrix(tail, head, entries, diagonal))
        return lambda right: np.asarray(factors.solve(right[self.order])[self.place])


def elimination_order(positions: Floats, tail: Ints, head: Ints) -> Ints:
    """The vertices in an order that keeps the factors of matrices on the edges (tail, head) sparse, (V,).

    Minimum degree up to 40,000 vertices, where it is quick and does well on long thin triangles; then nested
    dissection, which is quicker to find and as good on meshes of even triangles.
    """
    if len(positions) <= _SMALL:
        return _minimum_degree_order(len(positions), tail, head)
    return dissection_order(positions, tail, head)


def _minimum_degree_order(count: int, tail: Ints, head: Ints) -> Ints:
    # SuperLU's minimum degree takes quadratic time on some regular numberings: shuffled vertices have none.
    shuffled = np.random.default_rng(0).permutation(count)
    place = np.empty(count, dtype=np.intp)
    place[shuffled] = np.arange(count)
    i, j = place[np.concatenate([tail, head])], place[np.concatenate([head, tail])]
    every = np.arange(count)
    data = np.concatenate([np.full(len(i), -1.0), 1.0 + np.bincount(i, minlength=count)])
    matrix = coo_array((data, (np.append(i, every), np.append(j, every))), shape=(count, count)).tocsc()
    factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    order = np.empty(count, dtype=np.intp)
    order[factors.perm_c] = shuffled
    return order


def dissection_order(positions: Floats, tail: Ints, head: Ints) -> Ints:
    """The vertices in an order that keeps factors sparse: halves first, the separator between them last, recursively.

    positions: (V, 3); tail, head: (E,) the ends of the edges. All parts of one level are halved at once, across
    their widest axis; the separator is made of the vertices of one half with a neighbour in the other. Geometric
    nested dissection (George 1973; Gilbert, Miller, Teng 1998): O(V log^2 V) time, about V log V entries in a factor.
    """
    count = len(positions)
    part = np.zeros(count, dtype=np.intp)
    code = np.zeros(count, dtype=np.int64)
    alive = np.arange(count)
    depth = 0
    while len(alive) and np.bincount(part[alive]).max() > _LEAF and depth < 36:
        right = _upper_half(positions[alive], part[alive])
        side = np.full(count, -1, dtype=np.intp)
        side[alive] = right
        crossing = (side[tail] >= 0) & (side[head] >= 0) & (part[tail] == part[head]) & (side[tail] != side[head])
        ends = np.concatenate([tail[crossing], head[crossing]])
        separator = np.zeros(count, dtype=np.bool_)
        separator[ends[side[ends] == 0]] = True
        code *= 3
        code[alive] += right
        code[side < 0] += 2
        code[separator] += 2 - code[separator] % 3
        part[alive] = 2 * part[alive] + right
        alive = alive[~separator[alive]]
        _, part[alive] = np.unique(part[alive], return_inverse=True)
        depth += 1
    return np.argsort(code, kind="stable")


def _upper_half(positions: Floats, part: Ints) -> Ints:
    """0 or 1 for every vertex: below or above the median of its part along the part's widest axis."""
    by_part = np.argsort(part, kind="stable")
    starts = np.flatnonzero(np.diff(part[by_part], prepend=-1))
    sorted_positions = positions[by_part]
    spread = np.maximum.reduceat(sorted_positions, starts) - np.minimum.reduceat(sorted_positions, starts)
    axis = np.repeat(spread.argmax(axis=1), np.diff(starts, append=len(part)))
    key = sorted_positions[np.arange(len(part)), axis]
    order = by_part[np.lexsort((key, part[by_part]))]
    rank = np.arange(len(part)) - np.repeat(starts, np.diff(starts, append=len(part)))
    half = np.repeat(np.diff(starts, append=len(part)) // 2, np.diff(starts, append=len(part)))
    right = np.empty(len(part), dtype=np.intp)
    right[order] = rank >= half
    return right


def factorised(matrix: csc_array[Any]) -> SuperLU:
    """The factors of a symmetric (Hermitian) matrix whose rows are in elimination order already, without pivoting.

    Raises MapError for a singular matrix.
    """
    try:
        return splu(matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise MapError(
            "the equations of the map are singular; look for degenerate triangles with `orbiframe info`"
        ) from error
