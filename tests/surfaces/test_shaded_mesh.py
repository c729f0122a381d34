"""Pictures made of points: the outline, what is in front, and the file, against what must be seen."""

from __future__ import annotations

import numpy as np
import pytest

from orbiframe import GeometryError, Polyhedron, UsageError
from orbiframe.meshes import refine
from orbiframe.surfaces.places_in_triangles import require_places
from orbiframe.surfaces.shaded_mesh import shaded_picture
from orbiframe.testing.polyhedra import reference_polyhedra
from orbiframe.testing.reference import reference_surface

ABOVE = (0.0, 0.0, 1.0)


def ball() -> Polyhedron:
    fine = refine(reference_polyhedra()["tetrahedron"], 24).polyhedron
    points = fine.vertices - fine.vertices.mean(axis=0)
    return fine.with_vertices(points / np.linalg.norm(points, axis=1, keepdims=True))


def test_a_ball_covers_a_disc():
    pixels = shaded_picture(ball(), width=200).pixels
    radius = 0.47 * 200  # a margin of three per cent on both sides
    assert pixels[..., 3].sum() / 255 == pytest.approx(np.pi * radius**2, rel=0.01)


def test_there_is_no_hole_between_the_points():
    pixels = shaded_picture(ball(), width=150).pixels
    y, x = np.indices(pixels.shape[:2]) + 0.5
    inside = np.hypot(x - 75, y - pixels.shape[0] / 2) < 0.46 * 150
    assert (pixels[..., 3][inside] == 255).all()


def test_what_is_in_front_hides_what_is_behind():
    """A square in a plane that is turned away from the light, before or behind one that faces it."""
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float)
    slope = np.array([[0.3, 0, 0.3], [0, 0.3, -0.3], [0, 0, 1.0]])
    seen = []
    for height in (2.0, -2.0):
        steep = square @ slope + np.array([0, 0, height])
        mesh = Polyhedron.from_faces(np.concatenate([square, steep]), [[0, 1, 2, 3], [4, 5, 6, 7]])
        pixels = shaded_picture(mesh, width=100, view=ABOVE).pixels
        seen.append((pixels[50, 50, :3].tolist(), pixels[10, 10, :3].tolist()))
    (front, back), (hidden, other) = seen
    assert hidden == other == back
    assert front != back


def test_the_file_holds_the_pixels(tmp_path):
    image = pytest.importorskip("matplotlib.image")
    picture = shaded_picture(ball(), width=60)
    picture.save(tmp_path / "ball.png")
    assert np.array_equal(np.rint(image.imread(tmp_path / "ball.png") * 255), picture.pixels)
    assert [path.name for path in tmp_path.iterdir()] == ["ball.png"]


def test_the_same_mesh_gives_the_same_bytes():
    assert shaded_picture(ball(), width=60).png == shaded_picture(ball(), width=60).png


@pytest.mark.parametrize("wrong", [{"width": 0}, {"width": 5000}, {"view": (0, 0, 0)}, {"view": (1, 2)}])
def test_what_cannot_be_drawn_is_refused(wrong):
    with pytest.raises(UsageError):
        shaded_picture(ball(), **wrong)


# ---- places on a surface -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("face", "barycentric", "said"),
    [
        ([3], [[1, 0, 0]], "place 0 lies in triangle 3; the triangles are 0 to 2"),
        ([0, -1], [[1, 0, 0]] * 2, "place 1 lies in triangle -1"),
        ([0], [[0.5, 0.4, 0.0]], r"place 0 has the barycentric coordinates .* which is 0.9, must be 1"),
        ([0], [[1.5, -0.5, 0.0]], "place 0 has the barycentric coordinates"),
        ([0], [[np.nan, 0.5, 0.5]], "place 0 has the barycentric coordinates"),
        ([0.0], [[1, 0, 0]], "triangles are numbers of float64; they must be whole"),
        ([0], [[1, 0]], r"they must be \(n,\) and \(n, 3\)"),
        (0, [1, 0, 0], r"they must be \(n,\) and \(n, 3\)"),
    ],
)
def test_wrong_places_are_refused(face, barycentric, said):
    with pytest.raises(GeometryError, match=said):
        require_places(face, barycentric, 3)


def test_right_places_are_taken():
    faces, weights = require_places([0, 2], [[1, 0, 0], [0.1 + 0.2, 0.7, 0]], 3)
    assert faces.dtype == np.intp
    assert weights.shape == (2, 3)
    assert require_places(np.zeros(0), np.zeros((0, 3)), 3)[0].shape == (0,)


def test_a_surface_refuses_them_too():
    surface = reference_surface("tetrahedron", "ps2")
    with pytest.raises(GeometryError, match="place 0 lies in triangle 999"):
        surface.points([999], [[1, 0, 0]])
