"""Digits that thin triangles lose: closed forms for one short edge."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from reference_surfaces import triangulated

from orbiframe.triangulations.lost_digits import crowding_of


def with_short_edge(name: str, length: float):
    """A triangulation in which one vertex is moved to `length` from a neighbour, and the triangles at that edge."""
    made = triangulated(name, 2)
    mesh, geometry = made.polyhedron, made.orbifold.geometry
    place = np.linalg.norm(made.lifts[..., 1:], axis=-1)
    # Away from the origin: the corners of the triangles at the edge differ in their distance from it.
    h = int(np.argmax(np.where(made.transition == 0, np.ptp(place, axis=1)[mesh.face], -1)))
    tail, head = made.points[mesh.tail[h]], mesh.head[h]
    step = geometry.log(tail, made.points[head])
    points = made.points.copy()
    points[head] = geometry.exp(tail, step * length / geometry.distance(tail, made.points[head]))
    return replace(made, points=points), [mesh.face[h], mesh.face[mesh.twin[h]]]


@pytest.mark.parametrize("length", [1e-4, 1e-7])
@pytest.mark.parametrize("name", ["torus", "klein_bottle", "octagon"])
def test_digits_are_the_farthest_corner_over_the_shortest_edge(name, length):
    made, faces = with_short_edge(name, length)
    farthest = max(np.hypot(x, y) for face in faces for _, x, y in made.lifts[face])
    assert crowding_of(made).digits_lost == pytest.approx(np.log10(farthest / length), abs=1e-6)


def test_on_the_far_half_of_the_sphere_coordinates_are_as_large_as_1():
    made, faces = with_short_edge("sphere", 1e-5)
    corners = [corner for face in faces for corner in made.lifts[face]]
    farthest = max(1.0 if h < 0 else np.hypot(x, y) for h, x, y in corners)
    assert crowding_of(made).digits_lost == pytest.approx(np.log10(farthest / 1e-5), abs=1e-6)


def test_an_even_map_loses_nothing():
    even = crowding_of(triangulated("sphere", 1))
    assert even.digits_lost == pytest.approx(max(0, -np.log10(np.pi / 4)), abs=1e-9)
    areas = triangulated("sphere", 1).areas
    assert even.area_ratio == pytest.approx(areas.min() / areas.max())


@pytest.mark.parametrize("at_origin", [False, True])
def test_a_triangle_without_size_has_lost_all(at_origin):
    """Also at the origin, where the coordinates are as small as the triangle."""
    made = triangulated("torus", 2)
    points = made.points.copy()
    corners = made.polyhedron.tail[:3]
    points[corners] = made.orbifold.geometry.origin if at_origin else points[corners[0]]
    assert crowding_of(replace(made, points=points)).digits_lost == np.inf
