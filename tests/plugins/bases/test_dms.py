"""DMS splines on X/H: laws, dimensions, reproduction, smoothness."""

from __future__ import annotations

import numpy as np
import pytest
import spline_checks as checks
from orbiframe_bases.dms import DMS
from orbiframe_bases.knot_clouds import knot_clouds
from simplex_checks import jump, reproduction_error

from orbiframe import Points, UsageError
from orbiframe.splines import exponents
from orbiframe.testing import contract_tests
from orbiframe.triangulations import GeodesicTriangulation

NAMES = [name for name in checks.MAKERS if name != "one-vertex Bolza"]

test_laws_of_cubics = contract_tests("basis", DMS, params={"size": 60, "degree": 3})
test_laws_of_all_quadratics = contract_tests("basis", DMS, params={"size": 100, "degree": 2, "condensed": False})


def dms(name: str, **options: object) -> DMS:
    domain = checks.domain(name)
    return DMS(domain.orbifold, domain, **options)


def points(domain: GeodesicTriangulation, count: int) -> Points:
    rng = np.random.default_rng(0)
    face = rng.integers(domain.face_count, size=count)
    x = domain.geometry.project(np.einsum("nc,nci->ni", rng.dirichlet(np.ones(3), count), domain.corners[face]))
    return Points(domain.patch[face], np.einsum("nij,nj->ni", domain.placement[face], x))


@pytest.mark.parametrize("degree", [1, 2, 3, 4])
@pytest.mark.parametrize("name", NAMES)
def test_dimensions(name: str, degree: int) -> None:
    """(n + 1)(n + 2)/2 a triangle, condensed V + (n - 1) E + (n - 1)(n - 2)/2 F."""
    d = checks.domain(name)
    assert dms(name, degree=degree, condensed=False).size == (degree + 1) * (degree + 2) // 2 * d.face_count
    inside = (degree - 1) * (degree - 2) // 2
    assert dms(name, degree=degree).size == d.vertex_count + (degree - 1) * d.edge_count + inside * d.face_count


def before(degree: int):
    """The knots t_(i,0), ..., t_(i,b_i - 1) of every corner."""
    a = exponents(degree)
    return lambda _, o: [(degree + 1) * i + k for i in range(3) for k in range(a[o, i])]


@pytest.mark.parametrize("condensed", [True, False])
@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("name", [name for name in NAMES if not name.startswith("one-vertex")])
def test_polynomials_have_their_blossoms_as_coefficients(name: str, degree: int, condensed: bool) -> None:
    domain = checks.domain(name).refined()
    basis = DMS(domain.orbifold, domain, degree=degree, condensed=condensed)
    assert reproduction_error(basis, before(degree), np.random.default_rng(0)) < 1e-8


@pytest.mark.parametrize("name", ["torus", "Klein bottle", "one-vertex torus"])
def test_functions_add_up_to_one_in_the_plane(name: str) -> None:
    for degree in (1, 2, 3, 4):
        basis = dms(name, degree=degree)
        matrix = basis.design_matrix(points(basis.domain, 200)).toarray()
        assert matrix.min() > -1e-11
        np.testing.assert_allclose(matrix.sum(axis=1), 1, atol=1e-10)


@pytest.mark.parametrize("degree", [2, 3])
@pytest.mark.parametrize("name", ["sphere", "Bolza", "three crosscaps", "torus"])
def test_corners_and_middles_of_edges_lie_in_one_cone_each(name: str, degree: int) -> None:
    """Exactly at knots and on planes through knots values are those nearby: continuity, and constants exact."""
    basis = dms(name, degree=degree)
    d, geometry = basis.domain, basis.domain.geometry
    middles = geometry.project(d.corners + np.roll(d.corners, -1, axis=1))
    x = np.concatenate([d.corners, middles], axis=1)
    tangent = 1e-9 * geometry.frame(x)[..., 0]
    coefficients = np.random.default_rng(0).normal(size=(basis.size, 1))
    here, nearby = (
        basis.values(
            Points(np.repeat(d.patch, 6), np.einsum("fij,fkj->fki", d.placement, y).reshape(-1, 3)), coefficients
        )
        for y in (x, geometry.exp(x, tangent))
    )
    np.testing.assert_allclose(here, nearby, atol=1e-6)


@pytest.mark.parametrize("name", ["projective plane", "torus", "Klein bottle", "Bolza", "three crosscaps"])
@pytest.mark.parametrize("degree", [2, 3])
def test_derivatives_are_as_continuous_as_claimed_and_no_more(name: str, degree: int) -> None:
    basis = dms(name, degree=degree)
    assert basis.smoothness == degree - 1
    assert jump(basis, degree - 1) < 0.1
    assert jump(basis, degree) > 0.3


@pytest.mark.parametrize("name", ["sphere", "Bolza", "Klein bottle"])
def test_third_derivatives_are_differences_of_the_second(name: str) -> None:
    """The change of the Hessian along a geodesic; along it the frame of the origin is carried in parallel."""
    basis = dms(name, degree=4, condensed=False)
    geometry, patch = basis.domain.geometry, np.zeros(7, dtype=np.intp)
    coefficients, h = np.random.default_rng(0).normal(size=(basis.size, 2)), 1e-5
    for angle in (0.0, 0.5 * np.pi):
        radius = np.linspace(0.05, 0.4, 7)
        jets = basis.jets(Points(patch, geometry.from_polar(radius, angle)), coefficients, 3)
        ahead, back = (
            basis.jets(Points(patch, geometry.from_polar(radius + s, angle)), coefficients, 2)[3:] for s in (h, -h)
        )
        rows = slice(6, 9) if angle == 0 else slice(9, 12)
        error = np.abs((ahead - back) / (2 * h) - jets[rows]).max(axis=(0, 2))
        assert np.median(error) < 1e-4 * np.abs(jets[6:]).max()


def test_values_and_design_matrix_agree() -> None:
    basis = dms("three crosscaps", degree=3)
    where = points(basis.domain, 100)
    coefficients = np.random.default_rng(0).normal(size=(basis.size, 3))
    for kind, matrix in enumerate(basis.jet_matrices(where, 3)):
        wanted = basis.jets(where, coefficients, 3)[kind]
        np.testing.assert_allclose(matrix @ coefficients, wanted, atol=1e-10 * np.abs(wanted).max())


def test_clouds_keep_their_distance() -> None:
    domain = checks.domain("three crosscaps")
    clouds = knot_clouds(domain, 3, 0.2)
    shortest = np.full(domain.vertex_count, np.inf)
    lengths = domain.edge_lengths.reshape(-1, 3)
    np.minimum.at(shortest, domain.vertex.ravel(), np.minimum(lengths, np.roll(lengths, 1, axis=1)).ravel())
    distance = domain.geometry.distance(clouds[:, :1], clouds[:, 1:])
    assert (distance < 0.2001 * shortest[:, None]).all()
    assert (distance > 0.05 * shortest[:, None]).all()


@pytest.mark.parametrize(("degree", "order"), [(2, 2.6), (3, 3.3)])
def test_convergence_on_the_torus(degree: int, order: float) -> None:
    """Least squares for a smooth function, on two refinements; order degree + 1 in the limit."""
    domain, errors = checks.domain("torus"), []
    for _ in range(2):
        domain = domain.refined()
        basis = DMS(domain.orbifold, domain, degree=degree)
        where = points(domain, 4 * basis.size)
        phase = 2 * np.pi * where.x[:, 1:] / np.sqrt(domain.orbifold.area)
        wanted = np.exp(np.sin(phase[:, 0]) * np.cos(phase[:, 1]))
        matrix = basis.design_matrix(where)
        solution = np.linalg.solve((matrix.T @ matrix).toarray(), matrix.T @ wanted)
        errors.append(np.sqrt(np.mean((matrix @ solution - wanted) ** 2)))
    assert np.log2(errors[0] / errors[1]) > order


def test_errors_say_what_to_do() -> None:
    with pytest.raises(UsageError, match=r"0\.3"):
        dms("torus", radius=0.4)
    with pytest.raises(UsageError, match="degree"):
        dms("torus", degree=0)
    octahedron = checks.sphere()
    assert DMS(octahedron.orbifold, octahedron, degree=3).weights is not None
