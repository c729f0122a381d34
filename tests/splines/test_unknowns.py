"""Unknowns, jets at vertices, triangles about vertices, normals and the Powell-Sabin split."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import reference_surfaces as surfaces
import spline_checks as checks
from hypothesis import given, settings, strategies as st

from orbiframe.splines import (
    PowellSabinSplit,
    Unknowns,
    VertexJets,
    blossom,
    coefficient_count,
    edge_normals,
    enclosing_triangles,
    exponents,
    shaped_triangles,
    symmetric_power,
)
from orbiframe.triangulations import GeodesicTriangulation

each_domain = pytest.mark.parametrize("name", list(checks.MAKERS))


# ---- unknowns -------------------------------------------------------------------------------------------------------


@each_domain
@pytest.mark.parametrize("counts", [(3, 0, 0), (0, 2, 0), (6, 0, 1), (10, 1, 2)])
def test_unknowns_are_numbered_once(name: str, counts: tuple[int, int, int]) -> None:
    domain = checks.domain(name)
    unknowns = Unknowns(domain, *counts)
    numbers = unknowns.numbers
    assert numbers.shape == (domain.face_count, unknowns.local_size)
    np.testing.assert_array_equal(np.unique(numbers), np.arange(unknowns.size))
    for c in range(3):
        first = numbers[:, unknowns.vertex_slots(c)]
        assert (first == counts[0] * domain.vertex[:, c, None] + np.arange(counts[0])).all()
    edges = np.stack([numbers[:, unknowns.edge_slots(e)] for e in range(3)], axis=1).reshape(
        3 * domain.face_count, counts[1]
    )
    np.testing.assert_array_equal(edges, edges[domain.twin])
    assert len(np.unique(numbers[:, unknowns.face_slots])) == counts[2] * domain.face_count


@each_domain
def test_forms_are_assembled_by_addition(name: str) -> None:
    """Against a dense matrix; on one vertex the unknowns of all corners are the same ones."""
    domain = checks.domain(name)
    unknowns = Unknowns(domain, 2, 1, 1)
    nets = np.random.default_rng(0).normal(size=(domain.face_count, 2, 3, unknowns.local_size))
    nets[:, 0, :, 3:] = 0
    wanted = np.zeros((domain.face_count * 6, unknowns.size))
    for f, numbers in enumerate(unknowns.numbers):
        np.add.at(wanted[6 * f : 6 * f + 6].T, numbers, nets[f].reshape(6, -1).T)
    found = unknowns.matrix(nets)
    np.testing.assert_allclose(found.toarray(), wanted, atol=1e-15)
    assert found.has_canonical_format
    assert found.nnz <= (nets != 0).sum()


def test_large_domains_are_assembled_in_parts() -> None:
    """What is asked for at a time covers every triangle once, in order."""
    domain = checks.domain("torus").refined()
    unknowns, asked = Unknowns(domain, 1, 0, 0), []

    def nets(faces: slice) -> np.ndarray:
        asked.append(faces)
        return np.ones((faces.stop - faces.start, 1, 3000, 3))

    matrix = unknowns.assembled(nets, np.ones((1, 3000, 3), dtype=bool))
    assert len(asked) > 1
    assert asked[0].start == 0
    assert asked[-1].stop == domain.face_count
    assert all(one.stop == two.start for one, two in pairwise(asked))
    np.testing.assert_array_equal(matrix.sum(axis=1), 3)


# ---- jets -----------------------------------------------------------------------------------------------------------


@each_domain
@pytest.mark.parametrize("order", [1, 2, 3])
def test_jets_are_the_same_polynomial_in_every_triangle(name: str, order: int) -> None:
    """The forms at every corner, against blossoms of the unknowns at vectors carried back to the vertex."""
    domain = checks.domain(name)
    triangles = shaped_triangles(domain, PowellSabinSplit(domain).around, 1.3)
    jets = VertexJets(domain, order, triangles)
    assert jets.count == coefficient_count(order)
    unknowns = np.random.default_rng(order).normal(size=(domain.vertex_count, jets.count, 1))
    own = jets.own_forms(slice(None))
    for c in range(3):
        vectors = np.swapaxes(np.roll(domain.corners, -c, axis=1), 1, 2)
        np.testing.assert_allclose(jets.forms(c, vectors), own[:, c], atol=1e-12 * np.abs(own).max())
        for f in range(0, domain.face_count, 5):
            v = domain.vertex[f, c]
            seen = np.linalg.solve(triangles[v], domain.geometry.inverse(domain.corner_frame[f, c]) @ vectors[f])
            wanted = [blossom(unknowns[v], list(np.repeat(seen.T, a, axis=0)))[0] for a in exponents(order)]
            np.testing.assert_allclose(own[f, c] @ unknowns[v, :, 0], wanted, atol=1e-9 * np.abs(wanted).max())


def test_forms_of_lower_order_are_powers_too() -> None:
    domain = checks.domain("Bolza")
    jets = VertexJets(domain, 3, shaped_triangles(domain, PowellSabinSplit(domain).around, 1.3))
    vectors = np.swapaxes(domain.corners, 1, 2)
    np.testing.assert_allclose(symmetric_power(jets.forms(0, vectors, 1), 3).shape, jets.forms(0, vectors).shape)
    cubed = symmetric_power(np.swapaxes(jets.forms(0, vectors, 1), 1, 2), 3)
    np.testing.assert_allclose(cubed, jets.forms(0, vectors), atol=1e-12 * np.abs(cubed).max())


# ---- triangles about vertices ---------------------------------------------------------------------------------------


@each_domain
def test_triangles_lie_on_tangent_planes_round_their_vertices(name: str) -> None:
    """beta(v, q) = 1 for the corners q, beta = x0 y0 + K (x1 y1 + x2 y2), and v is their centre of gravity."""
    domain = checks.domain(name)
    around, k = PowellSabinSplit(domain).around, domain.geometry.curvature
    v = domain.corners.reshape(-1, 3)[domain.vertex_corner]
    for triangles in (shaped_triangles(domain, around, 1.4), enclosing_triangles(domain, around)):
        plane = np.einsum("ni,nij->nj", v * np.array([1, k, k]), triangles)
        np.testing.assert_allclose(plane, 1, atol=1e-11)
        np.testing.assert_allclose(triangles.mean(axis=2), v, atol=1e-10)
        assert (np.linalg.det(triangles) > 0).all()


@each_domain
def test_enclosing_triangles_hold_their_stars_and_touch_them(name: str) -> None:
    domain = checks.domain(name)
    around = PowellSabinSplit(domain).around
    triangles = enclosing_triangles(domain, around)
    back = np.linalg.inv(triangles)[domain.vertex] @ domain.geometry.inverse(domain.corner_frame)
    share = np.einsum("fcij,fcmj->fcmi", back, around)
    share /= np.abs(share.sum(axis=-1, keepdims=True))
    assert share.min() > -1e-10
    least = np.full(domain.vertex_count, np.inf)
    np.minimum.at(least, domain.vertex, share.min(axis=(2, 3)))
    assert least.max() < 1e-10


# ---- edges and the split --------------------------------------------------------------------------------------------


@each_domain
def test_normals_are_as_long_as_their_edges_and_cross_them(name: str) -> None:
    """At every point of the edge: tangent, orthogonal to the edge, and the twin sees the same but for the sign."""
    domain, geometry = checks.domain(name), checks.domain(name).geometry
    normal = edge_normals(domain)
    ends = domain.corners, np.roll(domain.corners, -1, axis=1)
    np.testing.assert_allclose(geometry.norm(domain.corners, normal).ravel(), domain.edge_lengths, rtol=1e-11)
    for t in (0.0, 0.3):
        x = geometry.geodesic(*ends, t)
        k = np.array([1, geometry.curvature, geometry.curvature])
        np.testing.assert_allclose((x * normal * k).sum(axis=-1), 0, atol=1e-11)
        np.testing.assert_allclose(geometry.inner(x, geometry.log(x, ends[1]), normal), 0, atol=1e-10)
    flat = normal.reshape(-1, 3)
    other = geometry.act(domain.gluing, flat[domain.twin])
    np.testing.assert_allclose(other, -flat, atol=1e-10)


@each_domain
def test_incentres_are_equally_far_from_the_edges(name: str) -> None:
    domain = checks.domain(name)
    split, k = PowellSabinSplit(domain), domain.geometry.curvature
    covector = np.cross(domain.corners, np.roll(domain.corners, -1, axis=1))
    unit = covector / np.sqrt((covector**2 * [k, 1, 1]).sum(axis=-1, keepdims=True))
    height = np.einsum("fci,fi->fc", unit, split.incentre)
    np.testing.assert_allclose(height, height[:, :1].repeat(3, axis=1), rtol=1e-10)
    share = split.coordinates(split.incentre)
    assert share.min() > 0
    np.testing.assert_allclose(share.sum(axis=1), 1, atol=1e-12)


def check_split(domain: GeodesicTriangulation) -> None:
    """R lies inside of its edge, on the plane of both incentres, at one place for both triangles."""
    split, geometry = PowellSabinSplit(domain), domain.geometry
    assert split.share.min() > 0
    r, z = split.edge_point.reshape(-1, 3), np.repeat(split.incentre, 3, axis=0)
    beyond = geometry.act(domain.gluing, z[domain.twin])
    np.testing.assert_allclose(np.linalg.det(np.stack([r, z, beyond], axis=1)), 0, atol=1e-11)
    there = geometry.act(domain.gluing, r[domain.twin])
    np.testing.assert_allclose(np.cross(there, r), 0, atol=1e-10)
    area = np.abs(np.linalg.det(split.micro_triangles)).sum(axis=1)
    np.testing.assert_allclose(area, np.abs(np.linalg.det(domain.corners)), rtol=1e-11)
    assert (np.linalg.det(split.micro_triangles) * np.tile([1, -1], 3) > 0).all()


@each_domain
def test_splits_meet_on_the_edges(name: str) -> None:
    check_split(checks.domain(name))


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.3))
def test_splits_of_shaken_lattices(seed: int, amount: float) -> None:
    check_split(shaken_torus(4, amount, seed))


def shaken_torus(n: int, amount: float, seed: int) -> GeodesicTriangulation:
    """A grid of n^2 squares cut by diagonals, its vertices moved by up to a share of the spacing."""
    orbifold = surfaces.torus()
    offset = np.random.default_rng(seed).uniform(-amount, amount, size=(n, n, 2))
    i, j = (a.ravel() for a in np.indices((n, n)))

    def vertex(i: np.ndarray, j: np.ndarray) -> np.ndarray:
        place = (np.stack([i, j], axis=-1) + offset[i % n, j % n]) / n - 0.5
        return np.concatenate([np.ones((len(i), 1)), place], axis=1)

    a, b, c, d = vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)
    corners = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return checks.glued(orbifold, corners, orbifold.lifts(0, 1.5)[1])
