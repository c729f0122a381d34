"""What meshes are taken for."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import grid, round_sphere

from orbiframe.fitting.meaning import meaning_of
from orbiframe.meshes.bending import bending
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.polyhedra import reference_polyhedra


def torus(along: int, across: int) -> Polyhedron:
    def place(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        ring = 3 + np.cos(v)
        return np.stack([ring * np.cos(u), ring * np.sin(u), np.sin(v)], axis=1)

    return triangulated(grid(along, across, place))


def test_smooth_shapes_and_boxes() -> None:
    assert meaning_of(torus(24, 12), "auto", 1000).name == "smooth"
    assert meaning_of(round_sphere(), "auto", 1000).name == "smooth"
    box = meaning_of(triangulated(reference_polyhedra()["cube"]), "auto", 1000)
    assert (box.name, box.bend_share) == ("facets", 1.0)
    assert "100 % of its bending" in box.reason


def test_what_is_asked_for_wins() -> None:
    assert meaning_of(torus(24, 12), "facets", 1000) == ("facets", 0.0, "as asked")


@pytest.mark.parametrize(("size", "name"), [(1000, "semi-smooth"), (100, "facets")])
def test_between_the_number_of_functions_decides(size: int, name: str) -> None:
    """A closed cylinder: a round wall, bent by 15 degrees at 24 edges, and two sharp rims."""
    angle = 2 * np.pi * np.arange(24) / 24
    heights = np.linspace(0, 9, 8)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    vertices = np.concatenate([np.column_stack([ring, np.full(24, h)]) for h in heights])
    wall = [
        [24 * k + i, 24 * k + (i + 1) % 24, 24 * (k + 1) + (i + 1) % 24, 24 * (k + 1) + i]
        for k in range(7)
        for i in range(24)
    ]
    mesh = Polyhedron.from_faces(vertices, [*wall, list(range(24))[::-1], list(range(168, 192))])
    found = meaning_of(triangulated(mesh), "auto", size)
    rims, wall_bends = 2 * 2 * np.pi * np.pi / 2, 9 * 2 * np.pi
    assert found.bend_share == pytest.approx(rims / (rims + wall_bends), rel=0.02)
    assert found.name == name


def test_beside_creases_other_sharp_edges_bend_no_facets() -> None:
    cube = triangulated(reference_polyhedra()["cube"])
    sharp = bending(cube).angle > 1
    one = np.flatnonzero(sharp)[0]
    marked = np.zeros(len(sharp), dtype=bool)
    marked[[one, cube.twin[one]]] = True
    found = meaning_of(cube, "auto", 1000, marked)
    assert found.name == "facets"
    assert "8 % of its bending lies in creases, and 100 % of the rest" in found.reason
    assert meaning_of(cube, "auto", 1000, sharp).name == "facets"
    # What bends little beside creases is curved.
    round_, none = torus(24, 12), np.zeros(3 * torus(24, 12).face_count, dtype=bool)
    assert meaning_of(round_, "auto", 1000, none).name == "semi-smooth"
