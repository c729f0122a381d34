"""Flips: twins, the Delaunay property, the metric that stays, and the way back."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from orbiframe_parametrizers.flips import Flippable, _flip

from orbiframe import MapError, Polyhedron, surface_type
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.subdivision import refine
from orbiframe.testing.polyhedra import reference_polyhedra

NAMES = sorted(reference_polyhedra())


def mesh_of(name: str, density: int = 2) -> Polyhedron:
    return refine(triangulated(reference_polyhedra()[name]), density).polyhedron


def opposite_cosines(state: Flippable) -> NDArray[np.float64]:
    """The sum of the cosines of the two angles opposite to every edge that lies in two faces."""
    x = state.x.reshape(-1, 3)
    before, after = np.roll(x, 1, axis=1), np.roll(x, -1, axis=1)
    cosine = ((after**2 + before**2 - x**2) / (2 * after * before)).ravel()
    slots = np.arange(len(state.x))
    return (cosine + cosine[state.twin])[slots // 3 != state.twin // 3]


def require_twins(mesh: Polyhedron) -> None:
    halfedges = np.arange(len(mesh.tail))
    assert (mesh.twin[mesh.twin] == halfedges).all()
    assert (mesh.twin != halfedges).all()
    start = np.where(mesh.same, mesh.tail[mesh.twin], mesh.head[mesh.twin])
    assert (start == mesh.tail).all()


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_flips_keep_the_surface_and_can_be_undone(name: str, seed: int) -> None:
    """A cocycle of random isometries (frames at the vertices) is carried back to the edges of the first mesh."""
    mesh, rng = mesh_of(name), np.random.default_rng(seed)
    state = Flippable(mesh, mesh.edge_lengths)
    state.make_delaunay(flat=True)
    state = state.scaled(rng.normal(size=len(mesh.vertices)))
    flipped = state.mesh()
    require_twins(flipped)
    assert surface_type(flipped) == surface_type(mesh)
    assert opposite_cosines(state).min() > -1e-9
    np.testing.assert_allclose(state.x, state.x[state.twin], rtol=1e-14)
    frames = np.linalg.qr(rng.normal(size=(len(mesh.vertices), 3, 3)))[0]

    def steps(a: NDArray[np.intp], b: NDArray[np.intp]) -> NDArray[np.float64]:
        return np.swapaxes(frames[a], 1, 2) @ frames[b]

    back = state.undone(steps(flipped.tail, flipped.head), steps(flipped.head, flipped.tail))
    np.testing.assert_allclose(back, steps(mesh.tail, mesh.head), atol=1e-11)


def test_flat_flips_of_a_planar_grid_give_true_distances() -> None:
    """On a doubled flat square every edge keeps the length of the straight line between its ends."""
    rng = np.random.default_rng(3)
    n = 8
    grid = np.stack(np.meshgrid(np.arange(n), np.arange(n), indexing="ij"), axis=-1).reshape(-1, 2).astype(float)
    inner = ((grid > 0) & (grid < n - 1)).all(axis=1)
    grid[inner] += rng.uniform(-0.45, 0.45, (inner.sum(), 2))
    cell = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()[:, None]
    front = np.concatenate([cell + np.array([0, n, n + 1]), cell + np.array([0, n + 1, 1])])
    number = np.arange(n * n)
    number[inner] += n * n
    back = number[front][:, ::-1]
    used, index = np.unique(np.concatenate([front, back]), return_inverse=True)
    points = np.concatenate([grid, grid])[used]
    mesh = Polyhedron.from_faces(np.column_stack([points, np.zeros(len(points))]), index.reshape(-1, 3))
    state = Flippable(mesh, mesh.edge_lengths)
    state.make_delaunay(flat=True)
    assert len(state.log) > 0
    head = np.roll(state.triangles, -1, axis=1).ravel()
    # Near the fold an edge may well run over it.
    inside = ((grid > 1.5) & (grid < n - 2.5)).all(axis=1)[used % (n * n)]
    sheet = used >= n * n
    kept = inside[state.tail] & inside[head] & (sheet[state.tail] == sheet[head])
    straight = np.linalg.norm(points[state.tail] - points[head], axis=1)
    np.testing.assert_allclose(state.x[kept], straight[kept], rtol=1e-12)


@pytest.mark.parametrize("flat", [False, True])
def test_flip_in_a_cyclic_quadrilateral_gives_its_other_diagonal(flat: bool) -> None:
    """Points on a circle: Ptolemy's relation is the flat diagonal, so that both kinds of flips agree."""
    angle = np.array([0.0, 0.7, 2.0, 4.0])
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(4)])
    faces = np.array([[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    state = Flippable(Polyhedron.from_faces(np.vstack([ring, [0.0, 0.0, 1.0]]), faces), np.zeros(18))
    pyramid = state.mesh()
    state.x = pyramid.edge_lengths
    _flip(state.tail, state.twin, state.same, state.x, 0, flat)
    require_twins(state.mesh())
    assert {int(state.mesh().tail[0]), int(state.mesh().head[0])} == {1, 3}
    assert state.x[0] == pytest.approx(np.linalg.norm(ring[1] - ring[3]), rel=1e-14)


@pytest.mark.parametrize("flat", [1e-6, 1e-12, 1e-200])
def test_flips_of_triangles_without_height_end(flat: float) -> None:
    """They end with a triangulation or with a clear error, and never go on for ever; all are bounded by the limit."""
    mesh = mesh_of("double torus", 3)
    mesh = mesh.with_vertices(mesh.vertices * np.array([flat, 1.0, 1.0]))
    state = Flippable(mesh, mesh.edge_lengths)
    with contextlib.suppress(MapError):
        state.make_delaunay(flat=True)
        for _ in range(20):
            state = state.scaled(np.random.default_rng(5).normal(size=len(mesh.vertices)) * 20)
    require_twins(state.mesh())
    assert surface_type(state.mesh()) == surface_type(mesh)
