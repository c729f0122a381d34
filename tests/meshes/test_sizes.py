"""Area, volume, lengths and valences against closed forms and integrals."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from random_polyhedra import edges_of, face_lists, random_polyhedra

from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.orientation import reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import area, edge_lengths, needles, notes, signed_volume, valences
from orbiframe.testing.polyhedra import reference_polyhedra

MESHES = reference_polyhedra()
SHORT = 5 / math.tan(math.pi / 5) / 4 * (2 * math.sin(math.pi / 5)) ** 2


@pytest.mark.parametrize(
    ("name", "surface", "volume"),
    [
        # Closed forms: edge 2 sqrt 2; unit cube; regular pentagon in the unit circle, height 1.5; 13 unit cubes.
        ("tetrahedron", math.sqrt(3) * 8, 8 / 3),
        ("cube", 6, 1),
        ("prism", 2 * SHORT + 5 * 1.5 * 2 * math.sin(math.pi / 5), 1.5 * SHORT),
        ("double torus", 2 * 13 + 24, 13),
    ],
)
def test_area_and_volume_of_known_solids(name: str, surface: float, volume: float) -> None:
    assert area(MESHES[name]) == pytest.approx(surface, rel=1e-14)
    assert signed_volume(MESHES[name]) == pytest.approx(volume, rel=1e-14)
    inward = reversed_faces(MESHES[name], np.ones(MESHES[name].face_count, dtype=bool))
    assert signed_volume(inward) == pytest.approx(-volume, rel=1e-14)


@settings(max_examples=20, deadline=None)
@given(random_polyhedra())
def test_area_and_volume_are_those_of_the_triangles(mesh: Polyhedron) -> None:
    """Of triangles both have closed forms; oriented by majority, so up to the sign of a tie."""
    triangles = triangulated(mesh)
    p = triangles.vertices[triangles.triangles]
    doubled = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1)
    assert area(triangles) == pytest.approx(doubled.sum() / 2, rel=1e-12)
    if signed_volume(mesh) is not None and not triangles.same.any():
        assert abs(signed_volume(triangles)) == pytest.approx(abs(np.linalg.det(p).sum()) / 6, abs=1e-12, rel=1e-9)


def test_an_offset_costs_no_volume() -> None:
    cube = MESHES["cube"]
    assert signed_volume(cube.with_vertices(cube.vertices + 1e9)) == pytest.approx(1, rel=1e-14)


def test_a_cavity_is_taken_off_the_volume() -> None:
    cube = MESHES["cube"]
    inner = [[c + 8 for c in face[::-1]] for face in face_lists(cube)]
    both = Polyhedron.from_faces(np.vstack([3 * cube.vertices, cube.vertices + 1]), face_lists(cube) + inner)
    assert signed_volume(both) == pytest.approx(26)


@pytest.mark.parametrize("name", ["projective plane", "Klein bottle"])
def test_what_has_no_inside_has_no_volume(name: str) -> None:
    assert signed_volume(MESHES[name]) is None
    open_cube = Polyhedron.from_faces(MESHES["cube"].vertices, face_lists(MESHES["cube"])[1:])
    assert signed_volume(open_cube) is None


@settings(max_examples=20, deadline=None)
@given(random_polyhedra())
def test_lengths_and_valences_count_each_edge_once(mesh: Polyhedron) -> None:
    ends = np.array(sorted(edges_of(face_lists(mesh))))
    lengths = np.linalg.norm(mesh.vertices[ends[:, 0]] - mesh.vertices[ends[:, 1]], axis=1)
    np.testing.assert_allclose(np.sort(edge_lengths(mesh)), np.sort(lengths), rtol=1e-14)
    np.testing.assert_array_equal(valences(mesh), np.bincount(ends.ravel()))


@pytest.mark.parametrize(("height", "thin"), [(1e-3, []), (1.1e-4, []), (0.9e-4, [0]), (1e-5, [0]), (0.0, [])])
def test_needles_are_thin_but_have_an_area(height: float, thin: list[int]) -> None:
    mesh = Polyhedron.from_faces(
        [[0, 0, 0], [1, 0, 0], [0.5, height, 0], [0.5, 1, 0]], [[0, 1, 2], [1, 3, 2], [3, 0, 2]]
    )
    assert needles(mesh).tolist() == thin
    assert [note.kind for note in notes(mesh)] == ["needles"] * len(thin)


def kinds(vertices: np.ndarray) -> list[str]:
    return [note.kind for note in notes(MESHES["cube"].with_vertices(vertices))]


def test_extreme_sizes_and_offsets_are_noted() -> None:
    cube = MESHES["cube"].vertices
    assert kinds(cube) == kinds(cube * 1e90) == kinds(cube * 1e-90) == kinds(cube + 1000) == []
    assert kinds(cube * 1e150) == kinds(cube * 1e-150) == kinds(cube * 1.7e308) == ["extreme coordinates"]
    assert kinds(cube + 1e9) == ["far from the origin"]
    assert notes(MESHES["cube"].with_vertices(cube + 1e9))[0].where.endswith("6 digits are left")


@settings(max_examples=30, deadline=None)
@given(st.floats(-280, 280))
def test_measures_scale(exponent: float) -> None:
    scale, prism = 10.0**exponent, MESHES["prism"]
    scaled = prism.with_vertices(prism.vertices * scale)
    assert edge_lengths(scaled) == pytest.approx(edge_lengths(prism) * scale, rel=1e-9)
    if abs(exponent) < 95:
        assert area(scaled) == pytest.approx(area(prism) * scale**2, rel=1e-9)
        assert signed_volume(scaled) == pytest.approx(signed_volume(prism) * scale**3, rel=1e-9)
