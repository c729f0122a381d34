"""Flips of edges in space, against brute force and against the convex hull of points on a sphere."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from orbiframe_remeshing.edges import edges_of
from orbiframe_remeshing.flips import flipped_for_angles, flipped_for_valences
from orbiframe_remeshing.surface_mesh import corner_angles, least_angles
from scipy.spatial import ConvexHull

from orbiframe import FitError


def on_a_sphere(seed: int, count: int = 60) -> tuple[np.ndarray, np.ndarray]:
    """Random points, and the triangles of their convex hull, seen from outside."""
    points = np.random.default_rng(seed).normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return points, outward(points, ConvexHull(points).simplices)


def outward(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The triangles of a convex body about the origin, seen from outside."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    inward = np.einsum("fi,fi->f", np.cross(b - a, c - a), a + b + c) < 0
    return np.where(inward[:, None], triangles[:, [0, 2, 1]], triangles).astype(np.intp)


def quads_at_edges(triangles: np.ndarray) -> dict[tuple[int, int], list[int]]:
    """The apexes at every edge, by a dictionary."""
    found: dict[tuple[int, int], list[int]] = {}
    for corners in triangles.tolist():
        for k in range(3):
            a, b, c = corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]
            found.setdefault((min(a, b), max(a, b)), []).append(c)
    return found


def least(points: np.ndarray, *triangles: tuple[int, int, int]) -> float:
    """The least angle of some triangles, in degrees, by scalar products."""
    found = []
    for corners in triangles:
        for k in range(3):
            x, y, z = (points[corners[(k + i) % 3]] for i in range(3))
            found.append(math.acos((y - x) @ (z - x) / np.linalg.norm(y - x) / np.linalg.norm(z - x)))
    return math.degrees(min(found))


def normal(points: np.ndarray, a: int, b: int, c: int) -> np.ndarray:
    return np.cross(points[b] - points[a], points[c] - points[a])


@pytest.mark.long
@given(st.integers(0, 10_000))
def test_no_flip_is_left_that_makes_a_least_angle_larger(seed):
    points, hull = on_a_sphere(seed)
    shaken = points * np.random.default_rng(seed).uniform(0.9, 1.1, size=(len(points), 1))
    triangles = flipped_for_angles(shaken, hull)
    edges = quads_at_edges(triangles)
    assert len(edges) == len(hull) * 3 // 2
    assert all(len(apexes) == 2 for apexes in edges.values())
    for a, b, c in triangles.tolist():
        for x, y, z in ((a, b, c), (b, c, a), (c, a, b)):
            (w,) = (v for v in edges[min(x, y), max(x, y)] if v != z)
            if (min(z, w), max(z, w)) in edges:
                continue
            outward = normal(shaken, x, y, z) + normal(shaken, x, w, y)
            if min(normal(shaken, x, w, z) @ outward, normal(shaken, w, y, z) @ outward) > 0:
                assert least(shaken, (x, w, z), (w, y, z)) <= least(shaken, (x, y, z), (x, w, y)) + 1e-6


@given(st.integers(0, 10_000))
def test_the_sorted_least_angles_grow(seed):
    points, hull = on_a_sphere(seed)
    before, after = (np.sort(least_angles(points, t)) for t in (hull, flipped_for_angles(points, hull)))
    changed = np.flatnonzero(np.abs(before - after) > 1e-9)
    assert not len(changed) or after[changed[0]] > before[changed[0]]


def test_scrambled_triangles_of_even_points_become_their_convex_hull_again():
    """Points of a spiral: their hull is a Delaunay triangulation of the sphere, all of whose angles are large."""
    k = np.arange(400) + 0.5
    height, turn = 1 - 2 * k / 400, np.pi * (1 + np.sqrt(5)) * k
    ring = np.sqrt(1 - height**2)
    points = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
    hull = outward(points, ConvexHull(points).simplices)
    scrambled = flipped_for_angles(points @ np.diag([1, 1, 12.0]), hull)
    wanted, found, moved = (set(quads_at_edges(t)) for t in (hull, flipped_for_angles(points, scrambled), scrambled))
    assert len(wanted - moved) > 200
    assert len(wanted - found) <= 12  # a few quadrilaterals have their corners nearly on one circle


def test_valences_come_nearer_to_six():
    points, hull = on_a_sphere(3, 300)
    excess = [np.bincount(t.ravel()) - 6 for t in (hull, flipped_for_valences(points, hull))]
    assert excess[0].sum() == excess[1].sum() == -12
    assert (excess[1] ** 2).sum() < 0.85 * (excess[0] ** 2).sum()


def test_angles_of_known_triangles():
    places = np.array([[0.0, 0, 0], [3, 0, 0], [3, 4, 0], [0, 0, 1], [1, 0, 1], [0.5, np.sqrt(0.75), 1]])
    found = corner_angles(places, np.array([[0, 1, 2], [3, 4, 5]]))
    assert found == pytest.approx(
        np.array([[math.degrees(math.atan2(4, 3)), 90, math.degrees(math.atan2(3, 4))], [60, 60, 60]])
    )


def test_edges_with_the_same_ends_are_refused():
    with pytest.raises(FitError, match="3 vertices are too few"):
        edges_of(np.array([[0, 1, 2], [0, 1, 2], [0, 2, 1], [0, 2, 1]]), 3)
