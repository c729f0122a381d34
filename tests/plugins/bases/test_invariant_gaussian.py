"""Functions on orbifolds with singular points: invariance, mirrors, cone points and derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from orbiframe_bases.invariant_gaussian import InvariantGaussian
from reference_geometries import GEOMETRIES

from orbiframe import GeometryError, Points, UsageError
from orbiframe.groups import orbifold_group, spread_over
from orbiframe.words import ConwaySymbol

SYMBOLS = ["532", "*532", "3*2", "4x", "*", "4*2", "22x", "*632", "2222", "*x", "*237", "237", "2*23", "*2*"]


def group_of(text):
    signature = ConwaySymbol.parse(text)
    return orbifold_group({g.curvature: g for g in GEOMETRIES}[signature.curvature], signature)


def cell_points(group, count, seed=3):
    return spread_over(group, count, seed).points


def jets(basis, x, order=1):
    points = Points(np.zeros(len(x), dtype=np.intp), x)
    return np.stack([matrix.toarray() for matrix in basis.jet_matrices(points, order)])


@pytest.mark.parametrize("text", SYMBOLS)
def test_values_are_invariant_and_add_up_to_one(text):
    group = group_of(text)
    basis, x = InvariantGaussian(group, size=12), cell_points(group, 15)
    here = jets(basis, x, 0)[0]
    np.testing.assert_allclose(here.sum(axis=1), 1, rtol=1e-13)
    for g in group.atlas().isometry[1:][:10]:
        np.testing.assert_allclose(jets(basis, group.geometry.act(g, x), 0)[0], here, atol=1e-12)


@pytest.mark.parametrize("text", ["*237", "*632", "4*2", "2*23", "*x"])
def test_the_derivative_across_a_mirror_is_zero(text):
    group = group_of(text)
    polygon, basis = group.polygon, InvariantGaussian(group, size=10)
    for side in polygon.word.mirrors:
        flag = polygon.side_flags[side]
        frame = group.geometry.frame(flag[:, 0])
        across = [float(group.geometry.inner(flag[:, 0], frame[:, k], flag[:, 2])) for k in (0, 1)]
        _, d1, d2 = jets(basis, flag[None, :, 0])[:, 0]
        np.testing.assert_allclose(across[0] * d1 + across[1] * d2, 0, atol=1e-11)
        assert np.hypot(d1, d2).max() > 1e-3, "the derivative along the mirror is not zero"


@pytest.mark.parametrize("text", ["237", "2222", "632", "22x", "4*2", "*237"])
def test_the_gradient_is_zero_where_a_rotation_fixes_the_point(text):
    polygon = group_of(text).polygon
    basis = InvariantGaussian(group_of(text), size=10)
    fixed = [c.corners[0] for c, n in zip(polygon.word.cycles, polygon.orders, strict=True) if n > 1]
    _, d1, d2 = jets(basis, polygon.vertices[fixed])
    np.testing.assert_allclose([d1, d2], 0, atol=1e-11)


def test_at_a_cone_point_of_order_3_the_hessian_is_a_multiple_of_the_metric():
    polygon = group_of("333").polygon
    basis = InvariantGaussian(group_of("333"), size=10)
    fixed = [c.corners[0] for c, n in zip(polygon.word.cycles, polygon.orders, strict=True) if n == 3]
    _, _, _, d11, d12, d22 = jets(basis, polygon.vertices[fixed], 2)
    np.testing.assert_allclose(d12, 0, atol=1e-10)
    np.testing.assert_allclose(d11, d22, atol=1e-10)


@pytest.mark.parametrize("text", ["532", "4*2", "237"])
def test_first_derivatives_are_those_along_geodesics(text):
    group, h = group_of(text), 1e-5
    geometry, basis = group.geometry, InvariantGaussian(group, size=8)
    x = cell_points(group, 6)
    frame, found = geometry.frame(x), jets(basis, x)
    for axis in (0, 1):
        ahead, behind = (jets(basis, geometry.exp(x, s * h * frame[..., axis]), 0)[0] for s in (1, -1))
        np.testing.assert_allclose((ahead - behind) / (2 * h), found[1 + axis], atol=1e-6)


def test_sites_keep_apart_from_the_images_of_one_another():
    group = group_of("*237")
    sites = spread_over(group, 20)
    tiles = group.tiles(1.0)
    images = group.geometry.act(tiles[:, None], sites.points).reshape(-1, 3)
    gaps = group.geometry.distance(sites.points[:, None], images)
    owner = np.tile(np.arange(20), len(tiles))
    others = gaps[owner != np.arange(20)[:, None]]
    assert others.min() > 0.9 * sites.covering
    assert np.pi * sites.covering**2 * 20 > group.area, "discs of the covering radius cover X/H"


def test_options_out_of_range_are_refused():
    with pytest.raises(UsageError, match="width"):
        InvariantGaussian(group_of("*237"), width=0)
    with pytest.raises(GeometryError, match="at least one"):
        spread_over(group_of("*237"), 0)
