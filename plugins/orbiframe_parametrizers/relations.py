"""Relations: transitions moved by rounding back onto the relations round the triangles."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, diags_array, eye_array
from scipy.sparse.linalg import lsmr, splu

from orbiframe import Geometry

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_ROUNDS = 8
_SHIFT = 1e-9
_ROUNDED = 5e-14  # a defect that is rounding already: products of three isometries at a distance of 1 to 3
_FACTORED = 8000  # from more unknowns on the factors of a group with many handles, an expander, fill up
_DIGITS = 1e-10


def with_relations(geometry: Geometry, transition: Ints, isometry: Floats) -> Floats:
    """The isometries (T, 3, 3) nearest to the given ones for which every triangle closes: g0 g1 g2 = e.

    transition: (H,), three for each triangle; isometries come in pairs of inverses 2k + 1, 2k + 2 after the identity.
    Each free one is multiplied by exp(xi); the relations are linear in xi up to second order, and the least xi is
    found, again as long as the defect falls (Gauss-Newton) and is more than rounding. Turning and moving the frame of
    a patch breaks no relation, and the least xi does neither. Matrices that are off the group are made isometries
    first: no xi mends that, and the first defect would hide what the round gained.
    """
    relations = _distinct_relations(transition)
    if not len(relations):
        return isometry
    best, solve = isometry, None
    if geometry.isometry_defect(isometry).max() > _ROUNDED:
        best = _moved(geometry, isometry, np.zeros(3 * (len(isometry) // 2)))
    defect = _defect(best, relations)
    for _ in range(_ROUNDS):
        if defect <= _ROUNDED:
            break
        solve = solve or _least_squares(_linearised(geometry, relations, best))
        trial = _moved(geometry, best, solve(-_residual(best, relations)))
        new = _defect(trial, relations)
        if not new < defect:
            break
        best, defect = trial, new
    return best


def _distinct_relations(transition: Ints) -> Ints:
    rows = transition.reshape(-1, 3)
    rows = np.unique(rows[(rows > 0).any(axis=1)], axis=0)
    turns = np.stack([np.roll(rows, shift, axis=1) for shift in range(3)], axis=1)
    keys = turns @ np.array([int(transition.max() + 1) ** 2, int(transition.max() + 1), 1])
    first = turns[np.arange(len(rows)), keys.argmin(axis=1)]
    return np.unique(first, axis=0)


def _defect(isometry: Floats, relations: Ints) -> float:
    g = isometry[relations]
    return float(np.abs(g[:, 0] @ g[:, 1] @ g[:, 2] - np.eye(3)).max())


def _residual(isometry: Floats, relations: Ints) -> Floats:
    g = isometry[relations]
    return _algebra_coordinates(g[:, 0] @ g[:, 1] @ g[:, 2] - np.eye(3)).ravel()


def _moved(geometry: Geometry, isometry: Floats, xi: Floats) -> Floats:
    """Every free isometry times exp(xi), to first order, and its inverse."""
    moved = geometry.nearest_isometry(isometry[1::2] @ (np.eye(3) + _algebra(geometry, xi.reshape(-1, 3))))
    corrected = isometry.copy()
    corrected[1::2], corrected[2::2] = moved, geometry.inverse(moved)
    return corrected


def _linearised(geometry: Geometry, relations: Ints, isometry: Floats) -> csr_array[Any]:
    """The derivative of the residual by xi."""
    g = isometry[relations]
    suffixes = [g[:, 1] @ g[:, 2], g[:, 2], np.broadcast_to(np.eye(3), g[:, 0].shape)]
    rows, columns, values = [], [], []
    for slot in range(3):
        number = relations[:, slot] - 1
        reversed_ = (number % 2 == 1)[:, None, None]
        carrier = np.where(reversed_, g[:, slot] @ suffixes[slot], suffixes[slot])
        block = _adjoint(geometry, geometry.inverse(carrier)) * np.where(reversed_, -1.0, 1.0)
        used = np.flatnonzero(number >= 0)
        i = (3 * used)[:, None, None] + np.arange(3)[:, None] + np.zeros(3, dtype=np.intp)
        j = (3 * (number[used] // 2))[:, None, None] + np.zeros(3, dtype=np.intp)[:, None] + np.arange(3)
        rows.append(i.ravel())
        columns.append(j.ravel())
        values.append(block[used].ravel())
    free = (len(isometry) - 1) // 2
    shape = (3 * len(relations), 3 * free)
    place = np.concatenate(rows), np.concatenate(columns)
    return coo_array((np.concatenate(values), place), shape=shape).tocsr()


def _least_squares(matrix: csr_array[Any]) -> Callable[[Floats], Floats]:
    """For a right side the least vector that comes as near to a solution as any, to about eight digits."""
    return _by_factors(matrix) if matrix.shape[1] <= _FACTORED else _by_iteration(matrix)


def _by_factors(matrix: csr_array[Any]) -> Callable[[Floats], Floats]:
    """From the normal equations, factored once; a tiny shift makes them definite."""
    normal = (matrix.T @ matrix).tocsc()
    shifted = normal + _SHIFT * float(normal.diagonal().mean()) * eye_array(normal.shape[0], format="csc")
    options = {"SymmetricMode": True}
    factors = splu(shifted.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    return lambda right: np.asarray(factors.solve(matrix.T @ right))


def _by_iteration(matrix: csr_array[Any]) -> Callable[[Floats], Floats]:
    """By LSMR (Fong and Saunders 2011) on rows of length 1; the relations g e g^-1 = e have rows of zeros."""
    length = np.sqrt(matrix.multiply(matrix).sum(axis=1))
    weight = np.divide(1.0, length, out=np.zeros_like(length), where=length > _DIGITS * length.max())
    rows = csr_array(diags_array(weight) @ matrix)
    rows.eliminate_zeros()
    limits: dict[str, Any] = {"atol": _DIGITS, "btol": _DIGITS, "conlim": 0.0}
    return lambda right: np.asarray(lsmr(rows, weight * right, **limits)[0])


def _algebra(geometry: Geometry, xi: Floats) -> Floats:
    """Infinitesimal isometries (..., 3, 3) from (turn, move along x1, move along x2)."""
    k = -float(geometry.curvature)
    turn, u, v = np.moveaxis(xi, -1, 0)
    zero = np.zeros_like(turn)
    rows = [[zero, k * u, k * v], [u, zero, -turn], [v, turn, zero]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _algebra_coordinates(matrix: Floats) -> Floats:
    turn = (matrix[..., 2, 1] - matrix[..., 1, 2]) / 2
    return np.stack([turn, matrix[..., 1, 0], matrix[..., 2, 0]], axis=-1)


def _adjoint(geometry: Geometry, g: Floats) -> Floats:
    """The matrices (..., 3, 3) of xi -> g xi g^-1 in the coordinates of `_algebra`."""
    basis = _algebra(geometry, np.eye(3))
    moved = g[..., None, :, :] @ basis @ geometry.inverse(g)[..., None, :, :]
    return np.moveaxis(_algebra_coordinates(moved), -2, -1)
