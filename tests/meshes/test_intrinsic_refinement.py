"""Intrinsic refinement: Delaunay by brute force, distances along a developed cone, points found again, few vertices."""

from __future__ import annotations

import hard_surfaces as hard
import numpy as np
import pytest
from fitted import REGISTRY, config
from hypothesis import given, settings, strategies as st

from orbiframe.fitting import pipeline
from orbiframe.fitting.config import Config
from orbiframe.fitting.mapping import Mapping
from orbiframe.fitting.stages import Stages
from orbiframe.functions.smooth_samples import vertex_samples
from orbiframe.meshes.bending import SHARP, bending
from orbiframe.meshes.bisection import bisected, even_edge_length
from orbiframe.meshes.edge_log import EdgeLog
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.flat_flips import flat_flips
from orbiframe.meshes.intrinsic_refinement import _may_be_halved, intrinsic_refinement
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.surface_type import surface_type
from orbiframe.testing.polyhedra import reference_polyhedra
from orbiframe.triangulations.face_shapes import face_shapes

SEEDS = st.integers(0, 2**32 - 1)
MESHES = {name: triangulated(mesh) for name, mesh in reference_polyhedra().items()}


def fan(count: int, height: float = 1.0) -> Polyhedron:
    """A double pyramid over a regular polygon of radius 1; the needles of its upper half come first."""
    turn = 2 * np.pi * np.arange(count) / count
    rim = np.stack([np.cos(turn), np.sin(turn), np.zeros(count)], axis=1)
    ring, after = np.arange(count), np.roll(np.arange(count), -1)
    upper = np.stack([ring, after, np.full(count, count)], axis=1)
    lower = np.stack([after, ring, np.full(count, count + 1)], axis=1)
    tips = [[0, 0, height], [0, 0, -height]]
    return Polyhedron.from_faces(np.concatenate([rim, tips]), np.concatenate([upper, lower]))


def accordion(folds: int) -> Polyhedron:
    """A bar of length 1 whose top is folded: needles between sharp edges."""
    top = [(k / folds, 0.3 + 0.02 * (k % 2)) for k in range(folds, -1, -1)]
    outline = np.array([*top, (0.0, 0.0), (1.0, 0.0)])
    count = len(outline)
    ring, after = np.arange(count), np.roll(np.arange(count), -1)
    sides = np.stack([ring, after, count + after, count + ring], axis=1).tolist()
    vertices = np.concatenate([np.insert(outline, 2, z, axis=1) for z in (0.0, 1.0)])
    return triangulated(Polyhedron.from_faces(vertices, [*sides, ring[::-1].tolist(), (count + ring).tolist()]))


def refined(mesh: Polyhedron, longest: float, most: int = 100_000) -> EdgeLog:
    return intrinsic_refinement(flat_flips(mesh), longest, most)


def in_space(mesh: Polyhedron, face: np.ndarray, weights: np.ndarray) -> np.ndarray:
    return np.einsum("nc,nci->ni", weights, mesh.vertices[mesh.triangles[face]])


@settings(max_examples=15, deadline=None)
@given(SEEDS)
def test_points_of_plane_parts_stay_where_they_are_and_are_found_again(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mesh = hard.with_slivers(hard.plate(1, 2, 2), 0.25, float(rng.choice([0.0, 1e-12, 1e-3])), 3, seed)
    log = refined(mesh, 0.5)
    assert log.halved.sum() > 100
    face, weights = rng.integers(mesh.face_count, size=2000), rng.dirichlet([0.3, 0.3, 0.3], size=2000)
    place, moved = log.locate(face, weights)
    assert moved.min() >= 0
    np.testing.assert_allclose(in_space(log.after, place, moved), in_space(mesh, face, weights), atol=1e-8)
    back, again = log.led_back(place, moved)
    assert again.min() >= 0
    np.testing.assert_allclose(in_space(mesh, back, again), in_space(mesh, face, weights), atol=1e-8)


@pytest.mark.parametrize("name", sorted(MESHES))
def test_the_mesh_stays_a_mesh_of_the_same_surface(name: str) -> None:
    mesh = MESHES[name]
    longest = even_edge_length(mesh, 600)
    after = refined(mesh, longest).after
    np.testing.assert_array_equal(after.twin[after.twin], np.arange(len(after.twin)))
    np.testing.assert_array_equal(after.same[after.twin], after.same)
    np.testing.assert_array_equal(after.tail, np.where(after.same, after.tail[after.twin], after.head[after.twin]))
    assert surface_type(after) == surface_type(mesh)
    np.testing.assert_array_equal(after.vertices[: len(mesh.vertices)], mesh.vertices)
    assert after.edge_lengths.max() <= longest * (1 + 1e-12)
    assert len(after.vertices) < 3000


@settings(max_examples=15, deadline=None)
@given(SEEDS, st.sampled_from(sorted(MESHES)))
def test_points_go_there_and_back(seed: int, name: str) -> None:
    mesh, rng = MESHES[name], np.random.default_rng(seed)
    log = refined(mesh, even_edge_length(mesh, 400))
    face, weights = rng.integers(mesh.face_count, size=500), rng.dirichlet([1, 1, 1], size=500)
    back, again = log.led_back(*log.locate(face, weights))
    np.testing.assert_array_equal(back, face)
    np.testing.assert_allclose(again, weights, atol=1e-9)


@settings(max_examples=10, deadline=None)
@given(SEEDS)
def test_products_along_old_edges_come_back(seed: int) -> None:
    """With any matrices at the vertices, G_i^-1 G_j is the product along every path from i to j."""
    rng = np.random.default_rng(seed)
    mesh = hard.with_slivers(hard.plate(1, 2, 2), 0.25, 1e-3, 3, seed)
    log = refined(mesh, 0.7)
    frames = np.linalg.qr(rng.normal(size=(len(log.after.vertices), 3, 3)))[0]
    steps = [np.linalg.inv(frames[m.tail]) @ frames[m.head] for m in (mesh, log.after)]
    np.testing.assert_allclose(log.carried_back(steps[1]), steps[0], atol=1e-9)


@settings(max_examples=10, deadline=None)
@given(SEEDS)
def test_plane_parts_are_delaunay(seed: int) -> None:
    """No corner of the triangle across an edge that may be flipped lies within the circle of a triangle."""
    mesh = hard.with_slivers(hard.plate(1, 2, 2), 0.25, 1e-3, 3, seed)
    after = refined(mesh, 0.4).after
    flat = bending(after).angle < SHARP
    here, opposite = after.vertices[after.triangles[after.face]], after.vertices[after.tail[after.next[after.next]]]
    edge = after.vertices[after.head] - after.vertices[after.tail]
    to_tail, to_head = after.vertices[after.tail] - opposite, after.vertices[after.head] - opposite
    angle = np.arctan2(np.linalg.norm(np.cross(to_tail, to_head), axis=1), (to_tail * to_head).sum(axis=1))
    assert here.shape == (*edge.shape[:1], 3, 3)
    assert (angle + angle[after.twin])[flat].max() <= np.pi + 1e-5


def developed(count: int, height: float) -> tuple[np.ndarray, float]:
    """The rim of a fan and its tip, the origin, unrolled into the plane; the angle of one needle at the tip."""
    slant, side = np.hypot(1, height), 2 * np.sin(np.pi / count)
    angle = 2 * np.arcsin(side / 2 / slant)
    return slant, angle


@pytest.mark.parametrize(("count", "height"), [(40, 1.0), (300, 0.3)])
def test_new_edges_are_straight_on_the_developed_cone(count: int, height: float) -> None:
    """Where a point lies, seen from the corners of its new triangle, it lies on the unrolled fan too."""
    mesh, rng = fan(count, height), np.random.default_rng(1)
    log = refined(mesh, 0.15)
    slant, angle = developed(count, height)

    def unrolled(face: np.ndarray, weights: np.ndarray) -> np.ndarray:
        turn = angle * (face[:, None] + [[0, 1]])
        corners = slant * np.stack([np.cos(turn), np.sin(turn)], axis=2)
        return np.einsum("nc,nci->ni", weights[:, :2], corners)

    # Corners of new triangles, each moved a hair into its triangle, so that it is unrolled on the side of that.
    after = log.after
    whole = np.arange(after.face_count)
    corner = [log.led_back(whole, 0.001 / 3 + 0.999 * np.eye(3)[[c] * after.face_count]) for c in range(3)]
    faces = np.stack([face for face, _ in corner], axis=1)
    # Upper needles only, and no triangle over the cut along which the fan is unrolled.
    inner = (faces < count).all(axis=1) & (np.ptp(faces, axis=1) < count / 2)
    assert inner.sum() > 100
    places = np.stack([unrolled(face, weights) for face, weights in corner], axis=1)
    chosen = rng.choice(np.flatnonzero(inner), 400)
    weights = rng.dirichlet([1, 1, 1], size=400)
    mixed = weights * 0.999 + 0.001 / 3
    back = log.led_back(chosen, mixed)
    np.testing.assert_allclose(unrolled(*back), np.einsum("nc,nci->ni", weights, places[chosen]), atol=1e-12)


def test_vertices_do_not_grow_with_the_needles() -> None:
    """The area asks for as many for 30,000 needles as for 1,000, and the steps grow like the needles."""
    few, many = (refined(fan(count), 0.05) for count in (1_000, 30_000))
    assert many.halved.sum() <= 1.1 * few.halved.sum()
    assert len(many.halfedge) <= 30 * 30_000
    bound = 3 * np.linalg.norm([1, 1]) * np.pi * 2 / 0.05**2
    assert few.halved.sum() <= bound


def test_no_more_edges_are_halved_than_allowed() -> None:
    assert refined(fan(100), 0.01, 50).halved.sum() == 50


def test_sharp_edges_that_would_be_crowded_are_halved_first() -> None:
    """Without that, on 500 folds, 12,700 vertices and edges a fourth as long."""
    mesh = accordion(500)
    longest = even_edge_length(mesh, 6000)
    after = refined(mesh, longest).after
    assert len(after.vertices) < 11_000
    assert after.edge_lengths.min() > 0.04 * longest


def test_an_edge_with_a_corner_in_its_middle_stays() -> None:
    """Of lengths 2, 1 and 1 on one side: its halves would have a triangle of no size."""
    twin = np.array([3, 6, 7, 0, 8, 9, 1, 2, 4, 5])
    for height, may in ((1e-12, False), (1e-3, True), (1.0, True)):
        slanted = np.hypot(1, height)
        length = np.array([2.0, slanted, slanted, 2.0, 2.0, 2.0])
        assert _may_be_halved(length, twin, 0) == may


def test_nothing_is_done_where_a_triangle_meets_itself() -> None:
    """Two cones with a common loop."""
    tail, twin = np.array([0, 1, 0, 0, 2, 0]), np.array([1, 0, 5, 4, 3, 2])
    cones = Polyhedron(np.eye(3), np.array([0, 3, 6]), tail, twin, np.zeros(6, dtype=np.bool_))
    log = EdgeLog(cones, np.empty((0, 2), dtype=np.intp), np.empty((0, 2)))
    assert intrinsic_refinement(log, 0.1, 100) is log


def test_only_the_vertices_of_the_file_are_points_of_a_smooth_shape() -> None:
    """Those that refinement adds to its needles lie on chords; they ask for fairness alone."""
    mesh = fan(400)
    log = refined(mesh, 0.2)
    fine = bisected(mesh, 0.2, True, log)
    made = REGISTRY.load("parametrizer", "sphere")(fine.polyhedron, REGISTRY.geometry(2), None)
    assert len(fine.facets.vertices) > len(mesh.vertices) + 200
    samples = vertex_samples(made, fine)
    assert (samples.weights > 0).sum() == len(mesh.vertices)
    np.testing.assert_array_equal(samples.values[samples.weights > 0], mesh.vertices)


def test_bisection_after_the_log_is_affordable() -> None:
    """A part whose folds are all sharp is not cut without bounds: the edges may be longer then."""
    mesh, wanted = accordion(500), 50
    mapping = Mapping(mesh, mesh, surface_type(mesh), Config.load(), Stages(REGISTRY, lambda *_: None))
    longest = even_edge_length(mapping.facets, wanted) / 8
    made = mapping._refined(longest, wanted).polyhedron
    assert made.edge_lengths.max() > 2 * longest
    assert made.face_count <= 3 * (20 * wanted + mapping.facets.face_count)


def test_a_bisection_after_the_log_finds_points_and_origins() -> None:
    mesh = fan(500)
    log = refined(mesh, 0.2)
    fine = bisected(mesh, 0.15, True, log)
    assert len(fine.side) > log.after.face_count
    face, weights = fine.origins()
    place, moved = fine.locate(face, weights)
    corner = fine.polyhedron.triangles[place, moved.argmax(axis=1)]
    np.testing.assert_allclose(moved.max(axis=1), 1, atol=1e-9)
    np.testing.assert_array_equal(corner, np.arange(len(corner)))


@pytest.mark.long
def test_a_fan_of_thousands_of_needles_is_fitted() -> None:
    """About as many vertices as without needles, an even map, and the faces of the file found again on the sphere."""
    mesh = fan(3_000)
    made = pipeline.fit(mesh, config(300), REGISTRY)
    assert made.report["map"]["triangles"] <= 2 * (3_002 + 3 * 3_000)
    assert made.report["map"]["angle_distortion"]["median"] < 1.1
    assert made.report["fit"]["rms"] < 1e-3
    shapes = face_shapes(mesh, made.surface.refinement, made.surface.triangulation)
    assert shapes.area.sum() == pytest.approx(4 * np.pi, rel=1e-9)
