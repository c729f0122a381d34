"""Compiled evaluation of homogeneous polynomials in Bernstein form with their covariant derivatives on X."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.splines.bernstein import coefficient_count, exponent_number, exponents, multinomials

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


class Tables(NamedTuple):
    """Of the degrees d, d - 1, d - 2 and d - 3 (none of negative ones): multinomials, exponents one degree up.

    multinomials: (4, n); raised: (n, 3), the number of a + e_i, the same in every degree; counts: (4,), how many
    exponents each degree has, 0 for a negative one.
    """

    multinomials: Floats
    raised: Ints
    counts: Ints


@lru_cache(maxsize=64)
def polynomial_tables(degree: int) -> Tables:
    """The tables that the kernels read."""
    count = coefficient_count(degree)
    factors = np.zeros((4, count))
    counts = np.array([coefficient_count(k) if k >= 0 else 0 for k in range(degree, degree - 4, -1)], dtype=np.intp)
    for level in range(min(4, degree + 1)):
        factors[level, : counts[level]] = multinomials(degree - level)
    raised = [[exponent_number(a[1] + (i == 1), a[2] + (i == 2)) for i in range(3)] for a in exponents(degree)]
    return Tables(factors, np.array(raised, dtype=np.intp), counts)


@compiled(inline=True)
def _height(inverse, f, m, i, x0, x1, x2):  # type: ignore[no-untyped-def]
    return inverse[f, m, i, 0] * x0 + inverse[f, m, i, 1] * x1 + inverse[f, m, i, 2] * x2


@compiled(inline=True)
def micro_heights(inverse, f, m, x0, x1, x2):  # type: ignore[no-untyped-def]
    """The coordinates of a vector in micro triangle m of triangle f."""
    return (
        _height(inverse, f, m, 0, x0, x1, x2),
        _height(inverse, f, m, 1, x0, x1, x2),
        _height(inverse, f, m, 2, x0, x1, x2),
    )


@compiled(may_divide_by_zero=True)
def micro_triangle(inverse, f, x0, x1, x2):  # type: ignore[no-untyped-def]
    """The micro triangle that holds a point, or the one it is least outside of."""
    best, least = 0, -np.inf
    for m in range(inverse.shape[1]):
        a, b, c = micro_heights(inverse, f, m, x0, x1, x2)
        height = min(a, min(b, c)) / abs(a + b + c)
        if height >= 0:
            return m
        if height > least:
            best, least = m, height
    return best


@compiled(may_divide_by_zero=True)
def fan_triangle(fan, f, a, b, c):  # type: ignore[no-untyped-def]
    """The micro triangle of a fan at coordinates in the whole triangle: edge e, or 2 e and 2 e + 1 beside its R."""
    # Written as choices of numbers, not of ways: a processor cannot foretell in which micro triangle the next point is.
    r0, r1, r2 = a * fan[f, 0], b * fan[f, 1], c * fan[f, 2]
    second = r0 <= r1
    edge, start, end, height = (1 if second else 2), (b if second else c), (c if second else a), min(r0, r1)
    first = r2 <= height
    edge, start, end, height = (0 if first else edge), (a if first else start), (b if first else end), min(r2, height)
    start -= height / fan[f, edge]
    end -= height / fan[f, (edge + 1 if edge < 2 else 0)]
    if fan.shape[1] == 3:
        return edge, start, end, height
    mu, nu = fan[f, 3 + 2 * edge], fan[f, 4 + 2 * edge]
    early = start * nu >= end * mu
    own, other = (start if early else end), (end if early else start)
    ahead = other / (nu if early else mu)
    return 2 * edge + (0 if early else 1), own - ahead * (mu if early else nu), ahead, height


@compiled(may_divide_by_zero=True)
def _fan_coordinates(fan, f, micro, a, b, c):  # type: ignore[no-untyped-def]
    """Coordinates in a micro triangle of a fan from those in the whole triangle; linear in them."""
    edge = micro if fan.shape[1] == 3 else micro // 2
    if edge == 0:
        height, start, end = c * fan[f, 2], a - c * fan[f, 2] / fan[f, 0], b - c * fan[f, 2] / fan[f, 1]
    elif edge == 1:
        height, start, end = a * fan[f, 0], b - a * fan[f, 0] / fan[f, 1], c - a * fan[f, 0] / fan[f, 2]
    else:
        height, start, end = b * fan[f, 1], c - b * fan[f, 1] / fan[f, 2], a - b * fan[f, 1] / fan[f, 0]
    if fan.shape[1] == 3:
        return start, end, height
    mu, nu = fan[f, 3 + 2 * edge], fan[f, 4 + 2 * edge]
    if micro % 2 == 0:
        return start - end / nu * mu, end / nu, height
    return end - start / mu * nu, start / mu, height


@compiled
def _values(tables, level, degree, point, powers, out):  # type: ignore[no-untyped-def]
    """The Bernstein polynomials of degree d - level at a point, by tabulated powers."""
    top = degree - level
    for i in range(3):
        power, base = 1.0, point[i]
        for k in range(top + 1):
            powers[i, k] = power
            power *= base
    a = 0
    for total in range(top + 1):
        for third in range(total + 1):
            product = powers[0, top - total] * powers[1, total - third] * powers[2, third]
            out[a] = tables.multinomials[level, a] * product
            a += 1


@compiled
def _raise_degree(tables, level, factor, direction, lower, out):  # type: ignore[no-untyped-def]
    """Derivative by a direction: from polynomials of degree d - level - 1 to those of degree d - level."""
    for a in range(tables.counts[level]):
        out[a] = 0.0
    for a in range(tables.counts[level + 1]):
        value = factor * lower[a]
        for i in range(3):
            out[tables.raised[a, i]] += direction[i] * value


@compiled
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
    for kind in range(1, kinds):
        for a in range(count):
            jet[kind, a] = 0.0
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


@compiled
def fill_rows(place, matrix, tables, row_start, values):  # type: ignore[no-untyped-def]
    """The rows of design matrices: the Bernstein jets at every point times the rows of C of its micro triangle.

    place: the `Location` of the points, inverses and fans of the micro triangles, how many there are in a triangle,
    (curvature, degree); matrix: row starts, values and places in the rows of the result of the nonzeros of C;
    row_start: (points + 1,); values: (kinds, nonzeros), zero before.
    """
    (order, face, columns), inverse, fan, micro_count, shape = place
    start, data, slot = matrix
    kinds, count = len(values), tables.counts[0]
    work, powers = np.empty((3, count)), np.empty((3, shape[1] + 1))
    jet, lam = np.empty((kinds, count)), np.empty((3, 3))
    for n in range(len(order)):
        micro = _coordinates(inverse, fan, face[n], columns, n, kinds, lam)
        _jet(shape, tables, lam, kinds, work, powers, jet)
        row = (face[n] * micro_count + micro) * count
        for a in range(count):
            for k in range(start[row + a], start[row + a + 1]):
                where = row_start[order[n]] + slot[k]
                for kind in range(kinds):
                    values[kind, where] += jet[kind, a] * data[k]


@compiled
def _coordinates(inverse, fan, f, columns, n, kinds, lam):  # type: ignore[no-untyped-def]
    """The micro triangle of point n; rows of `lam`: the coordinates of the point and of its frame vectors.

    inverse: of the micro triangles, (F, m, 3, 3), or of the whole triangles, (F, 1, 3, 3), where they are fans.
    """
    whole = fan.shape[1] > 0
    x0, x1, x2 = columns[n, 0, 0], columns[n, 1, 0], columns[n, 2, 0]
    micro = 0 if whole else micro_triangle(inverse, f, x0, x1, x2)
    a, b, c = micro_heights(inverse, f, micro, x0, x1, x2)
    if whole:
        micro, a, b, c = fan_triangle(fan, f, a, b, c)
    lam[0, 0], lam[0, 1], lam[0, 2] = a, b, c
    if kinds > 1:
        for k in (1, 2):
            a, b, c = micro_heights(
                inverse, f, 0 if whole else micro, columns[n, 0, k], columns[n, 1, k], columns[n, 2, k]
            )
            if whole:
                a, b, c = _fan_coordinates(fan, f, micro, a, b, c)
            lam[k, 0], lam[k, 1], lam[k, 2] = a, b, c
    return micro


@compiled
def evaluate_nets(place, nets, tables, values):  # type: ignore[no-untyped-def]
    """Jets of functions with given Bernstein coefficients: nets (F, m, n, q), values (kinds, points, q)."""
    (order, face, columns), inverse, fan, _, shape = place
    kinds, count, width = len(values), tables.counts[0], nets.shape[3]
    work, powers = np.empty((3, count)), np.empty((3, shape[1] + 1))
    jet, lam = np.empty((kinds, count)), np.empty((3, 3))
    for n in range(len(order)):
        micro = _coordinates(inverse, fan, face[n], columns, n, kinds, lam)
        _jet(shape, tables, lam, kinds, work, powers, jet)
        for kind in range(kinds):
            for q in range(width):
                total = 0.0
                for a in range(count):
                    total += jet[kind, a] * nets[face[n], micro, a, q]
                values[kind, order[n], q] = total


@compiled(arrays=False)
def _sort(values, begin, end):  # type: ignore[no-untyped-def]
    """Sort a short piece of an array by insertion."""
    for k in range(begin + 1, end):
        value, place = values[k], k
        while place > begin and values[place - 1] > value:
            values[place] = values[place - 1]
            place -= 1
        values[place] = value


@compiled
def unknowns_of_triangles(start, indices, rows, size):  # type: ignore[no-untyped-def]
    """The unknowns that the rows of C of each triangle mention: (F + 1,) starts, columns, places of all nonzeros.

    start, indices: of C; rows: how many a triangle has; size: how many unknowns there are. The columns of a triangle
    increase; the place of a nonzero is that of its unknown among those of its triangle.
    """
    faces = (len(start) - 1) // rows
    first, place = np.zeros(faces + 1, dtype=np.intp), np.empty(len(indices), dtype=np.int32)
    column = np.empty(len(indices), dtype=np.intp)
    seen, number = np.full(size, -1, dtype=np.intp), np.empty(size, dtype=np.int32)
    count = 0
    for f in range(faces):
        low, high = start[f * rows], start[(f + 1) * rows]
        for k in range(low, high):
            if seen[indices[k]] != f:
                seen[indices[k]] = f
                column[count] = indices[k]
                count += 1
        _sort(column, first[f], count)
        for k in range(first[f], count):
            number[column[k]] = k - first[f]
        for k in range(low, high):
            place[k] = number[indices[k]]
        first[f + 1] = count
    return first, column[:count].copy(), place
