"""Halfedges, twins and edges against their definitions, brute force."""

from __future__ import annotations

from collections import Counter, defaultdict

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_polyhedra import edges_of, face_lists, random_polyhedra

from orbiframe.errors import TopologyError
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.polyhedra import reference_polyhedra


def soup(seed: int, faces: int) -> Polyhedron:
    """Random triangles, quads and pentagons on eight vertices: edges in any number of faces."""
    rng = np.random.default_rng(seed)
    corners = [rng.permutation(8)[: rng.integers(3, 6)].tolist() for _ in range(faces)]
    return Polyhedron.from_faces(rng.normal(size=(8, 3)), corners)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 8))
def test_twins_are_the_pairs_of_halfedges_with_the_same_two_ends(seed: int, faces: int) -> None:
    mesh = soup(seed, faces)
    members = defaultdict(list)
    for h, ends in enumerate(zip(mesh.tail.tolist(), mesh.head.tolist(), strict=True)):
        members[frozenset(ends)].append(h)
    twin, same = np.full(len(mesh.tail), -1), np.zeros(len(mesh.tail), dtype=bool)
    for a, b in (pair for pair in members.values() if len(pair) == 2):
        twin[a], twin[b] = b, a
        same[a] = same[b] = mesh.tail[a] == mesh.tail[b]
    np.testing.assert_array_equal(mesh.twin, twin)
    np.testing.assert_array_equal(mesh.same, same)


@settings(max_examples=20, deadline=None)
@given(random_polyhedra())
def test_halfedges_run_round_their_faces(mesh: Polyhedron) -> None:
    start = 0
    for number, face in enumerate(face_lists(mesh)):
        part = slice(start, start + len(face))
        np.testing.assert_array_equal(mesh.face[part], number)
        np.testing.assert_array_equal(mesh.tail[part], face)
        np.testing.assert_array_equal(mesh.head[part], np.roll(face, -1))
        np.testing.assert_array_equal(mesh.next[part], start + np.roll(np.arange(len(face)), -1))
        start += len(face)
    assert start == len(mesh.tail)


@settings(max_examples=20, deadline=None)
@given(random_polyhedra())
def test_edges_are_numbered_without_gaps_and_shared_by_twins(mesh: Polyhedron) -> None:
    assert mesh.edge_count == len(edges_of(face_lists(mesh)))
    assert set(Counter(mesh.edge.tolist()).values()) == {2}
    assert mesh.edge.max() == mesh.edge_count - 1
    np.testing.assert_array_equal(mesh.edge[mesh.twin], mesh.edge)
    np.testing.assert_array_equal(mesh.edge[mesh.representative], np.arange(mesh.edge_count))


def test_halfedges_without_a_twin_are_an_edge_each() -> None:
    fin = Polyhedron.from_faces(np.eye(5)[:, :3], [[0, 1, 2], [0, 1, 3], [0, 1, 4]])
    assert fin.edge_count == 9
    np.testing.assert_array_equal(fin.twin, -1)
    np.testing.assert_array_equal(np.sort(fin.edge), np.arange(9))


def test_cube_has_unit_edges_and_diagonal_root_three() -> None:
    cube = reference_polyhedra()["cube"]
    np.testing.assert_array_equal(cube.edge_lengths, 1.0)
    assert cube.diagonal == pytest.approx(np.sqrt(3), rel=1e-15)
    assert cube.with_vertices(3 * cube.vertices).diagonal == pytest.approx(np.sqrt(27), rel=1e-15)


@pytest.mark.parametrize("scale", [1e-200, 1e200])
def test_diagonal_neither_overflows_nor_vanishes(scale: float) -> None:
    cube = reference_polyhedra()["cube"]
    assert cube.with_vertices(cube.vertices * scale).diagonal == pytest.approx(np.sqrt(3) * scale, rel=1e-14)


def test_polyhedron_without_vertices_has_no_diagonal() -> None:
    nothing = Polyhedron.from_faces(np.zeros((0, 3)), [])
    assert (nothing.diagonal, nothing.face_count, nothing.edge_count) == (0.0, 0, 0)
    assert nothing.is_triangular
    assert nothing.triangles.shape == (0, 3)


def test_an_array_of_equal_faces_is_a_list_of_faces() -> None:
    cube = reference_polyhedra()["cube"]
    faces = np.array(face_lists(cube))
    again = Polyhedron.from_faces(cube.vertices, faces)
    for name in ("vertices", "offsets", "tail", "twin", "same"):
        np.testing.assert_array_equal(getattr(again, name), getattr(cube, name))


def test_vertices_are_replaced_and_colours_kept() -> None:
    colors = np.linspace(0, 1, 9).reshape(3, 3)
    triangle = Polyhedron.from_corners(np.eye(3), [0, 3], [0, 1, 2], normals=np.eye(3), colors=colors)
    moved = triangle.with_vertices(2 * np.eye(3))
    np.testing.assert_array_equal(moved.vertices, 2 * np.eye(3))
    np.testing.assert_array_equal(moved.colors, colors)
    assert moved.normals is None


@pytest.mark.parametrize(("corner", "face"), [(7, 1), (-1, 1), (4, 1)])
def test_a_corner_that_is_no_vertex_is_named_with_its_face(corner: int, face: int) -> None:
    with pytest.raises(TopologyError, match=rf"face {face} names vertex {corner}, but the vertices are 0 to 3"):
        Polyhedron.from_faces(np.zeros((4, 3)), [[0, 1, 2], [0, 2, corner], [0, 1, 3]])


@pytest.mark.parametrize("offsets", [[], [1, 3], [0, 2], [0, 2, 1, 3], [0, 4]])
def test_offsets_must_cut_the_corners_into_faces(offsets: list[int]) -> None:
    with pytest.raises(TopologyError, match="offsets"):
        Polyhedron.from_corners(np.eye(3), offsets, [0, 1, 2])


def test_larger_faces_are_no_triangles() -> None:
    with pytest.raises(TopologyError, match="triangulated"):
        _ = reference_polyhedra()["cube"].triangles
