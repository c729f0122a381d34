"""Delaunay triangulations of X/H against scipy on many lifts, down to one vertex, for every group."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from lifted_sites import WORDS, delaunay_areas, group_of, random_sites

from orbiframe.delaunay.lawson_flips import wants_flip
from orbiframe.delaunay.point_walk import find
from orbiframe.delaunay.polygon_fan import polygon_triangulation
from orbiframe.delaunay.site_triangulation import delaunay, delaunay_of_vertices
from orbiframe.delaunay.sites import vertex_points
from orbiframe.delaunay.triangle_arrays import arrays_of, flip
from orbiframe.delaunay.voronoi import circumcentres, circumradii
from orbiframe.errors import GeometryError, MapError
from orbiframe.orbifolds.atlas import Points
from orbiframe.words.word import Word

FLAT_OR_HYPERBOLIC = [word for word in WORDS if Word.parse(word).euler_characteristic <= 0]


def require_sound(triangulation, tolerance=1e-8):
    """Euler's number, the area, positive triangles, and gluings that fit at edges and round vertices."""
    assert triangulation.euler_characteristic == triangulation.orbifold.euler_characteristic
    assert triangulation.area_defect < tolerance
    assert (triangulation.areas > 0).all()
    assert triangulation.gluing_defect < tolerance
    assert triangulation.vertex_defect < 1e2 * tolerance
    assert triangulation.geometry.isometry_defect(triangulation.placement).max() < tolerance


def same_places(group, x, y):
    """How far points of X/H are from one another, seen in the cell."""
    return group.geometry.distance(group.reduce(x)[0], group.reduce(y)[0]).max()


@pytest.mark.parametrize("word", WORDS)
@settings(max_examples=5, deadline=None)
@given(count=st.integers(1, 60), seed=st.integers(0, 10**6))
def test_the_triangles_are_those_of_many_lifts(word, count, seed):
    # Few sites on flat surfaces lie on rectangles and trapezoids, where the choice is free.
    group = group_of(word)
    sites = random_sites(group, count if group.geometry.curvature < 0 else 12 + count, seed)
    found = delaunay(polygon_triangulation(group), sites)
    require_sound(found.triangulation)
    expected = delaunay_areas(group, sites)
    assert len(expected) == found.triangulation.face_count
    np.testing.assert_allclose(np.sort(found.triangulation.areas), expected, atol=1e-8)


@pytest.mark.parametrize("word", ["aA", "aa", "abAB", "abaB", "abcdABCD", "aabbcc"])
def test_a_thousand_sites_are_where_they_were_put(word):
    group = group_of(word)
    sites = random_sites(group, 1000, 5)
    found = delaunay(polygon_triangulation(group), sites)
    require_sound(found.triangulation)
    assert sorted(found.vertex) == list(range(1000))
    assert same_places(group, vertex_points(found.triangulation).x[found.vertex], sites.x) < 1e-9
    np.testing.assert_allclose(np.sort(found.triangulation.areas), delaunay_areas(group, sites), atol=1e-9)


@pytest.mark.parametrize(
    ("word", "counts"), [("abAB", (1, 3, 2)), ("abaB", (1, 3, 2)), ("abcdABCD", (1, 9, 6)), ("aabbcc", (1, 6, 4))]
)
def test_one_vertex_is_enough(word, counts):
    group = group_of(word)
    t = delaunay(polygon_triangulation(group), random_sites(group, 1, 3)).triangulation
    assert (t.vertex_count, t.edge_count, t.face_count) == counts
    require_sound(t)


@pytest.mark.parametrize("word", FLAT_OR_HYPERBOLIC)
def test_sites_that_the_group_moves_give_the_same_triangles(word):
    group, rng = group_of(word), np.random.default_rng(1)
    sites = random_sites(group, 40, 2)
    pairings = group.polygon.pairings[rng.integers(len(group.word), size=40)]
    moved = Points(sites.patch, group.geometry.act(pairings, sites.x))
    start = polygon_triangulation(group)
    one, other = delaunay(start, sites), delaunay(start, moved)
    np.testing.assert_allclose(np.sort(one.triangulation.areas), np.sort(other.triangulation.areas), atol=1e-8)


def test_ties_are_broken_once_for_every_orbit():
    """The middle and the corner of the Bolza octagon: eight lifts of the corner lie on every circle."""
    group = group_of("abcdABCD")
    x = np.stack([group.geometry.origin, group.polygon.vertices[0]])
    t = delaunay(polygon_triangulation(group), Points(np.zeros(2, dtype=np.intp), x)).triangulation
    require_sound(t)
    assert (t.vertex_count, t.face_count) == (2, 8)
    np.testing.assert_allclose(circumradii(t), circumradii(t)[0], rtol=1e-9)


@pytest.mark.parametrize("side", [2, 3, 8])
def test_a_square_grid_on_the_torus(side):
    group = group_of("abAB")
    i, j = np.divmod(np.arange(side**2), side)
    x = np.stack([np.ones(side**2), i / side - 0.4, j / side - 0.4], axis=1)
    t = delaunay(polygon_triangulation(group), Points(np.zeros(side**2, dtype=np.intp), x)).triangulation
    require_sound(t)
    np.testing.assert_allclose(t.areas, 0.5 / side**2, rtol=1e-9)


@pytest.mark.parametrize("word", WORDS)
def test_no_lift_of_a_site_lies_within_a_circle(word):
    group = group_of(word)
    sites = random_sites(group, 80, 9)
    t = delaunay(polygon_triangulation(group), sites).triangulation
    placed = group.geometry.act(t.placement, circumcentres(t))
    centre = group.reduce(placed)[0]
    reach = np.pi if group.geometry.curvature > 0 else group.polygon.circumradius + circumradii(t).max()
    lifts = (group.tiles(reach)[:, None] @ sites.x[None, :, :, None])[..., 0].reshape(-1, 3)
    nearest = np.array([group.geometry.distance(c, lifts).min() for c in centre])
    np.testing.assert_allclose(nearest, circumradii(t), rtol=1e-7)


def test_an_edge_that_is_flipped_is_noticed():
    group = group_of("abABcdCD")
    sites = random_sites(group, 30, 4)
    t = delaunay(polygon_triangulation(group), sites).triangulation
    cells = arrays_of(t)
    e = next(e for e in range(len(t.twin)) if cells.twin[e] // 3 != e // 3)
    flip(cells, e)
    turned = replace(t, corners=cells.corners, twin=cells.twin, same=cells.same, gluing=cells.gluing)
    assert turned.gluing_defect < 1e-9
    assert turned.euler_characteristic == -2
    assert wants_flip(cells, 3 * (e // 3)) or (turned.areas <= 0).any()
    assert np.abs(np.sort(turned.areas) - delaunay_areas(group, sites)).max() > 1e-4


@pytest.mark.parametrize("word", ["aa", "abaB", "abABcdCD", "aabbccdd"])
def test_any_start_leads_to_the_same_triangles(word):
    group = group_of(word)
    sites = random_sites(group, 50, 6)
    start = polygon_triangulation(group)
    other = delaunay(start, random_sites(group, 200, 7)).triangulation
    one, two = (delaunay(t, sites).triangulation for t in (start, other))
    np.testing.assert_allclose(np.sort(one.areas), np.sort(two.areas), atol=1e-8)


def test_some_vertices_are_kept():
    group = group_of("abcdABCD")
    sites = random_sites(group, 300, 8)
    dense = delaunay(polygon_triangulation(group), sites)
    few = delaunay_of_vertices(dense.triangulation, dense.vertex[:20])
    require_sound(few.triangulation)
    chosen = Points(sites.patch[:20], sites.x[:20])
    np.testing.assert_allclose(np.sort(few.triangulation.areas), delaunay_areas(group, chosen), atol=1e-8)
    assert same_places(group, vertex_points(few.triangulation).x[few.vertex], chosen.x) < 1e-8


@pytest.mark.parametrize("word", WORDS)
def test_located_points_lie_in_their_triangles(word):
    group = group_of(word)
    t = delaunay(polygon_triangulation(group), random_sites(group, 60, 1)).triangulation
    points = random_sites(group, 500, 2)
    face, x = find(t, points)
    share = np.linalg.solve(np.swapaxes(t.corners[face], 1, 2), x[..., None])[..., 0]
    assert share.min() > -1e-9
    assert same_places(group, group.geometry.act(t.placement[face], x), points.x) < 1e-8


@pytest.mark.parametrize("genus", [2, 5, 10])
def test_the_fan_of_a_large_polygon_keeps_its_digits(genus):
    letters = "abcdefghijklmnopqrst"[: 2 * genus]
    t = polygon_triangulation(group_of(letters + letters.upper()))
    assert (t.vertex_count, t.face_count) == (2, 4 * genus)
    assert t.area_defect < 1e-12
    assert t.gluing_defect < 1e-9


def test_what_cannot_be_is_said():
    start = polygon_triangulation(group_of("abcdABCD"))
    one = random_sites(group_of("abcdABCD"), 1, 0)
    with pytest.raises(MapError, match="no sites"):
        delaunay(start, Points(one.patch[:0], one.x[:0]))
    with pytest.raises(MapError, match="sites 0 and 1 are at one place"):
        delaunay(start, Points(np.zeros(2, dtype=np.intp), np.repeat(one.x, 2, axis=0)))
    with pytest.raises(MapError, match="no half of the sphere"):
        delaunay(polygon_triangulation(group_of("aA")), random_sites(group_of("aA"), 3, 0))
    with pytest.raises(GeometryError, match="not found in any triangle"):
        delaunay(start, Points(one.patch, np.full((1, 3), np.inf)))
