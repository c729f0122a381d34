"""Homogeneous polynomials on R^3 in Bernstein form: numbering, values, blossoms, change of triangle.

A polynomial of degree d is F = sum c_a B_a, with B_a = d!/(a1! a2! a3!) lambda^a and x = sum lambda_i v_i; the lambda
need not add up to 1. Its blossom is the symmetric d-linear form B with F(x) = B(x, ..., x), and the coefficient c_a is
B(v_1^a1 v_2^a2 v_3^a3). Exponents are numbered by rows of falling a1, then of falling a2: the number of (a1, a2, a3) is
s (s + 1) / 2 + a3 with s = a2 + a3, whatever the degree is.
"""

from __future__ import annotations

from functools import lru_cache
from math import comb, factorial

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def coefficient_count(degree: int) -> int:
    """The number of coefficients of a homogeneous polynomial in three variables: (degree + 1)(degree + 2) / 2."""
    return comb(degree + 2, 2)


@lru_cache(maxsize=64)
def exponents(degree: int) -> Ints:
    """The exponents (a1, a2, a3) in the order of their numbers, (n, 3); shared between calls and read-only."""
    rows = [(degree - s, s - k, k) for s in range(degree + 1) for k in range(s + 1)]
    found = np.array(rows, dtype=np.intp)
    found.setflags(write=False)
    return found


def exponent_number(a2: int, a3: int) -> int:
    """The number of the exponent (degree - a2 - a3, a2, a3)."""
    s = a2 + a3
    return s * (s + 1) // 2 + a3


@lru_cache(maxsize=64)
def multinomials(degree: int) -> Floats:
    """d! / (a1! a2! a3!) in the order of the exponents, (n,); read-only."""
    found = np.array([factorial(degree) / np.prod([float(factorial(i)) for i in a]) for a in exponents(degree)])
    found.setflags(write=False)
    return found


def bernstein_values(degree: int, coordinates: Floats) -> Floats:
    """The Bernstein polynomials at barycentric coordinates (..., 3), not necessarily of sum 1: (..., n)."""
    powers = np.asarray(coordinates)[..., None] ** np.arange(degree + 1)
    a = exponents(degree)
    return np.asarray(
        multinomials(degree) * powers[..., 0, a[:, 0]] * powers[..., 1, a[:, 1]] * powers[..., 2, a[:, 2]]
    )


def bernstein_gradients(degree: int, coordinates: Floats) -> Floats:
    """The derivatives of the Bernstein polynomials by the three coordinates, (..., 3, n)."""
    coordinates = np.asarray(coordinates)
    slopes = np.zeros((*coordinates.shape[:-1], 3, coefficient_count(degree)))
    if degree:
        lower = degree * bernstein_values(degree - 1, coordinates)
        for i, raised in enumerate(_raised(degree)):
            slopes[..., i, raised] = lower
    return slopes


def bernstein_hessians(degree: int, coordinates: Floats) -> Floats:
    """The second derivatives of the Bernstein polynomials by the coordinates, (..., 3, 3, n)."""
    coordinates = np.asarray(coordinates)
    bends = np.zeros((*coordinates.shape[:-1], 3, 3, coefficient_count(degree)))
    if degree > 1:
        lower = degree * (degree - 1) * bernstein_values(degree - 2, coordinates)
        once, twice = _raised(degree - 1), _raised(degree)
        for i in range(3):
            for j in range(3):
                bends[..., i, j, twice[j][once[i]]] = lower
    return bends


@lru_cache(maxsize=64)
def _raised(degree: int) -> tuple[Ints, Ints, Ints]:
    """The numbers of a + e_i in degree `degree` for all exponents a of one degree less, for i = 1, 2, 3."""
    rows = exponents(degree - 1)
    up = [np.array([exponent_number(a[1] + (i == 1), a[2] + (i == 2)) for a in rows], dtype=np.intp) for i in range(3)]
    return up[0], up[1], up[2]


def polar(coefficients: Floats, coordinates: Floats) -> Floats:
    """One argument of the blossom fixed: the coefficients of B(u, ...) from those of F, one step of de Casteljau.

    coefficients: (..., n_d, m), m polynomials, or forms of m unknowns, at once; coordinates: (..., 3), the barycentric
    coordinates of u. Returns (..., n_(d-1), m).
    """
    degree = degree_of(coefficients.shape[-2])
    parts = [coordinates[..., i, None, None] * coefficients[..., raised, :] for i, raised in enumerate(_raised(degree))]
    return np.asarray(parts[0] + parts[1] + parts[2])


def blossom(coefficients: Floats, arguments: list[Floats]) -> Floats:
    """The blossom at as many arguments as the degree, (..., m); see `polar`. Coordinates (..., 3) each."""
    for argument in arguments:
        coefficients = polar(coefficients, argument)
    return coefficients[..., 0, :]


def degree_of(count: int) -> int:
    """The degree of a polynomial with `count` coefficients."""
    return int(((8 * count + 1) ** 0.5 - 3) / 2 + 0.5)


def symmetric_power(matrix: Floats, degree: int) -> Floats:
    """The matrix that takes the coefficients on one triangle to those on another one, (..., n, n): [new, old].

    matrix: (..., 3, 3), its columns the barycentric coordinates of the corners of the new triangle in the old one. The
    new coefficients are the blossoms B(w_1^a1 w_2^a2 w_3^a3), so they are built one argument at a time.
    """
    power = np.ones((*matrix.shape[:-2], 1, 1))
    for k in range(1, degree + 1):
        larger = np.zeros((*matrix.shape[:-2], coefficient_count(k), coefficient_count(k)))
        done = np.zeros(coefficient_count(k), dtype=np.bool_)
        for i, raised in enumerate(_raised(k)):
            fresh = ~done[raised]
            rows = raised[fresh]
            for j, column in enumerate(_raised(k)):
                larger[..., rows[:, None], column] += matrix[..., j, i, None, None] * power[..., fresh, :]
            done[rows] = True
        power = larger
    return power
