"""The double cover: twice of everything, orientable, and the sheets are exchanged without fixed points."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_parametrizers.double_cover import double_cover
from reference_meshes import connected_sum, dataset, grid, reference, shuffled

from orbiframe import surface_type
from orbiframe.meshes.defects import require_closed_surface


def check(mesh):
    cover = double_cover(mesh)
    above, below = require_closed_surface(cover.polyhedron), surface_type(mesh)
    assert len(cover.polyhedron.vertices) == 2 * len(mesh.vertices)
    assert cover.polyhedron.edge_count == 2 * mesh.edge_count
    assert cover.polyhedron.face_count == 2 * mesh.face_count
    assert above.euler_characteristic == 2 * below.euler_characteristic
    assert above.orientable
    assert not cover.polyhedron.same.any()
    everyone = np.arange(2 * len(mesh.vertices))
    assert np.array_equal(cover.mate[cover.mate], everyone)
    assert (cover.mate != everyone).all()
    assert np.array_equal(cover.below[cover.mate], cover.below)
    assert np.array_equal(np.bincount(cover.below), np.full(len(mesh.vertices), 2))
    assert np.array_equal(cover.below[cover.chosen], np.arange(len(mesh.vertices)))
    assert np.array_equal(cover.polyhedron.vertices, mesh.vertices[cover.below])
    assert np.array_equal(cover.below[cover.tail], mesh.tail)
    assert np.array_equal(cover.below[cover.head], mesh.head)
    return above


@pytest.mark.parametrize(
    ("mesh", "genus"),
    [
        (reference("projective plane"), 0),
        (reference("projective plane", 3), 0),
        (dataset("projective_plane"), 0),
        (grid(5, 6, twisted=True), 1),
        (dataset("three_crosscaps"), 2),
        (connected_sum("PPPP"), 3),
    ],
)
def test_of_known_surfaces(mesh, genus):
    assert check(mesh).genus == genus


@settings(max_examples=20, deadline=None)
@given(st.text("TP", max_size=4).map(lambda text: text + "P"), st.integers(0, 30), st.integers(0, 2**32 - 1))
def test_of_random_surfaces(parts, moves, seed):
    check(shuffled(connected_sum(parts), moves, np.random.default_rng(seed)))


def test_faces_of_mates_run_the_other_way():
    mesh = dataset("projective_plane")
    cover = double_cover(mesh)
    triangles = {tuple(np.roll(face, -face.argmin())) for face in cover.polyhedron.triangles}
    mates = {tuple(np.roll(face[::-1], -face[::-1].argmin())) for face in cover.mate[cover.polyhedron.triangles]}
    assert triangles == mates
