"""Truths: curvature and nearest points against closed forms and the theorem of Gauss and Bonnet."""

from __future__ import annotations

import numpy as np
import pytest
from quality import charts, truths
from quality.shapes import BLOB, ELLIPSOID, SHAPES, TANGLE

from orbiframe import surface_type
from orbiframe.meshes import doubled_edges, triangulated

pytestmark = pytest.mark.long


def total_curvature(level, step):
    """The integral of the Gaussian curvature over a fine mesh on a level set."""
    cut = triangulated(level.net(step))
    area = np.linalg.norm(np.cross(*np.moveaxis(np.diff(cut.vertices[cut.triangles], axis=1), 1, 0)), axis=1) / 2
    return area @ level.feet(cut.vertices).gaussian[cut.triangles].mean(axis=1)


def total_curvature_of_chart(chart, u, weights):
    """The same by quadrature over parameters."""
    _, first, second = chart._jet(u)
    element = np.linalg.norm(np.cross(first[:, :, 0], first[:, :, 1]), axis=1)
    return (weights * element) @ truths._shape(first, second)[1]


def square(count):
    u = (np.indices((count, count)).reshape(2, -1).T + 0.5) * 2 * np.pi / count
    return u, np.full(len(u), (2 * np.pi / count) ** 2)


def disc(count):
    x, w = np.polynomial.legendre.leggauss(count)
    radius, angle = (x + 1) / 2, np.arange(2 * count) * np.pi / count
    u = (radius[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)).reshape(-1, 2)
    return u, np.repeat(w / 2 * radius * np.pi / count, 2 * count)


def test_the_torus_has_the_curvature_of_its_closed_form_and_so_has_its_level_set():
    u = np.random.default_rng(3).uniform(0, 2 * np.pi, (500, 2))
    points = charts.TORUS.points(u)
    feet = charts.TORUS.feet(points)
    assert feet.points == pytest.approx(points, abs=1e-12)
    assert feet.gaussian == pytest.approx(np.cos(u[:, 1]) / (3 + np.cos(u[:, 1])), abs=1e-12)


def test_the_ellipsoid_has_the_curvature_of_its_closed_form():
    axes = np.array([1, 0.7, 0.5])
    x = np.random.default_rng(4).normal(size=(500, 3))
    x *= axes / np.linalg.norm(x, axis=1, keepdims=True)
    expected = 1 / (np.prod(axes) ** 2 * ((x / axes**2) ** 2).sum(axis=1) ** 2)
    feet = ELLIPSOID.feet(x)
    assert feet.gaussian == pytest.approx(expected, rel=1e-10)
    assert np.abs((feet.normals * (x / axes**2)).sum(axis=1)) == pytest.approx(np.linalg.norm(x / axes**2, axis=1))


@pytest.mark.parametrize("truth", [ELLIPSOID, charts.TORUS])
def test_from_a_point_beside_it_the_nearest_point_is_found_again(truth):
    start = truth.feet(truth.samples[::97])
    beside = start.points + 0.03 * start.normals
    assert truth.feet(beside).points == pytest.approx(start.points, abs=1e-9)


@pytest.mark.parametrize(("level", "step", "characteristic"), [(TANGLE, 0.1, -8), (BLOB, 0.08, 2)])
def test_the_total_curvature_of_a_level_set_is_that_of_gauss_and_bonnet(level, step, characteristic):
    assert total_curvature(level, step) == pytest.approx(2 * np.pi * characteristic, rel=0.02)


@pytest.mark.parametrize(
    ("chart", "grid", "characteristic"),
    [(charts.BOY, disc(60), 1), (charts.FIGURE_EIGHT, square(60), 0), (charts.LAWSON, square(60), 0)],
)
def test_the_total_curvature_of_a_chart_is_that_of_gauss_and_bonnet(chart, grid, characteristic):
    assert total_curvature_of_chart(chart, *grid) == pytest.approx(2 * np.pi * characteristic, abs=1e-3)


def test_every_shape_made_here_is_closed_and_has_a_name_of_its_own():
    names = [shape.name for shape in SHAPES]
    assert len(set(names)) == len(names) >= 40
    for name in (
        "torus 288 irregular",
        "genus 2, 600 irregular",
        "plate, genus 4",
        "stairs",
    ):
        mesh = SHAPES[names.index(name)].mesh()
        kind = surface_type(mesh)
        assert kind.components == 1
        assert kind.orientable
        assert not doubled_edges(triangulated(mesh)).any()
