"""How near Powell-Sabin splines come to eigenfunctions and to smooth functions on the Bolza surface."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import spline_checks as checks
from orbiframe_bases.powell_sabin import PowellSabin2, PowellSabin3, PowellSabin4, PowellSabin5, PowellSabin6
from scipy.sparse import diags_array
from scipy.sparse.linalg import eigsh, spsolve

from orbiframe import Points
from orbiframe.splines import ElementBasis
from orbiframe.splines.galerkin import mass, stiffness
from orbiframe.triangulations import GeodesicTriangulation

# Strohmaier and Uski, "An algorithm for the computation of eigenvalues, spectral zeta functions and
# zeta-determinants on hyperbolic surfaces", 2013.
FIRST_EIGENVALUE = 3.838887258842199518586622450435


@cache
def bolza(refinements: int) -> GeodesicTriangulation:
    """16 triangles about the centre of the octagon, refined."""
    if refinements == 0:
        return checks.polygon("abcdABCD", halves=True)
    return bolza(refinements - 1).refined()


@pytest.mark.parametrize(
    ("family", "refinements", "size", "error"),
    [
        (PowellSabin2, 2, 378, 9.7e-4),
        (PowellSabin3, 2, 756, 1.2e-5),
        (PowellSabin4, 2, 1012, 2.2e-6),
        (PowellSabin5, 1, 364, 1.7e-5),
        (PowellSabin5, 2, 1516, 2.5e-8),
        (PowellSabin6, 1, 396, 2.6e-6),
        (PowellSabin6, 2, 1644, 1.0e-8),
    ],
)
def test_the_first_eigenvalue_of_the_bolza_surface(family: type, refinements: int, size: int, error: float) -> None:
    """Three equal eigenvalues from above, as Galerkin's method gives them, with the errors that were measured."""
    basis = family(bolza(refinements).orbifold, bolza(refinements))
    assert basis.size == size
    found = np.sort(eigsh(stiffness(basis), 4, mass(basis), sigma=-0.5)[0])
    excess = found[1:] / FIRST_EIGENVALUE - 1
    assert excess.min() > -1e-10
    assert excess[0] < 2 * error


@pytest.mark.parametrize(
    ("family", "order", "error"),
    [
        (PowellSabin2, 3, 2.0e-3),
        (PowellSabin3, 4, 2.1e-4),
        (PowellSabin4, 4.7, 6.5e-5),
        (PowellSabin5, 5.5, 7.2e-6),
        (PowellSabin6, 6.4, 4.0e-6),
    ],
)
def test_the_order_of_the_projection(family: type, order: float, error: float) -> None:
    coarse, fine = (relative_error(family(bolza(k).orbifold, bolza(k))) for k in (1, 2))
    assert fine < 2 * error
    assert np.log2(coarse / fine) > order - 0.3


def relative_error(basis: ElementBasis) -> float:
    """The distance of two bumps from the space, in the mean square."""
    points, weights = checks.quadrature(basis, 5)
    matrix, wanted = basis.design_matrix(points), bumps(basis, points)
    weighted = matrix.T @ diags_array(weights)
    coefficients = spsolve((weighted @ matrix).tocsc(), weighted @ wanted)
    error = matrix @ coefficients - wanted
    return float(np.sqrt((weights * error**2).sum() / (weights * wanted**2).sum()))


def bumps(basis: ElementBasis, points: Points) -> np.ndarray:
    """exp(-(cosh r - 1) / 0.49) about two points, summed over the group: smooth on X/H."""
    geometry = basis.domain.geometry
    group = basis.orbifold.lifts(0, 7.3)[1]
    centres = geometry.from_polar(np.array([0.4, 1.1]), np.array([0.3, 2.5]))
    lifted = np.einsum("gij,cj->gci", group, centres).reshape(-1, 3)
    lifted = lifted[lifted[:, 0] < np.cosh(5.5)]
    cosh = points.x @ (lifted * [1, -1, -1]).T
    return np.asarray(np.exp(-(cosh - 1) / 0.49).sum(axis=1))


@pytest.mark.parametrize(
    ("family", "bound"),
    [(PowellSabin2, 40), (PowellSabin3, 200), (PowellSabin4, 200), (PowellSabin5, 5e3), (PowellSabin6, 4e3)],
)
def test_the_condition_of_the_mass_matrix(family: type, bound: float) -> None:
    """With functions of norm 1, on 256 triangles."""
    basis = family(bolza(2).orbifold, bolza(2))
    gram = mass(basis)
    scale = diags_array(gram.diagonal() ** -0.5)
    values = np.linalg.eigvalsh((scale @ gram @ scale).toarray())
    assert values[-1] < bound * values[0]
