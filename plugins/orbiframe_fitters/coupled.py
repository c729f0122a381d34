"""Coupled equations: three coordinates of every function, coupled by normals, solved to a few digits.

That is enough for a step of Newton's method, and for many functions far less work than factors of the whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe.compiled import compiled
from orbiframe.workers import in_threads
from orbiframe_fitters.gram import Gram
from orbiframe_fitters.normal_equations import Solver, first_factored, require_seen, scaled

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_MOST_STEPS = 60
_NEARLY = 1e-4
# The kind of each entry of a symmetric form of three coordinates.
KIND = ((0, 1, 2), (1, 3, 4), (2, 4, 5))


class Coupled(Protocol):
    """A symmetric matrix of so many functions with three coordinates each."""

    def diagonal(self) -> Floats:
        """Its diagonal, (size, 3)."""

    def block(self, coordinate: int) -> Floats | csr_array:
        """Its part for one coordinate, (size, size)."""

    def image(self, x: Floats) -> Floats:
        """What it makes of x, (size, 3)."""


class SparseBlocks(NamedTuple):
    """One of sparse blocks, those of each kind."""

    kinds: Sequence[csr_array]

    def diagonal(self) -> Floats:
        """See `Coupled`."""
        return np.stack([self.kinds[KIND[a][a]].diagonal() for a in range(3)], axis=1)

    def block(self, coordinate: int) -> csr_array:
        """See `Coupled`."""
        return self.kinds[KIND[coordinate][coordinate]]

    def image(self, x: Floats) -> Floats:
        """See `Coupled`."""
        return np.stack([sum(self.kinds[kind] @ x[:, b] for b, kind in enumerate(line)) for line in KIND], axis=1)


class PackedBlocks(NamedTuple):
    """One of which the upper triangle is packed: start (size + 1,), column (p,), entries (p, 6), by rows."""

    start: Ints
    column: Ints
    entries: Floats

    @classmethod
    def of(cls, upper: Floats, stiff: Floats) -> PackedBlocks:
        """From an upper triangle (size, size, 6), and a symmetric matrix that is added for each coordinate."""
        count = np.zeros(len(upper), dtype=np.intp)
        _count(upper, stiff, count)
        start = np.concatenate([[0], np.cumsum(count)])
        column, entries = np.empty(start[-1], dtype=np.intp), np.empty((start[-1], 6))
        _pack(upper, stiff, start, column, entries)
        return cls(start, column, entries)

    def diagonal(self) -> Floats:
        """See `Coupled`."""
        return self.entries[self.start[:-1]][:, [KIND[a][a] for a in range(3)]]

    def block(self, coordinate: int) -> Floats:
        """See `Coupled`."""
        found = np.zeros((len(self.start) - 1,) * 2)
        _unpack(*self, KIND[coordinate][coordinate], found)
        return found

    def image(self, x: Floats) -> Floats:
        """See `Coupled`."""
        found = np.zeros(x.shape)
        _image(*self, np.ascontiguousarray(x), found)
        return found


def coupled(gram: Gram, stiff: Any) -> Coupled:
    """The matrix of six kinds of sums, with a symmetric one added for each coordinate."""
    if gram.upper is not None:
        return PackedBlocks.of(gram.upper, stiff if isinstance(stiff, np.ndarray) else stiff.toarray())
    sums: list[Any] = list(gram.matrices())
    return SparseBlocks([csr_array(block + stiff if kind in (0, 3, 5) else block) for kind, block in enumerate(sums)])


def nearly_solved(matrix: Coupled, right: Floats) -> Floats:
    """The solution (size, 3) by conjugate gradients, with the solutions of each coordinate by itself.

    Raises FitError for an unknown that does not occur.
    """
    diagonal = matrix.diagonal()
    require_seen(diagonal.min(axis=1))
    scale = 1 / np.sqrt(diagonal)

    def factored(a: int) -> Solver:
        return first_factored(scaled(matrix.block(a), scale[:, a]))

    solvers = list(in_threads(factored, range(3)))

    def solve(residual: Floats) -> Floats:
        return np.stack(list(in_threads(lambda a: solvers[a](residual[:, a]), range(3))), axis=1)

    x, residual = np.zeros_like(right), scale * right
    enough = _NEARLY * np.linalg.norm(residual)
    move = direction = solve(residual)
    energy = float(np.vdot(residual, move))
    for _ in range(_MOST_STEPS):
        if np.linalg.norm(residual) <= enough:
            break
        bent = scale * matrix.image(scale * direction)
        step = energy / max(float(np.vdot(direction, bent)), np.finfo(float).tiny)
        x, residual = x + step * direction, residual - step * bent
        move = solve(residual)
        before, energy = energy, float(np.vdot(residual, move))
        direction = move + energy / before * direction
    return np.asarray(scale * x)


@compiled(inline=True)
def _is_there(entries, stiff):  # type: ignore[no-untyped-def]
    for kind in range(6):
        if entries[kind] != 0:
            return True
    return stiff != 0


@compiled(arrays=False)
def _count(upper, stiff, count):  # type: ignore[no-untyped-def]
    """How many entries each row of the upper triangle has, the diagonal in any case."""
    for i in range(len(upper)):
        for j in range(i, len(upper)):
            if i == j or _is_there(upper[i, j], stiff[i, j]):
                count[i] += 1


@compiled(arrays=False)
def _pack(upper, stiff, start, column, entries):  # type: ignore[no-untyped-def]
    for i in range(len(upper)):
        place = start[i]
        for j in range(i, len(upper)):
            if i == j or _is_there(upper[i, j], stiff[i, j]):
                column[place] = j
                for kind in range(6):
                    on_diagonal = kind == 0 or kind == 3 or kind == 5
                    entries[place, kind] = upper[i, j, kind] + (stiff[i, j] if on_diagonal else 0.0)
                place += 1


@compiled(arrays=False)
def _unpack(start, column, entries, kind, full):  # type: ignore[no-untyped-def]
    for i in range(len(full)):
        for k in range(start[i], start[i + 1]):
            full[i, column[k]] = full[column[k], i] = entries[k, kind]


@compiled(arrays=False)
def _image(start, column, entries, x, out):  # type: ignore[no-untyped-def]
    """Add the product to out: each entry counts for its row, and off the diagonal for its column."""
    for i in range(len(out)):
        x0, x1, x2 = x[i]
        y0, y1, y2 = 0.0, 0.0, 0.0
        for k in range(start[i], start[i + 1]):
            j = column[k]
            a, b, c, d, e, f = entries[k]
            u, v, w = x[j]
            y0, y1, y2 = y0 + (a * u + b * v + c * w), y1 + (b * u + d * v + e * w), y2 + (c * u + e * v + f * w)
            if j != i:
                out[j, 0] += a * x0 + b * x1 + c * x2
                out[j, 1] += b * x0 + d * x1 + e * x2
                out[j, 2] += c * x0 + e * x1 + f * x2
        out[i, 0] += y0
        out[i, 1] += y1
        out[i, 2] += y2
