"""Bends that a round shape of few edges has, told from sharp edges."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import grid

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
