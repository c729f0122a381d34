"""Galerkin matrices against quadrature of values and jets, areas and known spectra."""

from __future__ import annotations

import numpy as np
import pytest
import spline_checks as checks
from orbiframe_bases.bernstein import Bernstein
from orbiframe_bases.powell_sabin import PowellSabin2, PowellSabin3, PowellSabin5, PowellSabin6
from scipy.linalg import eigh
from scipy.sparse import csr_array, diags_array

from orbiframe.splines import ElementBasis
from orbiframe.splines.galerkin import integrals, mass, nearest_to_one, stiffness

NAMES = ["sphere", "projective plane", "torus", "Klein bottle", "Bolza", "three crosscaps"]
each_domain = pytest.mark.parametrize("name", NAMES)


def on(family: type, name: str, **options: object) -> ElementBasis:
    domain = checks.domain(name)
    return family(domain.orbifold, domain, **options)


def products(matrices: list[csr_array], weights: np.ndarray) -> np.ndarray:
    """Sums of scalar products of the columns of matrices with weighted rows."""
    return sum((m.T @ diags_array(weights) @ m).toarray() for m in matrices)


def close(found: csr_array, wanted: np.ndarray, tolerance: float = 1e-9) -> None:
    np.testing.assert_allclose(found.toarray(), wanted, atol=tolerance * np.abs(wanted).max())


@each_domain
@pytest.mark.parametrize("family", [PowellSabin2, PowellSabin6])
def test_scalar_products_are_integrals_of_values_and_jets(family: type, name: str) -> None:
    """Against quadrature of what the basis says of itself, far more points than are needed."""
    basis = on(family, name)
    points, weights = checks.quadrature(basis, 16)
    value, *jet = basis.jet_matrices(points, 1)
    close(mass(basis), products([value], weights))
    close(stiffness(basis), products(jet, weights))
    np.testing.assert_allclose(integrals(basis), value.T @ weights, atol=1e-9)


@each_domain
def test_the_constant_one_has_the_area_as_its_square_and_no_energy(name: str) -> None:
    """All coefficients of 1 are 1 in the quadratic B-spline basis."""
    basis, ones = on(PowellSabin2, name), np.ones
    one, area = ones(basis.size), basis.orbifold.area
    assert one @ (mass(basis) @ one) == pytest.approx(area, rel=1e-9)
    assert integrals(basis) @ one == pytest.approx(area, rel=1e-9)
    energy = stiffness(basis)
    assert np.abs(energy @ one).max() < 1e-10 * np.abs(energy).max()
    np.testing.assert_allclose(nearest_to_one(basis), 1, atol=1e-8)


def spectrum(basis: ElementBasis, count: int) -> np.ndarray:
    return np.asarray(eigh(stiffness(basis).toarray(), mass(basis).toarray(), eigvals_only=True)[:count])


def test_eigenvalues_of_the_sphere() -> None:
    """l (l + 1), 2 l + 1 times; a basis of degree d has the spherical harmonics of degree d, d - 2, ... exactly."""
    wanted = [degree * (degree + 1) for degree in range(5) for _ in range(2 * degree + 1)]
    np.testing.assert_allclose(spectrum(on(Bernstein, "sphere", degree=4), 25), wanted, rtol=3e-3, atol=1e-9)
    fine = spectrum(on(PowellSabin6, "sphere"), 25)
    np.testing.assert_allclose(fine, wanted, rtol=1e-5, atol=1e-9)
    exact = [degree for degree in (0, 2, 4) for _ in range(2 * degree + 1)]
    for degree in set(exact):
        own = np.abs(fine - degree * (degree + 1)) < 0.1
        np.testing.assert_allclose(fine[own], degree * (degree + 1), rtol=1e-11, atol=1e-10)


def test_eigenvalues_of_the_projective_plane() -> None:
    """Of even degree only, and those up to degree 6 are exact in degree 6."""
    wanted = [degree * (degree + 1) for degree in (0, 2, 4, 6) for _ in range(2 * degree + 1)]
    np.testing.assert_allclose(spectrum(on(PowellSabin6, "projective plane"), 28), wanted, rtol=1e-10, atol=1e-10)


def test_eigenvalues_of_the_square_torus() -> None:
    """4 pi^2 (m^2 + n^2)."""
    wanted = 4 * np.pi**2 * np.array([0, 1, 1, 1, 1, 2, 2, 2, 2])
    np.testing.assert_allclose(spectrum(on(Bernstein, "torus", degree=8), 9), wanted, rtol=1e-9, atol=1e-9)


def test_eigenvalues_of_the_square_klein_bottle() -> None:
    """pi^2 (m^2 + 4 n^2), from e^(i pi m x) cos(2 pi n y) for even m and e^(i pi m x) sin(2 pi n y) for odd m.

    The glide (x, y) -> (x + 1, -y) leaves them as they are.
    """
    even = [m * m + 4 * n * n for m in range(-4, 5, 2) for n in range(5)]
    odd = [m * m + 4 * n * n for m in range(-5, 6, 2) for n in range(1, 5)]
    found = spectrum(on(Bernstein, "Klein bottle", degree=8), 12)
    np.testing.assert_allclose(found, np.pi**2 * np.sort(even + odd)[:12], rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize(("family", "error"), [(PowellSabin3, 3e-2), (PowellSabin5, 4e-3)])
@pytest.mark.parametrize("name", ["sphere", "Bolza"])
def test_the_function_nearest_to_one_is_near_to_it(family: type, error: float, name: str) -> None:
    """Of odd degree there is none that is 1, and the nearest one has the right mean."""
    domain = checks.domain(name)
    basis = family(domain.orbifold, domain)
    points, weights = checks.quadrature(basis, 12)
    plain = ElementBasis(domain, basis.degree, basis.micro_triangles, basis.matrix, 1, rational=False)
    values = plain.values(points, nearest_to_one(plain)[:, None])[:, 0]
    assert 1e-6 < np.abs(values - 1).max() < error
    assert weights @ values == pytest.approx(weights @ values**2, rel=1e-8)
