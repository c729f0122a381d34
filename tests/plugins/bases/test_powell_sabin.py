"""Powell-Sabin splines: dimension, smoothness, reproduction, constants, control triangles."""

from __future__ import annotations

import copy
from functools import cache

import numpy as np
import pytest
import spline_checks as checks
from orbiframe_bases.powell_sabin import (
    PowellSabin,
    PowellSabin2,
    PowellSabin3,
    PowellSabin4,
    PowellSabin5,
    PowellSabin6,
)

from orbiframe import FitError, Points
from orbiframe.splines import (
    PowellSabinSplit,
    Unknowns,
    blossom,
    coefficient_count,
    edge_normals,
    exponents,
    symmetric_power,
)
from orbiframe.splines.galerkin import nearest_to_one

FAMILIES = [PowellSabin2, PowellSabin3, PowellSabin4, PowellSabin5, PowellSabin6]
DOMAINS = list(checks.MAKERS)
EVEN = [PowellSabin2, PowellSabin4, PowellSabin6]

each_family = pytest.mark.parametrize("family", FAMILIES, ids=lambda family: f"ps{family.polynomial_degree}")
each_domain = pytest.mark.parametrize("name", DOMAINS)


@cache
def basis_on(family: type[PowellSabin], name: str) -> PowellSabin:
    domain = checks.domain(name)
    return family(domain.orbifold, domain)


@each_domain
def test_dimensions(name: str) -> None:
    domain = checks.domain(name)
    v, e, f = domain.vertex_count, domain.edge_count, domain.face_count
    sizes = [basis_on(family, name).size for family in FAMILIES]
    assert sizes == [3 * v, 6 * v, 6 * v + f, 10 * v + f, 10 * v + e]


# ---- smoothness -----------------------------------------------------------------------------------------------------

# The highest derivative without a jump: across edges of the triangulation, and inside of its triangles.
SMOOTH = {PowellSabin2: (1, 1), PowellSabin3: (2, 1), PowellSabin4: (1, 2), PowellSabin5: (2, 2), PowellSabin6: (2, 3)}


@each_domain
@each_family
def test_smoothness_is_what_is_claimed_and_no_more(family: type[PowellSabin], name: str) -> None:
    """Random splines: jumps at rounding level up to an order, and a jump of the next derivative."""
    basis = basis_on(family, name)
    coefficients = checks.random_coefficients(basis)
    for across, smooth in zip(("macro", "inner"), SMOOTH[family], strict=True):
        found = [checks.jumps(basis, coefficients, order, across) for order in range(smooth + 2)]
        assert max(found[:-1]) < 3e-12
        assert found[-1] > 1e-2
    assert basis.smoothness == min(SMOOTH[family])


@each_family
def test_jumps_are_seen(family: type[PowellSabin]) -> None:
    """A spline with one coefficient of one micro triangle off by a thousandth is not continuous."""
    broken = copy.copy(basis_on(family, "Bolza"))
    broken.matrix = broken.matrix.copy()
    broken.matrix.data[0] *= 1.001
    assert checks.jumps(broken, checks.random_coefficients(broken), 0) > 1e-8


# ---- reproduction ---------------------------------------------------------------------------------------------------


@each_family
@pytest.mark.parametrize("name", ["sphere", "torus", "Klein bottle", "Bolza", "three crosscaps"])
def test_polynomials_are_reproduced_from_their_own_jets(family: type[PowellSabin], name: str) -> None:
    """On one triangle: the unknowns of a random polynomial give its own coefficients on all micro triangles."""
    basis = basis_on(family, name)
    d, domain = basis.degree, basis.domain
    unknowns = Unknowns(domain, coefficient_count(family.jet_order), family.on_edge, family.in_face)
    face = next(f for f, own in enumerate(unknowns.numbers) if len(set(own)) == len(own))
    polynomial = np.random.default_rng(1).normal(size=(coefficient_count(d), 1))
    own = local_unknowns(basis, face, lambda *arguments: blossom(polynomial, list(arguments))[0])
    rows = 6 * coefficient_count(d)
    nets = basis.matrix[face * rows : (face + 1) * rows][:, unknowns.numbers[face]] @ own
    wanted = symmetric_power(np.swapaxes(basis.micro_triangles[face], 1, 2), d) @ polynomial
    np.testing.assert_allclose(nets.reshape(6, -1), wanted[..., 0], atol=1e-10 * np.abs(wanted).max())


def local_unknowns(basis: PowellSabin, face: int, form) -> np.ndarray:
    """The unknowns of one triangle of the polynomial with a given blossom, by what they mean."""
    d, k, domain = basis.degree, basis.jet_order, basis.domain
    split, corners = PowellSabinSplit(domain), domain.corners[face]
    z, r = split.incentre[face], split.edge_point[face]
    found = []
    for c in range(3):
        q = domain.corner_frame[face, c] @ basis.vertex_triangles[domain.vertex[face, c]]
        found += [form(*[corners[c]] * (d - k), *np.repeat(q.T, a, axis=0)) for a in exponents(k)]
    if basis.on_edge:
        found += [form(*[r[e]] * (d - 2), *[edge_normals(domain)[face, e]] * 2) for e in range(3)]
    if basis.in_face:
        found.append(form(*[z] * (d - 3), *corners))
    return np.array(found)


@pytest.mark.parametrize(
    ("family", "name"),
    [(family, "sphere") for family in FAMILIES] + [(family, "projective plane") for family in EVEN],
)
def test_spherical_polynomials_are_splines(family: type[PowellSabin], name: str) -> None:
    """Homogeneous polynomials of R^3 live on all of S^2, and for even degree on P^2."""
    basis = basis_on(family, name)
    wanted = restrictions(basis)
    coefficients = np.linalg.lstsq(basis.matrix.toarray(), wanted, rcond=None)[0]
    np.testing.assert_allclose(basis.matrix @ coefficients, wanted, atol=1e-12)


def restrictions(basis: PowellSabin) -> np.ndarray:
    """The Bernstein coefficients of all monomials of the degree on all micro triangles, (F m n, n)."""
    columns = basis.domain.placement[:, None] @ np.swapaxes(basis.micro_triangles, 2, 3)
    return symmetric_power(columns, basis.degree).reshape(basis.matrix.shape[0], -1)


# ---- constants ------------------------------------------------------------------------------------------------------


@each_domain
@pytest.mark.parametrize("family", [PowellSabin4, PowellSabin6])
def test_constants_are_splines_of_even_degree(family: type[PowellSabin], name: str) -> None:
    basis = basis_on(family, name)
    values = basis.values(some_points(basis), nearest_to_one(basis)[:, None])
    np.testing.assert_allclose(values, 1, atol=2e-10)


@each_domain
@pytest.mark.parametrize("family", [PowellSabin3, PowellSabin5])
def test_constants_are_quotients_of_splines_of_odd_degree(family: type[PowellSabin], name: str) -> None:
    basis = basis_on(family, name)
    assert (basis.weights is None) == (basis.domain.geometry.curvature == 0)
    ones = nearest_to_one(basis)[:, None]
    np.testing.assert_allclose(basis.values(some_points(basis), ones), 1, atol=1e-12)


def some_points(basis: PowellSabin) -> Points:
    return checks.quadrature(basis, 2)[0]


# ---- the basis of non-negative functions ----------------------------------------------------------------------------


@each_domain
def test_quadratic_functions_are_a_partition_of_unity_and_not_negative(name: str) -> None:
    basis = basis_on(PowellSabin2, name)
    matrix = basis.design_matrix(some_points(basis))
    assert matrix.data.min() > -1e-12
    np.testing.assert_allclose(matrix.sum(axis=1), 1, atol=1e-11)
    assert basis.matrix.data.min() > -1e-11


@each_domain
def test_surfaces_touch_their_control_triangles(name: str) -> None:
    """At a vertex the point is a convex combination of three control points, and both tangents lie in their plane."""
    basis = basis_on(PowellSabin2, name)
    domain = basis.domain
    coefficients = np.random.default_rng(2).normal(size=(basis.size, 3))
    control = basis.control_triangles(coefficients)
    face, corner = np.divmod(domain.vertex_corner, 3)
    v = domain.corners[face, corner]
    weights = np.linalg.solve(basis.vertex_triangles, v[:, :, None])[..., 0]
    assert weights.min() > 0
    points = Points(domain.patch[face], np.einsum("nij,nj->ni", domain.placement[face], v))
    value, first, second = basis.jets(points, coefficients, 1)
    np.testing.assert_allclose(value, np.einsum("ni,nij->nj", weights, control), atol=1e-10)
    normal = np.cross(control[:, 1] - control[:, 0], control[:, 2] - control[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    for tangent in (first, second):
        np.testing.assert_allclose((tangent * normal).sum(axis=1), 0, atol=1e-9 * np.abs(tangent).max())


def test_another_orbifold_is_refused() -> None:
    with pytest.raises(FitError, match="another orbifold"):
        PowellSabin2(checks.domain("torus").orbifold, checks.domain("Klein bottle"))
