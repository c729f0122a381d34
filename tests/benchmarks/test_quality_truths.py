"""Truths: curvature and nearest points against closed forms and the theorem of Gauss and Bonnet."""

from __future__ import annotations

import numpy as np
import pytest
from quality import charts
from quality.shapes import BLOB, CROSS, ELLIPSOID, PAIR, SHAPES, TANGLE

from orbiframe import surface_type
from orbiframe.meshes import doubled_edges, triangulated

RNG = np.random.default_rng(3)


def total_curvature(mesh, truth):
    """The integral of the truth's Gaussian curvature over a fine mesh on it, by areas about vertices."""
    cut = triangulated(mesh)
    area = np.linalg.norm(np.cross(*np.moveaxis(np.diff(cut.vertices[cut.triangles], axis=1), 1, 0)), axis=1) / 2
    normals = charts_normals(cut, area)
    gaussian = truth.feet(cut.vertices, normals).gaussian
    return area @ gaussian[cut.triangles].mean(axis=1)


def charts_normals(cut, area):
    """Normals of the largest face at every vertex, up to sign."""
    normals = np.zeros(cut.vertices.shape)
    face = np.cross(*np.moveaxis(np.diff(cut.vertices[cut.triangles], axis=1), 1, 0))
    order = np.argsort(area)
    for corner in range(3):
        normals[cut.triangles[order, corner]] = face[order]
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def test_the_torus_has_the_curvature_of_its_closed_form_and_so_has_its_level_set():
    u = RNG.uniform(0, 2 * np.pi, (500, 2))
    points = charts.TORUS.points(u)
    feet = charts.TORUS.feet(points)
    assert feet.points == pytest.approx(points, abs=1e-12)
    assert feet.gaussian == pytest.approx(np.cos(u[:, 1]) / (3 + np.cos(u[:, 1])), abs=1e-12)


def test_the_ellipsoid_has_the_curvature_of_its_closed_form():
    axes = np.array([1, 0.7, 0.5])
    x = RNG.normal(size=(500, 3))
    x *= axes / np.linalg.norm(x, axis=1, keepdims=True)
    expected = 1 / (np.prod(axes) ** 2 * ((x / axes**2) ** 2).sum(axis=1) ** 2)
    feet = ELLIPSOID.feet(x)
    assert feet.gaussian == pytest.approx(expected, rel=1e-10)
    assert np.abs((feet.normals * (x / axes**2)).sum(axis=1)) == pytest.approx(np.linalg.norm(x / axes**2, axis=1))


@pytest.mark.parametrize(
    "truth", [PAIR, ELLIPSOID, charts.TORUS, charts.KNOT], ids=["pair", "ellipsoid", "torus", "knot"]
)
def test_from_a_point_beside_it_the_nearest_point_is_found_again(truth):
    start = truth.feet(truth.samples[::97])
    beside = start.points + 0.03 * start.normals
    assert truth.feet(beside).points == pytest.approx(start.points, abs=1e-9)


@pytest.mark.parametrize(
    ("truth", "mesh"),
    [
        (TANGLE, lambda: TANGLE.net(0.1)),
        (PAIR, lambda: PAIR.net(0.08)),
        (CROSS, lambda: CROSS.net(0.12)),
        (BLOB, lambda: BLOB.net(0.08)),
        (charts.KNOT, lambda: charts.wound(charts.knotted_tube, 240, 30)),
        (charts.BOY, lambda: charts.boy_mesh(24)),
        (charts.FIGURE_EIGHT, lambda: charts.wound(charts.figure_eight_bottle, 120, 80, True)),
        (charts.LAWSON, lambda: charts.wound(charts.lawson_bottle, 96, 96, True)),
    ],
    ids=["tanglecube", "pair", "cross", "blob", "knot", "boy", "figure eight", "lawson"],
)
def test_the_total_curvature_is_that_of_gauss_and_bonnet(truth, mesh):
    made = mesh()
    expected = 2 * np.pi * surface_type(made).euler_characteristic
    assert total_curvature(made, truth) == pytest.approx(expected, abs=0.02 * (4 * np.pi + abs(expected)))


def test_every_shape_made_here_is_closed_and_has_a_name_of_its_own():
    names = [shape.name for shape in SHAPES]
    assert len(set(names)) == len(names) >= 40
    for name in (
        "torus 288 irregular",
        "genus 2, 600 irregular",
        "starfish 1500 irregular",
        "plate, genus 4",
        "stairs",
    ):
        mesh = SHAPES[names.index(name)].mesh()
        kind = surface_type(mesh)
        assert kind.components == 1
        assert kind.orientable
        assert not len(doubled_edges(triangulated(mesh)))
