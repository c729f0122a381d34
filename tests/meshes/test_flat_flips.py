"""Flat flips: Delaunay in the plane by Qhull, the same surface, points and edges found again, needles gone."""

from __future__ import annotations

import hard_surfaces as hard
import numpy as np
import pytest
from fitted import REGISTRY, config
from hypothesis import given, settings, strategies as st
from scipy.spatial import Delaunay

from orbiframe.fitting import pipeline
from orbiframe.meshes.bisection import bisected, edge_length_for
from orbiframe.meshes.edge_log import EdgeLog
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.flat_flips import flat_flips
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.surface_type import surface_type
from orbiframe.testing.polyhedra import reference_polyhedra
from orbiframe.triangulations.face_shapes import face_shapes

SEEDS = st.integers(0, 2**32 - 1)


def pyramid(points: np.ndarray, triangles: np.ndarray, rim: np.ndarray) -> Polyhedron:
    """A triangulated plane figure with its convex rim, counterclockwise, joined to a point far below."""
    apex = len(points)
    vertices = np.concatenate([np.insert(points, 2, 0.0, axis=1), [[0.3, 0.4, -5.0]]])
    sides = np.stack([np.roll(rim, -1), rim, np.full(len(rim), apex)], axis=1)
    return Polyhedron.from_faces(vertices, np.concatenate([triangles, sides]))


def swept(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A triangulation full of needles: points from left to right, each joined to all of the hull that it sees."""
    order = np.argsort(points[:, 0])
    triangles, upper, lower = [], [order[0]], [order[0]]

    def turns_left(a: int, b: int, c: int) -> bool:
        (ax, ay), (bx, by), (cx, cy) = points[[a, b, c]]
        return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0

    for new in order[1:]:
        while len(lower) > 1 and not turns_left(lower[-2], lower[-1], new):
            triangles.append((lower[-2], new, lower[-1]))
            lower.pop()
        while len(upper) > 1 and turns_left(upper[-2], upper[-1], new):
            triangles.append((upper[-2], upper[-1], new))
            upper.pop()
        lower.append(new)
        upper.append(new)
    return np.array(triangles), np.array(lower + upper[-2:0:-1])


@settings(max_examples=30, deadline=None)
@given(SEEDS, st.integers(5, 60))
def test_a_plane_figure_becomes_the_triangulation_of_qhull(seed: int, count: int) -> None:
    points = np.random.default_rng(seed).random((count, 2))
    triangles, rim = swept(points)
    flips = flat_flips(pyramid(points, triangles, rim))
    found = {tuple(sorted(map(int, t))) for t in flips.after.triangles[: len(triangles)]}
    assert found == {tuple(sorted(map(int, t))) for t in Delaunay(points).simplices}


def spoiled(seed: int) -> Polyhedron:
    """A plate of genus 2 with flat slivers, some without any height."""
    rng = np.random.default_rng(seed)
    return hard.with_slivers(hard.plate(1, 2, 2), 0.25, float(rng.choice([0.0, 1e-12, 1e-3])), 3, seed)


@settings(max_examples=20, deadline=None)
@given(SEEDS)
def test_points_stay_where_they_are(seed: int) -> None:
    mesh, rng = spoiled(seed), np.random.default_rng(seed)
    flips = flat_flips(mesh)
    assert len(flips.halfedge)
    face = rng.integers(mesh.face_count, size=2000)
    weights = rng.dirichlet([0.3, 0.3, 0.3], size=2000)
    weights[:200] = np.eye(3)[rng.integers(3, size=200)]
    before = np.einsum("nc,nci->ni", weights, mesh.vertices[mesh.triangles[face]])
    place, moved = flips.locate(face, weights)
    after = np.einsum("nc,nci->ni", moved, mesh.vertices[flips.after.triangles[place]])
    np.testing.assert_allclose(after, before, atol=1e-8)
    assert moved.min() >= 0
    np.testing.assert_allclose(moved.sum(axis=1), 1, atol=1e-8)
    np.testing.assert_array_equal(moved[:200].max(axis=1), 1)


@settings(max_examples=20, deadline=None)
@given(SEEDS)
def test_the_mesh_stays_a_mesh_of_the_same_surface(seed: int) -> None:
    mesh = spoiled(seed)
    after = flat_flips(mesh).after
    np.testing.assert_array_equal(after.twin[after.twin], np.arange(len(after.twin)))
    np.testing.assert_array_equal(after.tail, np.where(after.same, after.tail[after.twin], after.head[after.twin]))
    assert surface_type(after) == surface_type(mesh)
    areas = [np.cross(*np.diff(m.vertices[m.triangles], axis=1).swapaxes(0, 1)) for m in (mesh, after)]
    np.testing.assert_allclose(np.linalg.norm(areas[1], axis=1).sum(), np.linalg.norm(areas[0], axis=1).sum())
    # Every triangle of some size still lies in one of the planes of the plate.
    size = np.linalg.norm(areas[1], axis=1)
    assert (np.abs(areas[1]).max(axis=1) > (1 - 1e-6) * size)[size > 1e-6].all()


@settings(max_examples=20, deadline=None)
@given(SEEDS)
def test_products_along_old_edges_come_back(seed: int) -> None:
    """With any matrices at the vertices, G_i^-1 G_j is the product along every path from i to j."""
    mesh, rng = spoiled(seed), np.random.default_rng(seed)
    flips = flat_flips(mesh)
    frames = np.eye(3) + 0.3 * rng.normal(size=(len(mesh.vertices), 3, 3))
    steps = [np.linalg.inv(frames[m.tail]) @ frames[m.head] for m in (mesh, flips.after)]
    np.testing.assert_allclose(flips.carried_back(steps[1]), steps[0], atol=1e-8)


@pytest.mark.parametrize("name", sorted(reference_polyhedra()))
def test_meshes_without_needles_keep_their_edges(name: str) -> None:
    """Where corners lie on one circle, as those of a square, either diagonal would do."""
    mesh = triangulated(reference_polyhedra()[name])
    assert len(flat_flips(mesh).halfedge) == 0


def test_curved_parts_are_left_alone() -> None:
    mesh = hard.stretched(triangulated(reference_polyhedra()["torus"]), 20, 1, 1)
    bent = mesh.with_vertices(mesh.vertices + 1e-6 * np.random.default_rng(0).normal(size=mesh.vertices.shape))
    assert len(flat_flips(bent).halfedge) == 0


def test_bisection_of_flipped_needles_needs_no_more_vertices_than_are_aimed_at() -> None:
    mesh = hard.with_slivers(hard.plate(1, 2, 2), 0.3, 0.0, 3)
    flips = flat_flips(mesh)
    fine = bisected(mesh, edge_length_for(flips.after, 3000), True, flips)
    assert len(fine.polyhedron.vertices) < 9000
    points = np.random.default_rng(0).dirichlet([1, 1, 1], size=500)
    face = np.arange(500) % mesh.face_count
    place, weights = fine.locate(face, points)
    there = np.einsum("nc,nci->ni", weights, fine.polyhedron.vertices[fine.polyhedron.triangles[place]])
    here = np.einsum("nc,nci->ni", points, mesh.vertices[mesh.triangles[face]])
    np.testing.assert_allclose(there, here, atol=1e-8)


@pytest.mark.long
def test_a_part_with_needles_without_height_is_mapped_like_one_without() -> None:
    """Angles are kept as well as on the clean plate, and the polygons of the file are found again in X/H."""
    mesh = hard.with_slivers(hard.plate(1, 2, 2), 0.3, 0.0, 3)
    made = pipeline.fit(mesh, config(300), REGISTRY)
    assert made.report["map"]["angle_distortion"]["median"] < 1.1
    assert made.report["map"]["weights"] == "cotangent"
    assert made.report["map"]["not_positive"] == 0
    assert made.report["fit"]["rms"] < 5e-3
    surface = made.surface
    shapes = face_shapes(mesh, surface.refinement, surface.triangulation)
    assert shapes.area.sum() == pytest.approx(4 * np.pi, rel=1e-9)


def test_the_flips_are_those_of_the_log() -> None:
    mesh = spoiled(2)
    flips = flat_flips(mesh)
    again = EdgeLog(mesh, flips.halfedge, flips.crossing)
    for name in ("tail", "twin", "same"):
        np.testing.assert_array_equal(getattr(again.after, name), getattr(flips.after, name))


def test_flips_of_what_is_no_pair_of_triangles_are_unsound() -> None:
    """Two cones with a common loop: the sides 0 and 1, and 3 and 4, are glued within their own faces."""
    tail = np.array([0, 1, 0, 0, 2, 0])
    cones = Polyhedron(np.eye(3), np.array([0, 3, 6]), tail, np.array([1, 0, 5, 4, 3, 2]), np.zeros(6, dtype=np.bool_))
    half = np.full((1, 2), 0.5)
    assert not EdgeLog(cones, np.array([[0, 1]]), half).is_sound
    assert not EdgeLog(cones, np.array([[0, 5]]), half).is_sound
    assert EdgeLog(cones, np.array([[2, 5]]), half).is_sound
