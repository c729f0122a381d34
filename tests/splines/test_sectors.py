"""Splines with creases: continuous everywhere, smooth but across creases and hairs, as many as the sectors say."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import spline_checks as checks
from hypothesis import given, settings, strategies as st
from orbiframe_bases.clough_tocher import CloughTocher
from orbiframe_bases.powell_sabin import PowellSabin2, PowellSabin6

from orbiframe.errors import FitError
from orbiframe.splines import ElementBasis, Sectors, hair_points
from orbiframe.triangulations import GeodesicTriangulation

FAMILIES = {"ps2": PowellSabin2, "clough-tocher": CloughTocher}
each_family = pytest.mark.parametrize("family", list(FAMILIES.values()), ids=list(FAMILIES))


def with_creases(name: str, share: float, seed: int = 0) -> GeodesicTriangulation:
    """A small domain where a share of the edges, drawn at random, are creases: darts, chains, corners of any degree."""
    domain = checks.domain(name)
    chosen = np.random.default_rng(seed).random(domain.edge_count) < share
    return replace(domain, crease=chosen[domain.edge])


def jumps_by_edge(basis: ElementBasis, order: int) -> tuple[np.ndarray, np.ndarray]:
    """The relative jumps of a random function at edges of micro triangles; the halfedge of each, -1 inside."""
    sides, coefficients = checks.both_sides(basis), checks.random_coefficients(basis)
    here = checks._derivatives(basis, coefficients, order, sides.face, sides.cell, sides.frame)
    there = checks._derivatives(basis, coefficients, order, sides.other_face, sides.other_cell, sides.other_frame)
    inverse = np.linalg.inv(np.swapaxes(basis.domain.corners, 1, 2))[sides.face]
    height = np.einsum("nij,nj->ni", inverse, sides.frame[:, :, 0])
    halfedge = np.where(sides.crossed, 3 * sides.face + (np.abs(height).argmin(axis=1) + 1) % 3, -1)
    return np.abs(here - there).max(axis=1) / np.abs(here).max(), halfedge


@each_family
@pytest.mark.parametrize("share", [0.15, 0.5, 1.0])
@pytest.mark.parametrize("name", list(checks.MAKERS))
def test_functions_are_smooth_but_across_creases_and_hairs(name: str, share: float, family: type) -> None:
    domain = with_creases(name, share)
    basis, sectors = family(domain.orbifold, domain), Sectors(domain)
    assert jumps_by_edge(basis, 0)[0].max() < 1e-12
    jump, halfedge = jumps_by_edge(basis, 1)
    opened = (halfedge >= 0) & sectors.open[halfedge]
    assert jump[~opened].max() < 1e-12
    assert (domain.creased <= sectors.open).all()


@each_family
def test_functions_do_bend_across_creases(family: type) -> None:
    """At every crease with a split end: a basis for which creases mean nothing fails here."""
    domain = with_creases("Bolza", 0.5)
    jump, halfedge = jumps_by_edge(family(domain.orbifold, domain), 1)
    split = Sectors(domain).split[domain.vertex].ravel()
    for crease in np.flatnonzero(domain.creased & split & domain.reference):
        assert jump[halfedge == crease].max() > 1e-3
    plain = replace(domain, crease=None)
    assert jumps_by_edge(family(plain.orbifold, plain), 1)[0].max() < 1e-12


@each_family
@settings(max_examples=12, deadline=None)
@given(name=st.sampled_from(list(checks.MAKERS)), share=st.floats(0, 1), seed=st.integers(0, 99))
def test_there_are_as_many_functions_as_sectors_say(name: str, share: float, seed: int, family: type) -> None:
    """Independent; 1 + k at a vertex with k >= 2 open edges, 3 at others; clough-tocher: one for each side of edges."""
    domain = with_creases(name, share, seed)
    basis, sectors = family(domain.orbifold, domain), Sectors(domain)
    first = np.flatnonzero(sectors.open & domain.reference)
    ends = domain.vertex.ravel()[np.concatenate([first, first - first % 3 + (first + 1) % 3])]
    degree = np.bincount(ends, minlength=domain.vertex_count)
    wanted = np.where(domain.crease_degree >= 2, 1 + degree, 3).sum()
    wanted += (domain.edge_count + len(first)) * (family is CloughTocher)
    assert basis.size == wanted
    dense = basis.matrix.toarray()
    assert np.linalg.matrix_rank(dense / np.abs(dense).max(axis=0), tol=1e-9) == basis.size


@each_family
@pytest.mark.parametrize("name", ["sphere", "torus", "Bolza", "three crosscaps"])
def test_smooth_functions_are_among_them(name: str, family: type) -> None:
    domain = with_creases(name, 0.4)
    plain = family(domain.orbifold, replace(domain, crease=None))
    wide, smooth = family(domain.orbifold, domain).matrix.toarray(), plain.matrix.toarray()
    residual = wide @ np.linalg.lstsq(wide, smooth, rcond=None)[0] - smooth
    assert np.abs(residual).max() < 1e-10 * np.abs(smooth).max()


@each_family
@pytest.mark.parametrize("name", ["sphere", "Klein bottle", "Bolza"])
def test_constants_are_exact(name: str, family: type) -> None:
    domain = with_creases(name, 0.4)
    basis = family(domain.orbifold, domain)
    points = checks.quadrature(basis, 3)[0]
    matrix = basis.design_matrix(points).toarray()
    one = np.linalg.lstsq(matrix, np.ones(len(matrix)), rcond=None)[0]
    np.testing.assert_allclose(basis.values(points, one[:, None]), 1, atol=1e-11)


@pytest.mark.parametrize("name", ["sphere", "torus", "Klein bottle", "Bolza", "three crosscaps"])
def test_every_sector_has_a_hair(name: str) -> None:
    """By brute force round each vertex: between two creases there is a hair, unless no edge lies between."""
    domain = with_creases(name, 0.4)
    sectors, vertex = Sectors(domain), domain.vertex.ravel()
    assert not (sectors.hair & domain.creased).any()
    assert (sectors.hair == sectors.hair[domain.twin]).all()
    for corners, crossed in sectors._fans():
        assert len({vertex[c] for c in corners}) == 1
        assert len(corners) == len(crossed) + 1
        assert bool(crossed) == bool(sectors.hair[crossed].any())
        assert all(not domain.creased[e] for e in crossed)
    around = sum(len(corners) for corners, _ in sectors._fans())
    assert around == int(sectors.split[vertex].sum())


def test_no_part_of_a_sector_is_straight() -> None:
    """The two edges of a part are never opposite, where an edge lies between them: else no gradient follows."""
    domain = with_creases("Bolza", 0.3, seed=3)
    sectors = Sectors(domain)
    inverse = np.linalg.inv(
        sectors.triangles(np.tile(np.eye(3), (domain.vertex_count, 1, 1)))[sectors.split[sectors.vertex]]
    )
    assert np.abs(inverse).max() < 100


def test_points_of_hairs_lie_on_both_sides() -> None:
    domain = with_creases("three crosscaps", 0.4)
    inside, outside, across = hair_points(domain)
    geometry = domain.geometry
    assert len(across) == 4 * (Sectors(domain).hair & domain.reference).sum()
    np.testing.assert_allclose(np.linalg.norm(across, axis=1), 1)
    gap = geometry.distance(inside.x, outside.x)
    assert gap.max() < 1e-6
    way = np.einsum("nij,nj->ni", geometry.frame(outside.x), across)
    assert (geometry.inner(outside.x, way, inside.x - outside.x) > 0.1 * gap).all()


def test_creases_are_halved_with_their_triangles() -> None:
    domain = with_creases("Klein bottle", 0.4)
    fine = domain.refined()
    assert (fine.creased == fine.creased[fine.twin]).all()
    length = [d.edge_lengths[d.creased & d.reference].sum() for d in (domain, fine)]
    np.testing.assert_allclose(*length)
    assert fine.creased.sum() == 2 * domain.creased.sum()


def test_other_functions_refuse_creases() -> None:
    domain = with_creases("sphere", 0.4)
    with pytest.raises(FitError, match="keep no creases"):
        PowellSabin6(domain.orbifold, domain)


def test_sectors_are_numbered_by_their_first_corners() -> None:
    sectors = Sectors(with_creases("Bolza", 0.4))
    first = np.unique(sectors.corner, return_index=True)[1]
    assert all(a < b for a, b in pairwise(first))
    plain = Sectors(checks.domain("Bolza"))
    np.testing.assert_array_equal(plain.corner, checks.domain("Bolza").vertex)
