"""Polygons cut into triangles: area, orientation and gluing against the shoelace formula and brute force."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_polyhedra import (
    bent_polyhedra,
    edges_of,
    face_lists,
    polyhedra_with_doubled_edges,
    random_polyhedra,
    with_split_edge,
)

from orbiframe.errors import TopologyError
from orbiframe.meshes.ear_clipping import cut_ears
from orbiframe.meshes.face_diagonals import cut_into_triangles, outline, triangulated
from orbiframe.meshes.orientation import reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.meshes.surface_type import SurfaceType, doubled_edges, surface_type
from orbiframe.meshes.told_by_ends import require_told_by_ends
from orbiframe.testing.polyhedra import reference_polyhedra

SEEDS = st.integers(0, 2**32 - 1)


def star_shaped(seed: int, corners: int, roughness: float) -> np.ndarray:
    """A polygon that is seen whole from the origin, (n, 2), counterclockwise; roughness 0 puts it on a circle."""
    rng = np.random.default_rng(seed)
    gaps = 0.3 + rng.random(corners)
    angle = 2 * np.pi * np.cumsum(gaps) / gaps.sum()
    radius = 1 - roughness * rng.random(corners)
    return radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def shoelace(p: np.ndarray) -> float:
    x, y = p.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def in_random_plane(p: np.ndarray, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """The polygon somewhere in space, and the normal of its plane."""
    rng = np.random.default_rng(seed)
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    q[:, 2] = np.cross(q[:, 0], q[:, 1])
    return p @ q[:, :2].T + rng.normal(size=3), q[:, 2]


def cut(p: np.ndarray, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (T, 3) of one polygon in a random plane, and their signed areas (T,)."""
    vertices, normal = in_random_plane(p, seed)
    result = triangulated(Polyhedron.from_faces(vertices, [list(range(len(p)))]))
    assert len(result.vertices) == len(p)
    return result.triangles, vector_areas(result) @ normal


def assert_cut_well(p: np.ndarray, seed: int = 0) -> None:
    triangles, areas = cut(p, seed)
    assert len(triangles) == len(p) - 2
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(shoelace(p), rel=1e-12)
    assert len(edges_of(triangles.tolist())) == 2 * len(p) - 3


@settings(max_examples=100, deadline=None)
@given(SEEDS, st.integers(3, 40), st.sampled_from([0.0, 0.3, 0.95]))
def test_polygons_convex_or_not_are_cut_into_positive_triangles(seed: int, corners: int, roughness: float) -> None:
    assert_cut_well(star_shaped(seed, corners, roughness), seed)


@pytest.mark.parametrize("roughness", [0.0, 0.9])
def test_a_thousand_corners(roughness: float) -> None:
    assert_cut_well(star_shaped(7, 1000, roughness))


def test_a_spiral_of_two_hundred_corners() -> None:
    t = np.linspace(0, 6 * np.pi, 100)
    ray = np.stack([np.cos(t), np.sin(t)], axis=1)
    assert_cut_well(np.concatenate([(1 + t)[:, None] * ray, ((2.5 + t)[:, None] * ray)[::-1]])[::-1])


def test_corners_on_a_straight_side() -> None:
    assert_cut_well(np.array([[0, 0], [1, 0], [2, 0], [3, 0], [3, 3], [2, 3], [0, 3], [0, 1.5]]))


@pytest.mark.parametrize("reflex", range(4))
@pytest.mark.parametrize("depth", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("length", [1, 30])
def test_a_concave_quadrilateral_is_cut_through_its_reflex_corner(reflex: int, depth: float, length: float) -> None:
    """Also where that diagonal is the longer one."""
    arrow = np.roll([[0, -1], [length, 0], [0, 1], [depth * length, 0]], reflex - 3, axis=0)
    assert_cut_well(arrow)
    triangles, _ = cut(arrow)
    assert all(reflex in triangle for triangle in triangles.tolist())


@pytest.mark.parametrize("turn", range(4))
def test_a_convex_quadrilateral_gets_its_shorter_diagonal(turn: int) -> None:
    long, short = 0, 1
    kite = np.roll([[long, -2], [short, 0], [long, 2], [-short, 0]], turn, axis=0).astype(float)
    assert_cut_well(kite)
    triangles, _ = cut(kite)
    diagonal = set(triangles[0].tolist()) & set(triangles[1].tolist())
    assert np.linalg.norm(np.subtract(*kite[list(diagonal)])) == 2


def test_a_square_gets_the_diagonal_through_its_least_vertex() -> None:
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    for face in ([0, 1, 2, 3], [1, 2, 3, 0], [3, 2, 1, 0]):
        triangles = triangulated(Polyhedron.from_faces(square, [face])).triangles
        assert {0, 2} <= set(triangles[0].tolist()) & set(triangles[1].tolist())


@settings(max_examples=40, deadline=None)
@given(random_polyhedra(), SEEDS)
def test_surface_vector_area_and_vertices_are_kept(mesh: Polyhedron, seed: int) -> None:
    mixed = reversed_faces(mesh, np.random.default_rng(seed).random(mesh.face_count) < 0.5)
    result = triangulated(mixed)
    assert surface_type(result) == surface_type(mesh)
    np.testing.assert_array_equal(result.vertices[: len(mesh.vertices)], mesh.vertices)
    np.testing.assert_allclose(total_vector_areas(result, mixed), vector_areas(mixed), atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(random_polyhedra(), SEEDS)
def test_twins_of_the_triangles_share_their_ends(mesh: Polyhedron, seed: int) -> None:
    result = triangulated(reversed_faces(mesh, np.random.default_rng(seed).random(mesh.face_count) < 0.5))
    twin, same = result.twin, result.same
    np.testing.assert_array_equal(twin[twin], np.arange(len(twin)))
    np.testing.assert_array_equal(same[twin], same)
    np.testing.assert_array_equal(result.tail, np.where(same, result.tail[twin], result.head[twin]))


def assert_no_two_edges_alike(result: Polyhedron, expected: SurfaceType) -> None:
    require_told_by_ends(result, expected)
    assert not doubled_edges(result).any()


def about_two_corners(count: int) -> Polyhedron:
    """Quads about two corners, each between two vertices of valence 2: the other diagonal of all joins the corners."""
    turn = 2 * np.pi * np.arange(count) / count
    ring = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    middle = [[0, 2 + k, 1, 2 + (k + 1) % count] for k in range(count)]
    return Polyhedron.from_faces(np.concatenate([[[0, 0, 3], [0, 0, -3]], ring]), middle)


@pytest.mark.parametrize("count", [3, 4, 5, 8, 40])
def test_quads_about_two_corners_get_no_diagonal_twice(count: int) -> None:
    mesh = about_two_corners(count)
    assert_no_two_edges_alike(triangulated(mesh), surface_type(mesh))


@pytest.mark.parametrize("depth", [0.0, 0.5, 3.0])
def test_a_bent_edge_gives_a_closed_mesh(depth: float) -> None:
    """Both faces at a vertex of valence 2 are cut by a diagonal that joins its neighbours, if each is cut alone."""
    cube = reference_polyhedra()["cube"]
    faces, (a, b) = with_split_edge(face_lists(cube), 8, np.random.default_rng(0))
    middle = (cube.vertices[a] + cube.vertices[b]) / 2
    points = np.concatenate([cube.vertices, [middle + depth * (middle - cube.vertices.mean(axis=0))]])
    mesh = Polyhedron.from_faces(points, faces)
    result = triangulated(mesh)
    assert_no_two_edges_alike(result, surface_type(mesh))
    np.testing.assert_allclose(total_vector_areas(result, mesh), vector_areas(mesh), atol=1e-12)


@pytest.mark.parametrize("corners", [4, 5, 6, 7, 40, 999])
@pytest.mark.parametrize("turn", [0, 1])
def test_two_faces_on_the_same_corners(corners: int, turn: int) -> None:
    turned = 2 * np.pi * np.arange(corners) / corners
    points = np.stack([np.cos(turned), np.sin(turned), 0 * turned], axis=1)
    face = list(range(corners))
    mesh = Polyhedron.from_faces(points, [face, np.roll(face[::-1], turn).tolist()])
    result = triangulated(mesh)
    assert_no_two_edges_alike(result, surface_type(mesh))
    assert (vector_areas(result) @ [0, 0, 1] * np.where(cut_into_triangles(mesh).face, -1, 1) > 0).all()


@settings(max_examples=150, deadline=None)
@given(bent_polyhedra(), SEEDS)
def test_no_diagonal_joins_what_is_joined(mesh: Polyhedron, seed: int) -> None:
    """Over vertices of valence 2; the vector area of every face is kept, also by points on diagonals."""
    mixed = reversed_faces(mesh, np.random.default_rng(seed).random(mesh.face_count) < 0.5)
    result = triangulated(mixed)
    assert_no_two_edges_alike(result, surface_type(mesh))
    np.testing.assert_array_equal(result.vertices[: len(mesh.vertices)], mesh.vertices)
    np.testing.assert_allclose(total_vector_areas(result, mixed), vector_areas(mixed), atol=1e-12)
    np.testing.assert_array_equal(result.tail[outline(mixed)], mixed.tail)
    np.testing.assert_array_equal(result.head[outline(mixed)], mixed.head)


@settings(max_examples=60, deadline=None)
@given(polyhedra_with_doubled_edges())
def test_doubled_edges_of_the_input_stay_and_the_surface_too(mesh: Polyhedron) -> None:
    result = triangulated(mesh)
    assert surface_type(result) == surface_type(mesh)
    ends = np.sort(np.stack([mesh.tail, mesh.head])[:, mesh.representative], axis=0).T.tolist()
    inner = np.setdiff1d(np.flatnonzero(result.representative), outline(mesh))
    for a, b in np.sort(np.stack([result.tail, result.head])[:, inner], axis=0).T.tolist():
        assert [a, b] not in ends or a == b


def total_vector_areas(result: Polyhedron, mesh: Polyhedron) -> np.ndarray:
    total = np.zeros((mesh.face_count, 3))
    np.add.at(total, cut_into_triangles(mesh).face, vector_areas(result))
    return total


@pytest.mark.parametrize("shape", [(1, 0.0), (1, 0.9), (2, 0.0)])
def test_the_steps_for_a_large_face_grow_hardly_faster_than_its_corners(shape: tuple[int, float]) -> None:
    """A search of all corners for every ear takes n^2; counted, not timed."""
    kind, roughness = shape
    polygon = [star_shaped(3, n, roughness) if kind == 1 else comb(n) for n in (1000, 16_000)]
    few, many = (cut_ears(p)[1] for p in polygon)
    assert many < 16**1.5 * few
    assert many < 300 * 16_000


def comb(corners: int) -> np.ndarray:
    tooth = np.arange(corners // 2)
    top = np.stack([tooth, np.where(tooth % 2, corners, 0)], axis=1)
    return np.concatenate([top, np.stack([tooth[::-1], np.full(len(tooth), -1)], axis=1)])[::-1].astype(float)


def test_a_comb_of_many_teeth() -> None:
    assert_cut_well(comb(2000))


def test_open_polyhedra_keep_their_boundary() -> None:
    cube = reference_polyhedra()["cube"]
    box = Polyhedron.from_faces(cube.vertices, face_lists(cube)[:-1])
    result = triangulated(box)
    assert (result.twin < 0).sum() == 4
    assert surface_type(result) == surface_type(box)


def test_colours_go_with_the_faces() -> None:
    cube, colors = reference_polyhedra()["prism"], np.arange(21.0).reshape(7, 3) / 21
    mesh = Polyhedron.from_corners(cube.vertices, cube.offsets, cube.tail, face_colors=colors, colors=cube.vertices)
    result = triangulated(mesh)
    assert result.face_colors is not None
    np.testing.assert_array_equal(result.face_colors, colors[cut_into_triangles(mesh).face])
    np.testing.assert_array_equal(result.colors, cube.vertices)


def test_triangles_are_returned_as_they_are() -> None:
    mesh = reference_polyhedra()["tetrahedron"]
    assert triangulated(mesh) is mesh


@pytest.mark.parametrize("points", [np.zeros((7, 3)), np.outer(np.arange(7), [1, 2, 3]), np.eye(7)[:, :3]])
def test_a_face_without_a_plane_still_gives_a_disc(points: np.ndarray) -> None:
    result = triangulated(Polyhedron.from_faces(points, [list(range(7))]))
    kind = surface_type(result)
    assert (result.face_count, kind.euler_characteristic, kind.components) == (5, 1, 1)


@pytest.mark.parametrize("corners", [0, 1, 2])
def test_faces_of_few_corners_are_refused(corners: int) -> None:
    mesh = Polyhedron.from_faces(np.eye(4)[:, :3], [[0, 1, 2, 3], list(range(corners))])
    with pytest.raises(TopologyError, match=f"face 1 has {corners} corners"):
        triangulated(mesh)
