"""Spectra: the eigenvalues of the Laplacian of X/H in a space of piecewise polynomials."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from orbiframe.element_basis import ElementBasis
from orbiframe.errors import FitError
from orbiframe.galerkin import mass, stiffness
from orbiframe.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]

_LONGEST_EDGE = 0.8
# Edges resolve a wave where edge length times square root of the eigenvalue stays below this, for degrees from 8 on.
_RESOLUTION = 4.0
_DEGREES = 8, 10
_SAME = 1e-7


class Eigenvalue(NamedTuple):
    """An eigenvalue of the Laplacian -Delta, how often it occurs, and how far two degrees are apart on it."""

    value: float
    multiplicity: int
    error: float


def laplace_spectrum(
    domain: GeodesicTriangulation, family: Callable[[GeodesicTriangulation, int], ElementBasis], count: int
) -> list[Eigenvalue]:
    """The `count` smallest different eigenvalues of X/H with their multiplicities, from 0 on.

    By Galerkin's method, so all values are upper bounds: in the spaces `family(domain, degree)` of continuous
    polynomials of the even degrees 8 and 10, which contain the constants, on a triangulation refined until it resolves
    the waves. The error of a value falls like h^(2 degree), and the difference of the two degrees bounds it. Values
    nearer to one another than ten such differences count as one. Raises FitError for a count below 1.
    """
    if count < 1:
        raise FitError(f"{count} eigenvalues are wanted; ask for at least 1")
    number = 2 * count + 6
    while True:
        # Weyl: about area / (4 pi) eigenvalues lie below each unit.
        highest = 4 * np.pi * number / domain.orbifold.area
        fine = _resolving(domain, highest)
        rough, values = (eigenvalues(family(fine, degree), number) for degree in _DEGREES)
        found = _clusters(values, np.abs(rough - values))
        # The last cluster may go on beyond the numbers that were computed.
        if len(found) > count:
            return found[:count]
        number *= 2


def eigenvalues(space: ElementBasis, number: int) -> Floats:
    """The `number` smallest eigenvalues of the Laplacian in a space of functions on X/H, increasing, (number,).

    By Lanczos' method on the inverse of the shifted problem. Raises FitError for a space that is too small.
    """
    if number >= space.size - 1:
        raise FitError(
            f"{number} eigenvalues are wanted of a space of {space.size} functions; refine the triangulation"
        )
    m, k = csc_array(mass(space)), csc_array(stiffness(space))
    factor = splu(csc_array(k + m), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    start = np.random.default_rng(0).standard_normal(space.size)
    inverse = LinearOperator(k.shape, matvec=factor.solve, dtype=np.float64)
    found = eigsh(k, number, m, sigma=-1.0, which="LM", OPinv=inverse, v0=start, return_eigenvectors=False)
    return np.sort(np.asarray(found))


def _resolving(domain: GeodesicTriangulation, highest: float) -> GeodesicTriangulation:
    """The triangulation refined until no edge is too long for the highest of the wanted eigenvalues."""
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
    found = [Eigenvalue(float(values[run].mean()), len(run), float(errors[run].max())) for run in runs]
    return [Eigenvalue(0.0, *found[0][1:]), *found[1:]] if found and abs(found[0].value) < _SAME else found
