"""Triangulations of X/H: signs, areas, folds, relations and distortion against brute force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from reference_surfaces import ALL, in_two_frames, torus, triangulated as closed_form

from orbiframe.errors import MapError
from orbiframe.meshes.orientation import reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.reference import RECIPES, reference_triangulations
from orbiframe.triangulations.triangulation import Triangulation

SEEDS = st.integers(0, 2**32 - 1)


@pytest.fixture(params=[*RECIPES, *(f"closed form {name}" for name in ALL)])
def made(request: pytest.FixtureRequest) -> Triangulation:
    """A map on every surface."""
    name = request.param.removeprefix("closed form ")
    return closed_form(name, 2) if name != request.param else reference_triangulations()[name]


def flat_torus(n: int, place) -> Triangulation:
    """An n by n grid of squares, each cut in two, on the unit square torus; vertices in space at place(p)."""
    orbifold = torus()
    i, j = np.divmod(np.arange(n * n), n)
    steps = {tuple(np.round(g[1:, 0]).astype(int)): t for t, g in enumerate(orbifold.atlas.isometry)}
    cells = np.stack([i, j], axis=1)
    corners = [cells + np.array(step) for step in ([0, 0], [1, 0], [1, 1], [0, 1])]
    faces = np.concatenate([np.stack([corners[k] for k in ks], axis=1) for ks in ([0, 1, 2], [0, 2, 3])])
    points = np.concatenate([np.ones((n * n, 1)), cells / n - 0.5], axis=1)
    mesh = Polyhedron.from_faces(place(points[:, 1:]), (faces % n) @ [n, 1])
    wrap = faces // n
    shift = (np.roll(wrap, -1, axis=1) - wrap).reshape(-1, 2)
    transition = np.array([diagonal_step(steps, tuple(s)) for s in shift.tolist()])
    table = orbifold.atlas
    if (transition >= len(table.isometry)).any():
        table = with_diagonals(table)
    orbifold = replace(orbifold, atlas=table)
    return Triangulation(orbifold, mesh, np.zeros(n * n, dtype=int), points, transition)


def diagonal_step(steps: dict, shift: tuple[int, int]) -> int:
    return steps[shift] if shift in steps else 5 + [(1, 1), (-1, -1)].index(shift)


def with_diagonals(atlas):
    """The table of the square torus with the translations by (1, 1) and (-1, -1) behind its five."""
    both = np.tile(np.eye(3), (2, 1, 1))
    both[0, 1:, 0], both[1, 1:, 0] = 1, -1
    ends, inverse = np.append(atlas.tail, [0, 0]), np.append(atlas.inverse, [6, 5])
    return replace(atlas, tail=ends, head=ends, inverse=inverse, isometry=np.concatenate([atlas.isometry, both]))


def test_an_embedding_is_positive_and_covers_the_surface_once(made: Triangulation) -> None:
    assert made.not_positive == 0
    assert (made.areas > 0).all()
    assert made.area_defect < 1e-12
    assert made.relation_defect < 1e-9


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("wrong", [0.5, 0.99, 1.01, 2.0])
def test_a_map_that_does_not_have_the_area_of_the_surface_shows_it(name: str, wrong: float) -> None:
    """A surface `wrong` times as large as what is covered: the part of it that is missing or too much."""
    made = closed_form(name, 2)
    larger = replace(made, orbifold=replace(made.orbifold, area=wrong * made.orbifold.area))
    assert larger.area_defect == pytest.approx(abs(1 / wrong - 1), rel=1e-9)


def test_transitions_of_twins_are_inverse_or_equal(made: Triangulation) -> None:
    mesh, atlas, t = made.polyhedron, made.orbifold.atlas, made.transition
    np.testing.assert_array_equal(t[mesh.twin], np.where(mesh.same, t, atlas.inverse[t]))


def test_angles_add_up_to_a_full_turn_at_every_vertex(made: Triangulation) -> None:
    x, geometry = made.lifts, made.orbifold.geometry
    angle = np.stack([geometry.angle(x[:, k], x[:, (k + 1) % 3], x[:, (k + 2) % 3]) for k in range(3)], axis=1)
    around = np.bincount(made.polyhedron.tail, weights=np.abs(angle).ravel())
    np.testing.assert_allclose(around, 2 * np.pi, atol=1e-9)


def test_lifts_are_the_ends_of_lifted_edges(made: Triangulation) -> None:
    """Corner by corner: the second is one edge away, the third is the first seen back along the third edge."""
    atlas = made.orbifold.atlas
    for face in range(0, made.polyhedron.face_count, 7):
        i, j, k = made.polyhedron.triangles[face]
        t = made.transition[3 * face : 3 * face + 3]
        second = atlas.isometry[t[0]] @ made.points[j]
        third = atlas.isometry[t[0]] @ atlas.isometry[t[1]] @ made.points[k]
        np.testing.assert_allclose(made.lifts[face], [made.points[i], second, third], atol=1e-9)


def test_neighbours_agree_on_their_common_edge(made: Triangulation) -> None:
    mesh, atlas = made.polyhedron, made.orbifold.atlas
    h = np.flatnonzero(mesh.representative)
    share = np.random.default_rng(3).random(len(h))

    def on_edge(halfedge: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The point at this share of a halfedge, and the point seen from the frame of the tail of that halfedge."""
        face, side = halfedge // 3, halfedge % 3
        weights = np.zeros((len(h), 3))
        rows = np.arange(len(h))
        weights[rows, side], weights[rows, (side + 1) % 3] = 1 - at, at
        patch, x = made.locate(face, weights)
        first = mesh.triangles[face, 0]
        np.testing.assert_array_equal(patch, made.patch[first])
        back = np.stack(
            [np.zeros_like(face), made.transition[3 * face], atlas.inverse[made.transition[3 * face + 2]]], 1
        )
        away = atlas.inverse[back[rows, side]]
        return mesh.tail[halfedge], np.einsum("nij,nj->ni", atlas.isometry[away], x)

    tail, mine = on_edge(h, share)
    other = mesh.twin[h]
    same = mesh.same[h]
    end, theirs = on_edge(other, np.where(same, share, 1 - share))
    step = np.where(same, 0, made.transition[h])
    np.testing.assert_array_equal(end, np.where(same, tail, mesh.head[h]))
    np.testing.assert_allclose(mine, np.einsum("nij,nj->ni", atlas.isometry[step], theirs), atol=1e-9)


def test_barycentric_corners_are_the_vertices(made: Triangulation) -> None:
    count = made.polyhedron.face_count
    for corner in range(3):
        points = made.locate(np.arange(count), np.tile(np.eye(3)[corner], (count, 1)))
        np.testing.assert_allclose(points.x, made.lifts[:, corner], atol=1e-12)


# ---- folds ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [name for name in ALL if name != "sphere"])
def test_a_vertex_pushed_across_an_edge_is_found_but_not_by_the_sum_of_areas(name: str) -> None:
    made = closed_form(name, 2)
    mesh, geometry = made.polyhedron, made.orbifold.geometry
    halfedge = 3 * (mesh.face_count // 2)
    opposite = mesh.tail[mesh.next[mesh.next[halfedge]]]
    x = made.lifts[halfedge // 3]
    middle = geometry.geodesic(x[0], x[1], 0.5)
    seen = made.orbifold.atlas.isometry[made.transition[halfedge + 2]] @ middle
    points = made.points.copy()
    points[opposite] = geometry.geodesic(points[opposite], seen, 1.2)
    folded = replace(made, points=points)
    assert folded.not_positive > 0
    assert folded.areas[halfedge // 3] < 0
    assert folded.area_defect < 1e-9


@pytest.mark.parametrize("name", [name for name in ALL if name not in ("sphere", "projective_plane")])
@settings(max_examples=10, deadline=None)
@given(seed=SEEDS, size=st.floats(0.001, 0.5))
def test_the_sum_of_areas_is_the_same_wherever_the_vertices_lie(name: str, seed: int, size: float) -> None:
    """By Gauss-Bonnet for a map of degree one: no test of an embedding."""
    made = closed_form(name, 2)
    rng = np.random.default_rng(seed)
    geometry = made.orbifold.geometry
    move = geometry.from_polar(size * rng.random(len(made.points)), rng.uniform(0, 2 * np.pi, len(made.points)))
    moved = replace(made, points=np.einsum("nij,nj->ni", geometry.carry(made.points), move))
    assert moved.area_defect < 1e-9


def test_a_collapsed_triangle_is_not_positive() -> None:
    made = flat_torus(4, lambda p: np.c_[p, p[:, 0]])
    points = made.points.copy()
    points[5] = points[6]
    assert replace(made, points=points).not_positive == 2
    points[5] = np.nan
    assert replace(made, points=points).not_positive == 6


def test_signs_follow_reversed_faces(made: Triangulation) -> None:
    """Reversed triangles have reversed signs, and areas that stay positive."""
    mesh = made.polyhedron
    flip = np.random.default_rng(1).random(mesh.face_count) < 0.3
    number = np.arange(len(mesh.tail)).reshape(-1, 3)
    old = np.where(flip[:, None], number[:, [2, 1, 0]], number).ravel()
    inverse = made.orbifold.atlas.inverse
    transition = np.where(np.repeat(flip, 3), inverse[made.transition[old]], made.transition)
    turned = replace(made, polyhedron=reversed_faces(mesh, flip), transition=transition)
    np.testing.assert_allclose(turned.areas, made.areas, atol=1e-12)
    ratio = turned.face_signs * made.face_signs
    np.testing.assert_array_equal(ratio, ratio[~flip][0] * np.where(flip, -1, 1))


@pytest.mark.parametrize("name", ["klein_bottle", "projective_plane", "octagon"])
def test_the_choice_of_frames_changes_nothing(name: str) -> None:
    made = closed_form(name, 2)
    other = in_two_frames(made)
    np.testing.assert_allclose(other.areas, made.areas, atol=1e-9)
    np.testing.assert_allclose(other.angle_distortion, made.angle_distortion, rtol=1e-6)
    assert other.relation_defect < 1e-9


def test_a_group_of_another_surface_is_refused() -> None:
    """Transitions of the torus where those of the Klein bottle belong: orientation comes back reversed."""
    made = closed_form("klein_bottle", 2)
    isometry = made.orbifold.atlas.isometry.copy()
    isometry[:, 2, 2] = np.abs(isometry[:, 2, 2])
    atlas = replace(made.orbifold.atlas, isometry=isometry)
    with pytest.raises(MapError, match="another surface"):
        _ = replace(made, orbifold=replace(made.orbifold, atlas=atlas)).areas


@pytest.mark.parametrize("size", [1e-6, 1e-3])
def test_relation_defect_is_the_error_of_the_transitions(size: float) -> None:
    made = closed_form("octagon", 2)
    isometry = made.orbifold.atlas.isometry.copy()
    isometry[np.unique(made.transition)[1], 0, 0] += size
    wrong = replace(made.orbifold, atlas=replace(made.orbifold.atlas, isometry=isometry))
    assert size / 10 < replace(made, orbifold=wrong).relation_defect < 1000 * size


# ---- distortion -----------------------------------------------------------------------------------------------------


@settings(max_examples=10, deadline=None)
@given(SEEDS)
def test_distortion_is_the_ratio_of_singular_values(seed: int) -> None:
    rng = np.random.default_rng(seed)
    made = flat_torus(5, lambda p: rng.normal(size=(len(p), 3)))
    space = made.polyhedron.vertices[made.polyhedron.triangles]
    for face, expected in enumerate(made.angle_distortion):
        a, b, c = space[face]
        q, _ = np.linalg.qr(np.stack([b - a, c - a], axis=1))
        source = q.T @ np.stack([b - a, c - a], axis=1)
        x = made.lifts[face][:, 1:]
        image = np.stack([x[1] - x[0], x[2] - x[0]], axis=1)
        values = np.linalg.svd(image @ np.linalg.inv(source), compute_uv=False)
        assert expected == pytest.approx(values[0] / values[1], rel=1e-6)


@pytest.mark.parametrize("ratio", [1.0, 1.5, 7.0, 1e3])
def test_a_stretched_grid_has_the_known_ratio(ratio: float) -> None:
    """On faces inside the square, where the torus in space is the plane of the square stretched by `ratio`."""
    made = flat_torus(6, lambda p: np.c_[ratio * p[:, 0], p[:, 1], np.zeros(len(p))])
    inside = np.ptp(made.lifts[..., 1:], axis=1).max(axis=1) < 0.2
    inside &= (np.ptp(made.polyhedron.vertices[made.polyhedron.triangles], axis=1) < [0.2 * ratio, 0.2, 1]).all(axis=1)
    assert inside.sum() == 50
    np.testing.assert_allclose(made.angle_distortion[inside], ratio, rtol=1e-7)


def test_distortion_of_a_collapse_is_infinite() -> None:
    made = flat_torus(4, lambda p: np.c_[p, p[:, 0] * 0])
    points = made.points.copy()
    points[5] = points[6]
    assert np.isinf(replace(made, points=points).angle_distortion).sum() == 2
    flat = made.polyhedron.with_vertices(made.polyhedron.vertices * [1, 0, 0])
    assert np.isinf(replace(made, polyhedron=flat).angle_distortion).all()


def test_the_identity_of_the_sphere_is_nearly_conformal() -> None:
    coarse, fine = (closed_form("sphere", times).angle_distortion.max() - 1 for times in (2, 4))
    assert 0 <= fine < 0.15 * coarse
