"""Self-intersecting triangles against brute force over all pairs, and of shapes that are known."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from fitted import round_sphere
from small_meshes import double_pyramid

from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.self_intersections import intersections, self_intersecting


def soup(count: int, size: float, seed: int) -> Polyhedron:
    rng = np.random.default_rng(seed)
    centres = rng.uniform(size=(count, 1, 3))
    vertices = centres + rng.normal(scale=size, size=(count, 3, 3)) * rng.uniform(0.1, 3, size=(count, 1, 1))
    return Polyhedron.from_faces(vertices.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))


def pierces(p: np.ndarray, q: np.ndarray, triangle: np.ndarray) -> bool:
    """Whether a segment passes through a triangle, by solving for the point where they meet."""
    a, b, c = triangle
    try:
        t, u, v = np.linalg.solve(np.stack([q - p, a - b, a - c], axis=1), a - p)
    except np.linalg.LinAlgError:
        return False
    return bool(0 < t < 1 and u > 0 and v > 0 and u + v < 1)


@pytest.mark.parametrize("seed", range(4))
def test_all_pairs(seed: int) -> None:
    mesh = soup(60, 0.1, seed)
    corners, found = mesh.vertices[mesh.triangles], set()
    for f, g in combinations(range(60), 2):
        for x, y in ((corners[f], corners[g]), (corners[g], corners[f])):
            if any(pierces(x[i], x[(i + 1) % 3], y) for i in range(3)):
                found |= {f, g}
    assert 5 < len(found) < 60
    assert set(self_intersecting(mesh)) == found


def test_a_sphere_has_none_and_a_pushed_vertex_makes_some() -> None:
    sphere = round_sphere()
    assert len(self_intersecting(sphere)) == 0
    pushed = sphere.vertices.copy()
    pushed[0] = [-2.6, 0.03, 0.01]
    assert len(self_intersecting(sphere.with_vertices(pushed))) > 4


def test_at_a_tip_of_thousands_of_needles_few_pairs_are_tried() -> None:
    """All boxes of such triangles meet at the tip; without a look at common vertices there were n^2 pairs."""
    for n in (1000, 30_000):
        found, tried = intersections(double_pyramid(n))
        assert len(found) == 0
        assert tried < 200 * n


def test_what_passes_through_a_fan_is_found() -> None:
    """A needle through both cones, at a place between two of its spokes, meets one triangle of each."""
    fan = double_pyramid(1000)
    turn = 0.5 * 2 * np.pi / 1000
    x, y = 0.5 * np.cos(turn), 0.5 * np.sin(turn)
    needle = np.array([[x, y, -2.0], [x, y, 2.0], [3.0, y, 2.0]])
    corners = np.concatenate([fan.vertices[fan.triangles], needle[None]]).reshape(-1, 3)
    vertices, number = np.unique(corners, axis=0, return_inverse=True)
    assert list(self_intersecting(Polyhedron.from_faces(vertices, number.reshape(-1, 3)))) == [0, 1000, 2000]
