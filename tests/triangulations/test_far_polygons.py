"""One polygon of many handles: points far from the origin of its patch lose no more digits than they must."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from orbiframe.components.registry import Registry
from orbiframe.delaunay.polygon_fan import polygon_triangulation
from orbiframe.orbifolds.atlas import Points
from orbiframe.triangulations.point_location import Locator
from orbiframe.words.word import standard_word

REGISTRY = Registry.discover()
SURFACES = [(True, 2), (True, 3), (True, 4), (True, 8), (False, 3), (False, 20)]


@cache
def polygon(orientable: bool, genus: int):
    """The regular polygon of the paper, in 16 triangles for each side."""
    word = standard_word(2 - 2 * genus if orientable else 2 - genus, orientable)
    group = REGISTRY.load("group", "regular-polygon")(REGISTRY.geometry(-1), word)
    domain = polygon_triangulation(group).refined().refined()
    return group, domain, REGISTRY.load("basis", "ps2")(domain.orbifold, domain)


def points_in(domain, count: int = 3000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Triangles, points in their frames, and the same points in the frame of the polygon."""
    rng = np.random.default_rng(0)
    face = rng.integers(domain.face_count, size=count)
    near = np.einsum("nc,nci->ni", rng.dirichlet([1, 1, 1], size=count), domain.corners[face])
    near = domain.geometry.project(near)
    return face, near, domain.geometry.settle(domain.geometry.act(domain.placement[face], near))


@pytest.mark.parametrize(("orientable", "genus"), SURFACES)
def test_functions_sum_to_one_at_every_genus(orientable, genus):
    """They missed it by 2e-11, 2e-8, 1e-4 and 3e-2 at genus 2, 3, 4 and 8, silently."""
    _, domain, basis = polygon(orientable, genus)
    x = points_in(domain)[2]
    points = Points(np.zeros(len(x), dtype=np.intp), x)
    assert np.abs(basis.values(points, np.ones((basis.size, 1))) - 1).max() < 1e-12
    values, *slopes = basis.jet_matrices(points, 1)
    assert np.abs(values.sum(axis=1) - 1).max() < 1e-12
    assert max(np.abs(slope.sum(axis=1)).max() for slope in slopes) < 1e-11


@pytest.mark.parametrize(("orientable", "genus"), SURFACES)
def test_frames_are_orthonormal_and_points_are_where_they_were(orientable, genus):
    """Points are found again in their triangles to the digits that numbers of size e^D leave in two products."""
    _, domain, _ = polygon(orientable, genus)
    geometry = domain.geometry
    face, near, x = points_in(domain)
    found = Locator(domain).locate(Points(np.zeros(len(x), dtype=np.intp), x), frames=True)
    frames = found.columns
    form = np.diag([1.0, -1.0, -1.0])
    np.testing.assert_allclose(np.swapaxes(frames, 1, 2) @ form @ frames, np.tile(form, (len(x), 1, 1)), atol=1e-13)
    same = found.face == face[found.order]
    assert same.mean() > 0.99
    away = geometry.distance(frames[same, :, 0], near[found.order][same])
    digit = np.finfo(float).eps * np.exp(2 * domain.orbifold.atlas.radius[0])
    assert np.quantile(away, 0.9) < 10 * digit
    assert away.max() < 2000 * digit


@pytest.mark.parametrize(("orientable", "genus"), SURFACES)
def test_points_moved_by_generators_are_found(orientable, genus):
    """At 20 crosscaps such a point was said to lie in no triangle."""
    _, domain, basis = polygon(orientable, genus)
    atlas, geometry = domain.orbifold.atlas, domain.geometry
    x = points_in(domain, 300)[2]
    step = 1 + np.arange(len(x)) % (len(atlas.tail) - 1)
    moved = geometry.settle(geometry.act(atlas.isometry[step], x))
    values = basis.values(Points(np.zeros(len(x), dtype=np.intp), moved), np.ones((basis.size, 1)))
    assert np.abs(values - 1).max() < 1e-12
