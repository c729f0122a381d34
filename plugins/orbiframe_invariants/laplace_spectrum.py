"""Spectra: the eigenvalues of the Laplacian of X/H in a space of piecewise polynomials."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from orbiframe import FitError
from orbiframe.splines import ElementBasis, mass, stiffness
from orbiframe.triangulations import GeodesicTriangulation

Floats = NDArray[np.float64]


_LONGEST_EDGE = 0.8
# Edges resolve a wave where edge length times square root of the eigenvalue stays below this, for degrees from 8 on.
_RESOLUTION = 4.0
_FIRST_DEGREE, DEGREE, _LOWEST, _HIGHEST = 4, 10, 4, 14
_SAME = 1e-7
_ROUNDING = 1e-14
_MOST = 60_000  # functions, which take a minute and some gigabytes
_MARGIN = 6  # eigenvalues beyond the wanted one, among which the iteration converges

Family = Callable[[GeodesicTriangulation, int], ElementBasis]


class Eigenvalue(NamedTuple):
    """An eigenvalue of the Laplacian -Delta, how often it occurs, and how far it may be off: see `laplace_spectrum`."""

    value: float
    multiplicity: int
    error: float


def laplace_spectrum(
    domain: GeodesicTriangulation,
    family: Family,
    count: int,
    *,
    degree: int = DEGREE,
    tolerance: float | None = None,
) -> list[Eigenvalue]:
    """The `count` smallest different eigenvalues of X/H with their multiplicities, from 0 on.

    By Galerkin's method, so all values are upper bounds, up to rounding: in the space `family(domain, degree)` of
    continuous polynomials of an even degree, which contains the constants, on a triangulation refined until it resolves
    the waves. The error falls like h^(2 degree): it is the difference from the values of degree - 2, or what rounding
    does to values that should be equal and to the 0 if that is more. Values nearer to one another than ten errors, or
    1e-7, count as one.

    tolerance: the largest error, relative to values above 1; the degree is raised, then the triangulation refined,
    until it is met. Raises FitError for a count below 1, for a degree that is odd or not from 4 to 14, and for a
    tolerance that is not met with the most functions.
    """
    if count < 1:
        raise FitError(f"{count} eigenvalues are wanted; ask for at least 1")
    if degree % 2 or not _LOWEST <= degree <= _HIGHEST:
        raise FitError(f"the degree is {degree}; it must be even, from {_LOWEST} to {_HIGHEST}")
    number = _needed(domain, family, count)
    while True:
        found = _within(_resolving(domain, number), family, number, count, degree, tolerance)
        if len(found) >= count:
            return found[:count]
        number *= 2


def _within(
    domain: GeodesicTriangulation, family: Family, number: int, count: int, degree: int, tolerance: float | None
) -> list[Eigenvalue]:
    """The different ones of so many eigenvalues, the first `count` to a tolerance."""
    rough = eigenvalues(family(domain, degree - 2), number)
    while True:
        values = eigenvalues(family(domain, degree), number)
        found = _clusters(values, np.abs(rough - values) + _rounding(values))
        worst = max((e.error / max(e.value, 1) for e in found[:count]), default=0.0)
        if tolerance is None or worst <= tolerance or len(found) < count:
            return found
        if degree < _HIGHEST:
            degree, rough = degree + 2, values
            continue
        # Half the edges have errors that are smaller by 2^-2d, and the next degree below shows them.
        domain = domain.refined()
        size = domain.face_count * degree**2 // 2
        if size > _MOST:
            raise FitError(
                f"the tolerance {tolerance:g} is not met: the error is {worst:.1e}, and {size} functions would be the "
                f"next; ask for a tolerance of {1.1 * worst:.1e}, or for fewer eigenvalues"
            )
        rough = eigenvalues(family(domain, degree - 2), number)


def _rounding(values: Floats) -> Floats:
    """What rounding does to eigenvalues, about: to the first, which is 0, and to equal ones."""
    return np.asarray(np.abs(values[0]) + _ROUNDING * np.maximum(values, 1))


def _needed(domain: GeodesicTriangulation, family: Family, count: int) -> int:
    """How many eigenvalues hold `count` different ones and begin the next, by a first look in a smaller space."""
    number = count + 8
    while True:
        values = eigenvalues(family(_resolving(domain, number), _FIRST_DEGREE), number)
        found = _clusters(values, 1e-5 * np.maximum(values, 1))
        if len(found) >= count:
            return sum(e.multiplicity for e in found[:count]) + 3
        number *= 2


def eigenvalues(space: ElementBasis, number: int) -> Floats:
    """The `number` smallest eigenvalues of the Laplacian in a space of functions on X/H, increasing, (number,).

    By Lanczos' method on the inverse of the shifted problem. Raises FitError for a space that is too small.
    """
    return _solved(space, number, False)[0]


def eigenfunctions(space: ElementBasis, number: int) -> tuple[Floats, Floats]:
    """The `number` smallest eigenvalues, (number,), and the coefficients of eigenfunctions, (size, number).

    They are orthonormal in L2; of a multiple eigenvalue some basis is taken. The largest coefficient is positive.
    """
    values, vectors = _solved(space, number, True)
    largest = np.take_along_axis(vectors, np.abs(vectors).argmax(axis=0)[None], axis=0)
    return values, vectors * np.sign(largest)


def eigenfunction(domain: GeodesicTriangulation, family: Family, number: int) -> tuple[ElementBasis, Floats, float]:
    """Eigenfunction `number` of X/H, counted from the constant one, 0, on with multiplicity.

    Returns a space of functions on a refined triangulation, the coefficients in it, (size, 1), and the eigenvalue.
    Raises FitError for a negative number.
    """
    if number < 0:
        raise FitError(f"eigenfunction {number} is wanted; they are counted from 0, the constant one")
    count = number + _MARGIN
    space = family(_resolving(domain, count), DEGREE - 2)
    values, coefficients = eigenfunctions(space, count)
    return space, coefficients[:, number : number + 1], float(values[number])


def _solved(space: ElementBasis, number: int, vectors: bool) -> tuple[Floats, Floats]:
    """The smallest eigenvalues, increasing, and their vectors as columns; none unless asked for."""
    if number >= space.size - 1:
        raise FitError(
            f"{number} eigenvalues are wanted of a space of {space.size} functions; refine the triangulation"
        )
    m, k = csc_array(mass(space)), csc_array(stiffness(space))
    factor = splu(csc_array(k + m), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    start = np.random.default_rng(0).standard_normal(space.size)
    inverse = LinearOperator(k.shape, matvec=factor.solve, dtype=np.float64)
    options: dict[str, Any] = {"sigma": -1.0, "which": "LM", "OPinv": inverse, "v0": start}
    if not vectors:
        found = eigsh(k, number, m, **options, return_eigenvectors=False)
        return np.sort(np.asarray(found)), np.zeros((space.size, 0))
    values, columns = eigsh(k, number, m, **options)
    order = np.argsort(values)
    return np.asarray(values[order]), np.asarray(columns[:, order])


def _resolving(domain: GeodesicTriangulation, number: int) -> GeodesicTriangulation:
    """The triangulation refined until no edge is too long for the highest of so many eigenvalues."""
    # Weyl: about area / (4 pi) eigenvalues lie below each unit.
    highest = 4 * np.pi * number / domain.orbifold.area
    longest = min(_LONGEST_EDGE, _RESOLUTION / np.sqrt(highest))
    if domain.geometry.curvature == 0:
        longest = min(longest, np.sqrt(domain.orbifold.area) / 3)
    while domain.edge_lengths.max() > longest:
        domain = domain.refined()
    return domain


def _clusters(values: Floats, errors: Floats) -> list[Eigenvalue]:
    """Runs of values that cannot be told apart; the last run is left out, because it may not be whole."""
    margin = np.maximum(10 * errors, _SAME * np.maximum(values, 1))
    cuts = np.flatnonzero(np.diff(values) > margin[1:]) + 1
    runs = np.split(np.arange(len(values)), cuts)[:-1]
    found = [
        Eigenvalue(float(values[run].mean()), len(run), float(max(errors[run].max(), np.ptp(values[run]))))
        for run in runs
    ]
    # The constants are in the space, and their eigenvalue is 0.
    return [Eigenvalue(0.0, found[0].multiplicity, 0.0), *found[1:]] if found and abs(found[0].value) < _SAME else found
