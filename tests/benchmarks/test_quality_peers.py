"""Subdivision against libraries, limits and polynomials; fitted Loop surfaces; measured normals and curvature."""

from __future__ import annotations

import igl
import numpy as np
import pytest
from quality import charts, measures, peers, subdivision
from quality.foot_points import foot_points
from quality.shapes import SHAPES
from quality.skins import Skin, measured_skin

pytestmark = pytest.mark.long

SHAPE = {shape.name: shape for shape in SHAPES}
TETRAHEDRON = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3.0]])


def ordered(points):
    return np.array(sorted(np.round(points, 9).tolist()))


def subdivided(scheme, points, faces, steps):
    for _ in range(steps):
        step = scheme(faces, len(points))
        points, faces = step.matrix @ points, step.faces
    return points, faces


def test_loop_is_that_of_libigl_where_valences_are_3_and_6():
    # For other valences libigl takes the weights of Warren.
    ours, _ = subdivided(subdivision.loop, CORNERS, TETRAHEDRON, 3)
    theirs, _ = igl.loop(CORNERS, TETRAHEDRON, 3)
    assert ordered(ours) == pytest.approx(ordered(theirs), abs=1e-9)


def test_catmull_clark_on_a_grid_is_the_subdivision_of_cubic_b_splines():
    grid = charts.wound(charts.torus, 6, 5)
    fine, _ = subdivided(subdivision.catmull_clark, grid.vertices, grid.tail.reshape(-1, 4), 1)
    around, across = (twice(n) for n in (6, 5))
    expected = np.einsum("ai,bj,ijk->abk", around, across, grid.vertices.reshape(6, 5, 3)).reshape(-1, 3)
    assert ordered(fine) == pytest.approx(ordered(expected), abs=1e-8)


def twice(n):
    """Uniform cubic B-splines on a circle, their knots halved: (1, 6, 1)/8 and (4, 4)/8."""
    matrix = np.zeros((2 * n, n))
    for k in range(n):
        for step, old, fresh in ((-1, 1, 0), (0, 6, 4), (1, 1, 4)):
            matrix[2 * k, (k + step) % n] += old / 8
            matrix[2 * k + 1, (k + step) % n] += fresh / 8
    return matrix


@pytest.mark.parametrize("n", [3, 5, 8])
def test_the_eigenvalues_about_a_vertex_are_those_that_are_known(n):
    # Loop: 3/8 + cos(2 pi/n)/4; Catmull and Clark: Ball and Storry 1988.
    a, b = 1 + np.arange(n), n + 1 + np.arange(n)
    after = np.roll(a, -1)
    pyramids = np.concatenate([np.stack([0 * a, a, after], axis=1), np.stack([0 * a + n + 1, after, a], axis=1)])
    spokes = np.flatnonzero((subdivision.edges_of(pyramids).ends == 0).any(axis=1))
    found = leading(subdivision.loop(pyramids, n + 2), [0, *(n + 2 + spokes)])
    assert found == pytest.approx([1, *[3 / 8 + np.cos(2 * np.pi / n) / 4] * 2])
    kites = np.stack([0 * a, a, b, after], axis=1)
    kites = np.concatenate([kites, np.stack([0 * a + 2 * n + 1, np.roll(b, -1), after, b], axis=1)])
    edges = subdivision.edges_of(kites).ends
    spokes = np.flatnonzero((edges == 0).any(axis=1))
    ring = [0, *(2 * n + 2 + spokes), *(2 * n + 2 + len(edges) + np.arange(n))]
    c = np.cos(2 * np.pi / n)
    expected = (5 + c + np.cos(np.pi / n) * np.sqrt(2 * (9 + c))) / 16
    assert leading(subdivision.catmull_clark(kites, 2 * n + 2), ring) == pytest.approx([1, expected, expected])


def leading(step, ring):
    """The three largest eigenvalues of the matrix from a vertex and its ring to the same after a step."""
    return np.sort(np.linalg.eigvals(step.matrix.toarray()[ring][:, : len(ring)]).real)[[-1, -2, -3]]


def test_catmull_clark_of_polygons_is_the_scheme_on_quadrilaterals():
    faces = charts.wound(charts.torus, 5, 4).tail.reshape(-1, 4)
    alike = subdivision.catmull_clark_of_polygons(faces.ravel(), np.full(20, 4), 20)
    assert (alike.faces == subdivision.catmull_clark(faces, 20).faces).all()
    mixed = subdivision.catmull_clark_of_polygons(np.array([0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2]), np.full(4, 3), 4)
    assert mixed.matrix.sum(axis=1) == pytest.approx(1)
    assert len(mixed.faces) == 12


@pytest.mark.parametrize(
    ("scheme", "limit", "mesh", "corners"),
    [
        (subdivision.loop, subdivision.loop_limit, lambda: charts.scattered_torus(60), 3),
        (subdivision.catmull_clark, subdivision.catmull_clark_limit, lambda: SHAPE["stairs"].mesh(), 4),
    ],
    ids=["Loop", "Catmull and Clark"],
)
def test_limits_are_the_same_from_every_level_and_near_what_subdivision_makes(scheme, limit, mesh, corners):
    faces, count = mesh().tail.reshape(-1, corners), len(mesh().vertices)
    points = np.random.default_rng(0).normal(size=(count, 3))
    first = limit(faces, count) @ points
    fine, finer = subdivided(scheme, points, faces, 4)
    assert (limit(finer, len(fine)) @ fine)[:count] == pytest.approx(first, abs=1e-12)
    assert fine[:count] == pytest.approx(first, abs=0.02)


def test_butterfly_keeps_vertices_and_reproduces_cubics_on_regular_triangles():
    grid = charts.wound(charts.torus, 12, 12)
    faces = grid.tail.reshape(-1, 4)
    faces = np.concatenate([faces[:, :3], faces[:, [0, 2, 3]]])
    step = subdivision.butterfly(faces, 144)
    assert (step.matrix[:144] - np.eye(144) == 0).all()
    i, j = np.divmod(np.arange(144), 12)
    inner = np.flatnonzero(
        np.array([(abs(i[r] - 5.5) < 4).all() and (abs(j[r] - 5.5) < 4).all() for r in ends_of(step)])
    )
    assert len(inner) > 50
    for a, b in ((1, 0), (1, 1), (2, 1), (3, 0), (0, 3)):
        value = step.matrix @ ((i - 5.0) ** a * (j - 5.0) ** b)
        middle = np.array([[i[r].mean(), j[r].mean()] for r in edge_ends(step)])[inner]
        expected = (middle[:, 0] - 5) ** a * (middle[:, 1] - 5) ** b
        assert value[144:][inner] == pytest.approx(expected, abs=1e-9)


def ends_of(step):
    """The vertices that each new vertex depends on."""
    rows = step.matrix[144:]
    return [rows.indices[rows.indptr[k] : rows.indptr[k + 1]] for k in range(rows.shape[0])]


def edge_ends(step):
    """The two vertices of largest weight."""
    rows = step.matrix[144:]
    parts = [slice(rows.indptr[k], rows.indptr[k + 1]) for k in range(rows.shape[0])]
    return [rows.indices[p][np.argsort(rows.data[p])[-2:]] for p in parts]


@pytest.mark.parametrize("valence", [3, 4, 5, 7, 9])
def test_the_modified_rule_reproduces_what_is_linear_and_the_first_waves_of_a_ring(valence):
    weights = subdivision._spokes(valence)
    angle = 2 * np.pi * np.arange(valence) / valence
    assert weights.sum() == pytest.approx(1 / 4)
    assert weights @ np.cos(angle) == pytest.approx(1 / 2)
    assert weights @ np.sin(angle) == pytest.approx(0, abs=1e-12)
    if valence >= 5:
        assert weights @ np.cos(2 * angle) == pytest.approx(1 / 4)


def test_measured_normals_and_curvature_on_a_torus():
    skin, feet = torus_skin(240, 96)
    measured = measured_skin(skin.vertices, skin.triangles)
    assert np.abs(measured.gaussian - feet.gaussian).max() < 0.01 * np.abs(feet.gaussian).max()
    assert np.abs((measured.normals * feet.normals).sum(axis=1)).min() > np.cos(np.radians(0.05))


def torus_skin(around, across):
    mesh = peers.triangulated(charts.wound(charts.torus, around, across))
    feet = charts.TORUS.feet(mesh.vertices)
    return Skin(mesh.vertices, mesh.triangles, feet.normals, feet.gaussian), feet


def test_foot_points_are_of_a_higher_order_than_the_triangles():
    x = charts.TORUS.points(np.random.default_rng(1).uniform(0, 6, (2000, 2)))
    lifted, flat = [], []
    for k in (1, 2):
        skin, _ = torus_skin(48 * k, 24 * k)
        foot = foot_points(skin, x)
        away = charts.TORUS.feet(foot.points).points - foot.points
        lifted.append(np.linalg.norm(away, axis=1).max())
        flat.append(np.sqrt(igl.point_mesh_squared_distance(x, skin.vertices, skin.triangles)[0].max()))
    assert flat[0] / flat[1] < 5
    assert lifted[0] / lifted[1] > 7
    assert lifted[1] < flat[1] / 50


@pytest.mark.parametrize(
    ("name", "rms"),
    [("torus 24 x 12, triangles", 3e-5), ("plate, genus 4", 2e-3)],
    ids=["vertices meant", "faces meant"],
)
def test_a_fitted_loop_surface_is_near(name, rms):
    shape = SHAPE[name]
    mesh = shape.mesh()
    task = peers.Task(mesh, shape.meant)
    fitted = measures.errors(peers.skin(peers.loop_fit(task)), mesh, shape.truth)
    plain = measures.errors(peers.skin(peers.loop(task)), mesh, shape.truth)
    assert fitted.rms < rms
    assert fitted.rms < plain.rms / 5


def test_one_sided_surfaces_are_refused_by_those_who_need_sides():
    task = peers.Task(charts.boy_mesh(2), "smooth")
    for method in (peers.ls3, peers.poisson):
        with pytest.raises(peers.Refused, match="one side"):
            method(task)
