"""Voronoi cells, random sites, Lloyd's steps and domains of splines."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from lifted_sites import group_of, random_sites
from reference_surfaces import ALL, triangulated

from orbiframe.delaunay.point_walk import find
from orbiframe.delaunay.polygon_fan import polygon_triangulation
from orbiframe.delaunay.site_triangulation import delaunay
from orbiframe.delaunay.sites import lloyd, poisson_disc, uniform_points
from orbiframe.delaunay.spline_domain import spline_domain
from orbiframe.delaunay.voronoi import circumcentres, kites, region_areas
from orbiframe.errors import FitError, MapError
from orbiframe.orbifolds.atlas import Points
from orbiframe.planes.quadrature import triangle_points

WORDS = ("aA", "aa", "abAB", "abaB", "abcdABCD", "aabbcc")


def scattered(word, count=150, seed=0):
    group = group_of(word)
    return delaunay(polygon_triangulation(group), random_sites(group, count, seed)).triangulation


def smallest_angle(t):
    x, geometry = t.corners, t.geometry
    return np.degrees(min(geometry.angle(*(np.roll(x, -c, axis=1)[:, i] for i in range(3))).min() for c in range(3)))


def energy(t):
    """The integral of the versine of the distance from the nearest site."""
    x, area = triangle_points(t.geometry, kites(t).reshape(-1, 3, 3), 4)
    sign = np.sign(t.geometry.triangle_area(*np.moveaxis(kites(t).reshape(-1, 3, 3), 1, 0)))
    return (t.geometry.versine(kites(t)[..., :1, :].reshape(-1, 1, 3), x) * area * sign[:, None]).sum()


@pytest.mark.parametrize("word", WORDS)
def test_a_circumcentre_is_as_far_from_every_corner(word):
    t = scattered(word)
    distance = t.geometry.distance(circumcentres(t)[:, None], t.corners)
    np.testing.assert_allclose(distance, distance[:, :1] * np.ones(3), rtol=1e-8)


@pytest.mark.parametrize("word", WORDS)
def test_the_cells_fill_the_surface(word):
    t = scattered(word)
    assert region_areas(t).sum() == pytest.approx(t.orbifold.area, rel=1e-9)
    assert (region_areas(t) > 0).all()


def test_the_cells_of_middle_and_corner_of_the_octagon_are_equal():
    """The tiling {8, 8} is its own dual: the two cells are congruent, of area 2 pi."""
    group = group_of("abcdABCD")
    x = np.stack([group.geometry.origin, group.polygon.vertices[0]])
    t = delaunay(polygon_triangulation(group), Points(np.zeros(2, dtype=np.intp), x)).triangulation
    np.testing.assert_allclose(region_areas(t), 2 * np.pi, rtol=1e-9)


@pytest.mark.parametrize("word", WORDS)
def test_uniform_points_fall_into_triangles_by_area(word):
    t, start = scattered(word, 12, 3), polygon_triangulation(group_of(word))
    points = uniform_points(start, 6000, seed=4)
    count = np.bincount(find(t, points).face, minlength=t.face_count)
    expected = 6000 * t.areas / t.areas.sum()
    assert (np.abs(count - expected) < 5 * np.sqrt(expected) + 1).all()
    again = uniform_points(start, 6000, seed=4)
    np.testing.assert_array_equal(points.x, again.x)


@pytest.mark.parametrize("word", WORDS)
def test_poisson_disc_sites_are_apart_and_leave_no_room(word):
    start = polygon_triangulation(group_of(word))
    radius = 0.12 * np.sqrt(start.orbifold.area)
    t = poisson_disc(start, radius, seed=2)
    assert t.edge_lengths.min() >= radius
    reach = t.geometry.distance(circumcentres(t), t.corners[:, 0])
    assert reach.max() <= radius * (1 + 1e-6)
    with pytest.raises(MapError, match="positive radius"):
        poisson_disc(start, 0.0)


@pytest.mark.parametrize("word", WORDS)
def test_every_step_of_lloyd_lowers_the_energy(word):
    t = scattered(word)
    energies = [energy(lloyd(t, steps)) for steps in range(5)]
    assert (np.diff(energies) < 0).all()
    late = lloyd(t, 30)
    assert smallest_angle(late) > 30 > smallest_angle(t)
    assert late.vertex_count == t.vertex_count
    assert late.area_defect < 1e-9


def test_sites_follow_the_density():
    """Weights of 16 to 1 on the torus: spacing goes as the fourth root, so cells as the square root, 1 to 4."""
    t = scattered("abAB", 400, 1)
    height = t.geometry.act(t.placement[t.vertex_corner // 3], t.corners.reshape(-1, 3)[t.vertex_corner])[:, 2]
    weight = np.where(np.sin(2 * np.pi * height) > 0, 16.0, 1.0)
    areas = np.sort(region_areas(lloyd(t, 20, weight)))
    assert np.median(areas[-100:]) > 1.5 * np.median(areas[:100])


@pytest.mark.parametrize("name", ALL)
def test_the_domain_of_splines_has_as_many_vertices_as_wanted(name):
    mapped = triangulated(name, 4)
    for count in (8, 40):
        t = spline_domain(mapped, count)
        assert t.vertex_count == count
        assert t.euler_characteristic == mapped.orbifold.euler_characteristic
        assert t.area_defect < 1e-8
        assert (t.areas > 0).all()
        assert t.gluing_defect < 1e-8
    assert smallest_angle(t) > 15
    np.testing.assert_array_equal(t.corners, spline_domain(mapped, count).corners)


@pytest.mark.parametrize(("name", "times"), [("sphere", 4), ("torus", 3), ("octagon", 3)])
def test_rounding_does_not_choose_the_triangles_of_a_domain(name, times):
    """Of a symmetric mesh, where many sites lie on one circle: noise as large as that of another processor."""
    mapped, rng = triangulated(name, times), np.random.default_rng(0)
    wanted = spline_domain(mapped, 15)
    for _ in range(5):
        noisy = mapped.orbifold.geometry.settle(mapped.points * (1 + 1e-15 * rng.normal(size=mapped.points.shape)))
        found = spline_domain(replace(mapped, points=noisy), 15)
        np.testing.assert_array_equal(found.vertex, wanted.vertex)
        np.testing.assert_allclose(found.edge_lengths, wanted.edge_lengths, atol=1e-10)


def test_a_domain_has_no_more_vertices_than_the_mesh():
    mapped = triangulated("torus", 2)
    with pytest.raises(FitError, match="refine the mesh"):
        spline_domain(mapped, 10_000)
