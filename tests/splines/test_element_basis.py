"""Piecewise polynomials: values and jets to third order against the polynomials themselves along geodesics."""

from __future__ import annotations

import numpy as np
import pytest
import spline_checks as checks
from numpy.polynomial import Chebyshev
from orbiframe_bases.bernstein import Bernstein
from orbiframe_bases.clough_tocher import CloughTocher
from orbiframe_bases.powell_sabin import PowellSabin2, PowellSabin3, PowellSabin5, PowellSabin6

from orbiframe import FitError, Points
from orbiframe.splines import ElementBasis, bernstein_values
from orbiframe.splines.galerkin import nearest_to_one

NAMES = ["sphere", "projective plane", "torus", "Klein bottle", "Bolza", "three crosscaps", "one-vertex torus"]
FAMILIES = {"ps2": PowellSabin2, "ps3": PowellSabin3, "ps5": PowellSabin5, "ps6": PowellSabin6}
each_domain = pytest.mark.parametrize("name", NAMES)
each_family = pytest.mark.parametrize("family", FAMILIES)


def on(family: str, name: str) -> ElementBasis:
    domain = checks.domain(name)
    return FAMILIES[family](domain.orbifold, domain)


def sites(basis: ElementBasis) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A point in every fourth micro triangle: its triangle, its number and the point in the frame of the triangle."""
    face, cell = np.divmod(
        np.arange(0, basis.micro_triangles.shape[0] * basis.micro_triangles.shape[1], 4), basis.micro_triangles.shape[1]
    )
    return face, cell, basis.domain.geometry.project(np.array([0.5, 0.2, 0.3]) @ basis.micro_triangles[face, cell])


def seen(basis: ElementBasis, face: np.ndarray, x: np.ndarray) -> Points:
    """The points in the frames of patches."""
    return Points(basis.domain.patch[face], np.einsum("nij,nj->ni", basis.domain.placement[face], x))


def piece(
    basis: ElementBasis, coefficients: np.ndarray, face: np.ndarray, cell: np.ndarray, x: np.ndarray
) -> np.ndarray:
    """The polynomial of a micro triangle at points of X that need not lie in it, (k, n)."""
    inverse = np.linalg.inv(np.swapaxes(basis.micro_triangles[face, cell], 1, 2))
    values = bernstein_values(basis.degree, np.einsum("nij,knj->kni", inverse, x))
    found = np.einsum("kna,na->kn", values, basis.net(coefficients[:, None])[face, cell, :, 0])
    if basis.weights is None or coefficients is basis.weights:
        return np.asarray(found)
    return np.asarray(found / piece(basis, basis.weights, face, cell, x))


@each_domain
@each_family
def test_jets_are_derivatives_along_geodesics(family: str, name: str) -> None:
    """Up to the third, from a Chebyshev series of the polynomial along the geodesic."""
    basis, geometry = on(family, name), checks.domain(name).geometry
    coefficients = checks.random_coefficients(basis)
    face, cell, x = sites(basis)
    jets = basis.jets(seen(basis, face, x), coefficients[:, None], 3)[..., 0]
    frame = geometry.inverse(basis.domain.placement[face]) @ geometry.frame(seen(basis, face, x).x)
    for angle in (0.0, 0.9, np.pi / 2, 2.3):
        c, s = np.cos(angle), np.sin(angle)
        reach = 0.15
        nodes = reach * np.cos(np.pi * (np.arange(24) + 0.5) / 24)
        moved = geometry.exp(x, nodes[:, None, None] * (frame @ np.array([c, s])))
        series = [
            Chebyshev.fit(nodes, line, 16, domain=[-reach, reach])
            for line in piece(basis, coefficients, face, cell, moved).T
        ]
        found = [np.array([f.deriv(k)(0.0) if k else f(0.0) for f in series]) for k in range(4)]
        third = [c * c * jets[6 + 3 * k] + 2 * c * s * jets[7 + 3 * k] + s * s * jets[8 + 3 * k] for k in range(2)]
        wanted = [
            jets[0],
            c * jets[1] + s * jets[2],
            c * c * jets[3] + 2 * c * s * jets[4] + s * s * jets[5],
            c * third[0] + s * third[1],
        ]
        for k in range(4):
            tolerance = (1e-11, 1e-10, 1e-8, 1e-6)[k]
            np.testing.assert_allclose(found[k], wanted[k], atol=tolerance * (1 + np.abs(wanted[k]).max()))


@each_domain
@each_family
def test_jets_of_functions_are_those_of_the_design_matrices(family: str, name: str) -> None:
    basis = on(family, name)
    face, _, x = sites(basis)
    points = seen(basis, face, x)
    coefficients = np.random.default_rng(0).normal(size=(basis.size, 2))
    jets = basis.jets(points, coefficients, 3)
    matrices = basis.jet_matrices(points, 3)
    assert len(matrices) == len(jets) == 12
    for jet, matrix in zip(jets, matrices, strict=True):
        np.testing.assert_allclose(jet, matrix @ coefficients, atol=1e-11 * (1 + np.abs(jet).max()))
    np.testing.assert_allclose(basis.values(points, coefficients), jets[0], atol=1e-12)
    difference = basis.design_matrix(points) - matrices[0]
    assert abs(difference).max() < 1e-14


@pytest.mark.parametrize("name", ["sphere", "projective plane", "Bolza", "three crosscaps"])
@pytest.mark.parametrize("degree", [1, 2, 3, 4])
def test_constants_belong_to_even_degrees_and_to_quotients(degree: int, name: str) -> None:
    """W is there for odd degree alone; the functions of S/W and of even degree have 1 among them, others do not."""
    domain = checks.domain(name)
    basis = Bernstein(domain.orbifold, domain, degree=degree)
    assert (basis.weights is None) == (degree % 2 == 0)
    points = checks.quadrature(basis, 3)[0]
    ones = nearest_to_one(basis)[:, None]
    np.testing.assert_allclose(basis.values(points, ones), 1, atol=1e-9)
    if degree % 2:
        plain = ElementBasis(domain, degree, basis.micro_triangles, basis.matrix, 0, rational=False)
        assert plain.weights is None
        assert np.abs(plain.values(points, ones) - 1).max() > 1e-4


def test_nothing_is_divided_in_the_plane() -> None:
    domain = checks.domain("torus")
    assert Bernstein(domain.orbifold, domain, degree=3).weights is None


def test_an_unknown_that_occurs_twice_in_a_triangle_counts_twice() -> None:
    """On one vertex: all unknowns 1 give the constant 1, and rows of the design matrix have three entries."""
    basis = on("ps2", "one-vertex torus")
    matrix = basis.design_matrix(checks.quadrature(basis, 4)[0])
    assert matrix.shape[1] == 3
    np.testing.assert_allclose(matrix.sum(axis=1), 1, atol=1e-13)
    assert (np.diff(matrix.indptr) == 3).all()


@pytest.mark.parametrize("family", [Bernstein, PowellSabin3, CloughTocher])
@pytest.mark.parametrize("name", ["sphere", "Bolza", "one-vertex torus"])
def test_many_points_in_any_order(family: type[ElementBasis], name: str) -> None:
    """More points than are taken at a time, on whole triangles and on splits in three and in six."""
    domain = checks.domain(name)
    basis = family(domain.orbifold, domain)
    points = checks.quadrature(basis, int(np.sqrt(2500 / np.prod(basis.micro_triangles.shape[:2]))) + 1)[0]
    chosen = np.random.default_rng(1).permutation(len(points.x))[:2500]
    points = Points(points.patch[chosen], points.x[chosen])
    coefficients = np.random.default_rng(0).normal(size=(basis.size, 2))
    assert len(chosen) > 2000
    np.testing.assert_allclose(
        basis.values(points, coefficients), basis.design_matrix(points) @ coefficients, atol=1e-11
    )


@pytest.mark.parametrize("bad", [np.nan, -np.inf])
def test_a_point_that_is_not_finite_is_named(bad: float) -> None:
    basis = on("ps2", "torus")
    x = np.tile([1.0, 0.1, 0.1], (1500, 1))
    x[1400, 1] = bad
    with pytest.raises(FitError, match="point 1400"):
        basis.values(Points(np.zeros(1500, dtype=np.intp), x), np.ones((basis.size, 1)))
