"""Bends that a round shape of few edges has, told from sharp edges."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import grid

from orbiframe.meshes import even_bends
from orbiframe.meshes.bending import bending
from orbiframe.meshes.even_bends import even_share, widths
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.polyhedron import Polyhedron


def tube(across: int, along: int = 12) -> Polyhedron:
    """A torus with so many edges about its tube."""

    def place(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        ring = 3 + np.cos(v)
        return np.stack([ring * np.cos(u), ring * np.sin(u), np.sin(v)], axis=1)

    return triangulated(grid(along, across, place))


def prism(sides: np.ndarray, height: float) -> Polyhedron:
    """A prism over an octagon whose sides have these lengths, in turn, and directions that differ by 45 degrees."""
    turn = np.arange(8) * np.pi / 4
    corners = np.cumsum(sides[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1), axis=0)
    vertices = np.concatenate([np.column_stack([corners, np.full(8, z)]) for z in (0.0, height)])
    wall = [[i, (i + 1) % 8, 8 + (i + 1) % 8, 8 + i] for i in range(8)]
    return triangulated(Polyhedron.from_faces(vertices, [*wall, list(range(8))[::-1], list(range(8, 16))]))


def test_few_edges_about_a_tube_are_no_sharp_ones() -> None:
    assert bending(tube(8)).share > 0.7
    assert even_share(tube(8)) == 0
    assert bending(tube(6)).share == pytest.approx(even_share(tube(6)))  # 60 degrees are sharp


def test_a_chamfer_is_sharp_and_an_even_octagon_is_not() -> None:
    rims = 8 * 2 * np.pi / 2
    even = prism(np.ones(8), 2.0)
    assert even_share(even) == pytest.approx(rims / (rims + 2 * 2 * np.pi))
    chamfered = prism(np.tile([1.0, 0.2], 4), 2.0)
    assert even_share(chamfered) == pytest.approx(bending(chamfered).share) == pytest.approx(1.0)


def test_widths_reach_over_flats_of_many_triangles() -> None:
    mesh = prism(np.tile([1.0, 0.25], 4), 3.0)
    angle = bending(mesh).angle
    upright = np.flatnonzero((angle > np.radians(40)) & (angle < np.radians(50)))
    found = widths(mesh, angle, upright)
    assert np.sort(found) == pytest.approx(np.repeat([0.25, 1.0], 8))


def test_only_the_rim_of_a_flat_is_looked_at(monkeypatch) -> None:
    n = 24
    x, y = (each.ravel() for each in np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij"))
    wider = np.stack([each + np.where(each == 0, -1, 0) + np.where(each == n, 1, 0) for each in (x, y)])
    vertices = np.concatenate([np.stack([x, y, 1 + 0 * x], axis=1), np.stack([*wider, 0 * x], axis=1)])
    corner = np.arange(n)[:, None] * (n + 1) + np.arange(n)
    top = np.stack([corner, corner + n + 1, corner + n + 2, corner + 1], axis=-1).reshape(-1, 4)
    ring = np.array([*range(0, n * (n + 1), n + 1), *range(n * (n + 1), (n + 1) ** 2 - 1)])
    ring = np.concatenate([ring, (n + 1) ** 2 - 1 - ring])
    skirt = np.stack([np.roll(ring, -1), ring, ring + len(x), np.roll(ring, -1) + len(x)], axis=1)
    frustum = triangulated(Polyhedron.from_faces(vertices, np.concatenate([top, top[:, ::-1] + len(x), skirt])))
    looked_at = []
    reach = even_bends._reach
    monkeypatch.setattr(
        even_bends, "_reach", lambda mesh, edge, faces: looked_at.append(len(faces)) or reach(mesh, edge, faces)
    )
    assert even_share(frustum) == pytest.approx(1)
    assert len(looked_at) == 4 * 4 * n  # edges by their halfedges, on both sides
    assert max(looked_at) <= 8 * n
    # As far as all corners of the flat reach.
    angle = bending(frustum).angle
    sharp = np.flatnonzero((angle > np.radians(40)) & (angle < np.radians(50)))
    lying = sharp[frustum.vertices[frustum.triangles[frustum.face[sharp]]][:, :, 2].min(axis=1) == 1]
    np.testing.assert_allclose(widths(frustum, angle, lying), n)
