"""Blocks of quads: the steps of a subdivision taken back."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import DATASETS, grid
from hypothesis import given, settings, strategies as st

from orbiframe import Polyhedron, read
from orbiframe.meshes import blocks_near
from orbiframe.meshes.quad_blocks import coarser


def subdivided(mesh: Polyhedron) -> np.ndarray:
    """The quads of Catmull and Clark about corners: vertex, middle of an edge, of the face, and of the other edge."""
    vertices, edges = len(mesh.vertices), mesh.edge_count
    before = mesh.offsets[mesh.face] + (np.arange(len(mesh.tail)) - mesh.offsets[mesh.face] - 1) % 4
    middles = vertices + mesh.edge
    return np.stack([mesh.tail, middles, vertices + edges + mesh.face, middles[before]], axis=1)


def cyclic(quads: np.ndarray) -> set[tuple[int, ...]]:
    """The quads, whichever corner is the first and whichever way they run."""
    return {min(tuple(np.roll(t, k).tolist()) for t in (q, q[::-1]) for k in range(4)) for q in quads}


@pytest.mark.parametrize("name", ["cube", "plate_genus2_coarse", "plate_genus3", "klein_bottle", "plate_genus5"])
def test_a_subdivision_is_taken_back(name):
    mesh = read(DATASETS / f"{name}.off")
    fine = subdivided(mesh)
    found = coarser(fine)
    assert found is not None
    assert cyclic(found) == cyclic(mesh.tail.reshape(-1, 4))
    rng = np.random.default_rng(1)
    number = rng.permutation(int(fine.max()) + 1)
    turned = np.stack([np.roll(q, rng.integers(4)) for q in number[rng.permutation(fine)]])
    back = coarser(turned)
    assert back is not None
    assert len(back) == mesh.face_count


@settings(max_examples=20, deadline=None)
@given(st.integers(3, 9), st.integers(3, 9))
def test_grids_have_blocks_where_both_sides_are_even(along, across):
    torus = grid(along, across, lambda u, v: np.stack([u, v, u], axis=1))
    found = coarser(torus.tail.reshape(-1, 4))
    if along % 2 == 0 and across % 2 == 0:
        assert found is not None
        assert len(found) == along * across // 4
    else:
        assert found is None


def test_the_level_nearest_to_what_is_wanted_is_taken():
    quads = read(DATASETS / "torus.off").tail.reshape(-1, 4)
    found = {wanted: blocks_near(quads, wanted) for wanted in (16, 70, 250, 36, 5)}
    assert {w: None if b is None else len(b) for w, b in found.items()} == {16: 18, 70: 72, 250: 288, 36: None, 5: None}


def test_a_vertex_within_a_block_has_four_quads():
    """A cube's corners have three: its six faces are no block."""
    assert coarser(read(DATASETS / "cube.off").tail.reshape(-1, 4)) is None
