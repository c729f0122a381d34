"""Hybrid splines: dimension, smoothness, cubics, exact derivatives, vertices and orders."""

from __future__ import annotations

import element_checks
import numpy as np
import pytest
import spline_checks
from orbiframe_bases.clough_tocher import CloughTocher
from orbiframe_bases.hybrid import Hybrid
from third_derivatives import error_of_third_derivatives

from orbiframe import Points
from orbiframe.testing import contract_tests

NAMES = list(spline_checks.MAKERS)

test_contract = contract_tests("basis", Hybrid, params={"size": 120})


def splines(name: str) -> Hybrid:
    domain = spline_checks.domain(name)
    return Hybrid(domain.orbifold, domain)


@pytest.mark.parametrize("name", NAMES)
def test_three_functions_a_vertex_and_one_an_edge(name: str) -> None:
    basis = splines(name)
    assert basis.size == 3 * basis.domain.vertex_count + basis.domain.edge_count
    matrix = basis.design_matrix(element_checks.spread_points(basis.domain, 30)).toarray()
    assert np.linalg.matrix_rank(matrix) == basis.size


@pytest.mark.parametrize("name", NAMES)
def test_first_derivatives_are_continuous_and_second_are_not(name: str) -> None:
    basis = splines(name)
    smooth = [element_checks.jumps_of_jets(basis, basis.domain, k) for k in (0, 1)]
    assert max(smooth) < 5e-5
    assert element_checks.jumps_of_jets(basis, basis.domain, 2) > 0.1


def test_jumps_show_a_slope_that_one_side_does_not_know_of() -> None:
    basis = splines("Bolza")
    basis._inside.matrix.data[:252] *= 1.01
    assert element_checks.jumps_of_jets(basis, basis.domain, 0) < 1e-5
    assert element_checks.jumps_of_jets(basis, basis.domain, 1) > 1e-4


@pytest.mark.parametrize("name", ["torus", "Klein bottle"])
def test_plane_cubics_on_single_triangles(name: str) -> None:
    basis = splines(name)
    domain = basis.domain
    share = np.random.default_rng(2).dirichlet(np.ones(3), 60)
    plane = (share @ domain.corners[0])[:, 1:]
    points = Points(np.full(60, domain.patch[0]), domain.geometry.act(domain.placement[0], share @ domain.corners[0]))
    matrix = basis.design_matrix(points).toarray()
    cubics = np.stack([plane[:, 0] ** i * plane[:, 1] ** j for i in range(4) for j in range(4 - i)], axis=1)
    found = np.linalg.lstsq(matrix, cubics, rcond=1e-12)[0]
    np.testing.assert_allclose(matrix @ found, cubics, atol=1e-12)


@pytest.mark.parametrize("name", ["sphere", "projective plane", "torus", "Bolza", "three crosscaps"])
def test_third_derivatives_are_differences_of_the_hessian(name: str) -> None:
    """Well inside of the triangles, away from edges and vertices."""
    basis = splines(name)
    domain, geometry = basis.domain, basis.orbifold.geometry
    middle = geometry.project(np.einsum("c,fci->fi", [0.3, 0.32, 0.38], domain.corners))
    points = Points(domain.patch, geometry.settle(geometry.act(domain.placement, middle)))
    assert error_of_third_derivatives(basis, points, 1e-3).max() < 1e-4


def at_vertices(basis: Hybrid, share: float) -> Points:
    """Points near the first corners of triangles, or at them for 0."""
    domain, geometry = basis.domain, basis.orbifold.geometry
    x = geometry.project((1 - share) * domain.corners[:, 0] + share * domain.corners[:, 1:].mean(axis=1))
    return Points(domain.patch, geometry.settle(geometry.act(domain.placement, x)))


@pytest.mark.parametrize("name", NAMES)
def test_values_and_slopes_at_vertices_are_their_limits(name: str) -> None:
    basis = splines(name)
    there, near = (np.stack([m.toarray() for m in basis.jet_matrices(at_vertices(basis, s), 1)]) for s in (0, 1e-9))
    np.testing.assert_allclose(there, near, atol=1e-6 * np.abs(there).max())
    assert all(np.isfinite(m.data).all() for m in basis.jet_matrices(at_vertices(basis, 0), 3))


def test_third_derivatives_near_a_vertex_grow_like_one_over_the_distance() -> None:
    basis = splines("torus")
    size = [np.abs(basis.jet_matrices(at_vertices(basis, s), 3)[6].data).max() for s in (1e-4, 1e-6)]
    assert size[1] / size[0] == pytest.approx(100, rel=0.05)


@pytest.mark.parametrize("name", ["torus", "Bolza"])
def test_order_of_convergence_and_errors_like_those_of_clough_tocher(name: str) -> None:
    domain = spline_checks.domain(name)
    wanted, errors = element_checks.bumps(domain), []
    domain = domain.refined()
    for _ in range(2):
        domain = domain.refined()
        errors.append(
            [
                element_checks.error_of_fit(family(domain.orbifold, domain), domain, wanted, 15)
                for family in (Hybrid, CloughTocher)
            ]
        )
    assert 3.2 < np.log2(errors[0][0] / errors[1][0]) < 4.8
    assert errors[1][0] < 1.1 * errors[1][1]
