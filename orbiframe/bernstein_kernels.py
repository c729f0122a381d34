"""Compiled evaluation of homogeneous polynomials in Bernstein form with their covariant derivatives on X."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from orbiframe.bernstein import coefficient_count, exponent_number, exponents, multinomials

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


class Tables(NamedTuple):
    """Of the degrees d, d - 1, d - 2 and d - 3 (negative ones as 0): exponents, multinomials, numbers one degree up.

    exponents: (4, n, 3); multinomials: (4, n); raised: (n, 3), the number of a + e_i, the same in every degree; counts:
    (4,), how many exponents each degree has, 0 for a negative one.
    """

    exponents: Ints
    multinomials: Floats
    raised: Ints
    counts: Ints


@lru_cache(maxsize=64)
def polynomial_tables(degree: int) -> Tables:
    """The tables that the kernels read."""
    count = coefficient_count(degree)
    powers, factors = np.zeros((4, count, 3), dtype=np.intp), np.zeros((4, count))
    counts = np.array([coefficient_count(k) if k >= 0 else 0 for k in range(degree, degree - 4, -1)], dtype=np.intp)
    for level in range(min(4, degree + 1)):
        powers[level, : counts[level]] = exponents(degree - level)
        factors[level, : counts[level]] = multinomials(degree - level)
    raised = [[exponent_number(a[1] + (i == 1), a[2] + (i == 2)) for i in range(3)] for a in exponents(degree)]
    return Tables(powers, factors, np.array(raised, dtype=np.intp), counts)


@njit(cache=True, inline="always")
def _lambda(matrix, columns, k, out):  # type: ignore[no-untyped-def]
    for i in range(3):
        out[i] = matrix[i, 0] * columns[0, k] + matrix[i, 1] * columns[1, k] + matrix[i, 2] * columns[2, k]


@njit(cache=True)
def _cell(inverse, columns, out):  # type: ignore[no-untyped-def]
    """The micro triangle that holds a point, or the one it is least outside of; its coordinates go to `out`."""
    best, least = 0, -np.inf
    if len(inverse) > 1:
        for m in range(len(inverse)):
            _lambda(inverse[m], columns, 0, out)
            height = min(out[0], min(out[1], out[2])) / abs(out[0] + out[1] + out[2])
            if height > least:
                best, least = m, height
            if least >= 0:
                break
    _lambda(inverse[best], columns, 0, out)
    return best


@njit(cache=True)
def _values(tables, level, degree, point, powers, out):  # type: ignore[no-untyped-def]
    """The Bernstein polynomials of degree d - level at a point, by tabulated powers."""
    for i in range(3):
        powers[i, 0] = 1.0
        for k in range(degree - level):
            powers[i, k + 1] = powers[i, k] * point[i]
    for a in range(tables.counts[level]):
        e = tables.exponents[level, a]
        out[a] = tables.multinomials[level, a] * powers[0, e[0]] * powers[1, e[1]] * powers[2, e[2]]


@njit(cache=True)
def _raise_degree(tables, level, factor, direction, lower, out):  # type: ignore[no-untyped-def]
    """Derivative by a direction: from polynomials of degree d - level - 1 to those of degree d - level."""
    out[: tables.counts[level]] = 0.0
    for a in range(tables.counts[level + 1]):
        value = factor * lower[a]
        for i in range(3):
            out[tables.raised[a, i]] += direction[i] * value


@njit(cache=True)
def _jet(shape, tables, lam, kinds, work, powers, jet):  # type: ignore[no-untyped-def]
    """Values and covariant derivatives of all Bernstein polynomials at one point: jet (kinds, n).

    lam: (3, 3), the coordinates of the point and of its two frame vectors, in rows. With F of degree d, K the curvature
    and u, v, w tangent: D_u f = F_u, Hess(u, v) = F_uv - K d F <u, v>, and the derivative of the Hessian along w is
    F_uvw - K (d - 1) (<u, w> F_v + <v, w> F_u) - K d <u, v> F_w.
    """
    curvature, degree = shape
    count = tables.counts[0]
    _values(tables, 0, degree, lam[0], powers, jet[0])
    if kinds == 1:
        return
    jet[1:kinds] = 0.0
    if degree >= 1:
        _values(tables, 1, degree, lam[0], powers, work[0])
        for u in range(2):
            _raise_degree(tables, 0, degree, lam[1 + u], work[0], jet[1 + u])
    if kinds == 3:
        return
    if degree >= 2:
        _values(tables, 2, degree, lam[0], powers, work[0])
        for kind, (u, v) in enumerate(((0, 0), (0, 1), (1, 1))):
            _raise_degree(tables, 1, degree - 1, lam[1 + u], work[0], work[1])
            _raise_degree(tables, 0, degree, lam[1 + v], work[1], jet[3 + kind])
    for a in range(count):
        jet[3, a] -= curvature * degree * jet[0, a]
        jet[5, a] -= curvature * degree * jet[0, a]
    if kinds == 6:
        return
    if degree >= 3:
        _values(tables, 3, degree, lam[0], powers, work[0])
        for w in range(2):
            for kind, (u, v) in enumerate(((0, 0), (0, 1), (1, 1))):
                _raise_degree(tables, 2, degree - 2, lam[1 + u], work[0], work[1])
                _raise_degree(tables, 1, degree - 1, lam[1 + v], work[1], work[2])
                _raise_degree(tables, 0, degree, lam[1 + w], work[2], jet[6 + 3 * w + kind])
    for w in range(2):
        for kind, (u, v) in enumerate(((0, 0), (0, 1), (1, 1))):
            for a in range(count):
                mixed = (u == w) * jet[1 + v, a] + (v == w) * jet[1 + u, a]
                jet[6 + 3 * w + kind, a] -= curvature * ((degree - 1) * mixed + degree * (u == v) * jet[1 + w, a])


@njit(cache=True)
def fill_rows(place, matrix, tables, row_start, values):  # type: ignore[no-untyped-def]
    """The rows of design matrices: the Bernstein jets at every point times the rows of C of its micro triangle.

    place: triangles, columns (n, 3, 1 or 3), inverses of the micro triangles, (curvature, degree); matrix: row
    starts, values and places in the rows of the result of the nonzeros of C; row_start: (points + 1,); values:
    (kinds, nonzeros), zero before.
    """
    face, columns, inverse, shape = place
    start, data, slot = matrix
    kinds, count, cells = len(values), tables.counts[0], inverse.shape[1]
    work, powers = np.empty((3, count)), np.empty((3, shape[1] + 1))
    jet, lam = np.empty((kinds, count)), np.empty((3, 3))
    for n in range(len(face)):
        cell = _coordinates(inverse[face[n]], columns[n], kinds, lam)
        _jet(shape, tables, lam, kinds, work, powers, jet)
        row = (face[n] * cells + cell) * count
        for a in range(count):
            for k in range(start[row + a], start[row + a + 1]):
                where = row_start[n] + slot[k]
                for kind in range(kinds):
                    values[kind, where] += jet[kind, a] * data[k]


@njit(cache=True)
def _coordinates(inverse, columns, kinds, lam):  # type: ignore[no-untyped-def]
    """The micro triangle of a point; rows of `lam`: the coordinates of the point and of its frame vectors."""
    cell = _cell(inverse, columns, lam[0])
    if kinds > 1:
        _lambda(inverse[cell], columns, 1, lam[1])
        _lambda(inverse[cell], columns, 2, lam[2])
    return cell


@njit(cache=True)
def evaluate_nets(place, nets, tables, values):  # type: ignore[no-untyped-def]
    """Jets of functions with given Bernstein coefficients: nets (F, m, n, q), values (kinds, points, q)."""
    face, columns, inverse, shape = place
    kinds, count, width = len(values), tables.counts[0], nets.shape[3]
    work, powers = np.empty((3, count)), np.empty((3, shape[1] + 1))
    jet, lam = np.empty((kinds, count)), np.empty((3, 3))
    for n in range(len(face)):
        cell = _coordinates(inverse[face[n]], columns[n], kinds, lam)
        _jet(shape, tables, lam, kinds, work, powers, jet)
        net = nets[face[n], cell]
        for kind in range(kinds):
            for q in range(width):
                values[kind, n, q] = 0.0
            for a in range(count):
                for q in range(width):
                    values[kind, n, q] += jet[kind, a] * net[a, q]
