"""Shapes of faces in X: squares, rectangles, rhombs and regular polygons are measured as what they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from reference_meshes import DATASETS, geometry

from orbiframe.components.registry import Registry
from orbiframe.files.gate import read
from orbiframe.meshes.bisection import bisected
from orbiframe.meshes.face_diagonals import outline, triangulated
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.regular_triangles import regular_triangles
from orbiframe.orbifolds.atlas import Atlas
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.testing.polyhedra import reference_polyhedra
from orbiframe.triangulations.face_shapes import FaceShapes, face_shapes
from orbiframe.triangulations.triangulation import Triangulation


def grid_torus(columns: int, rows: int) -> Polyhedron:
    """A torus of columns x rows quadrilaterals, on a torus of revolution."""
    i, j = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
    u, v = 2 * np.pi * i.ravel() / columns, 2 * np.pi * j.ravel() / rows
    points = np.column_stack([(3 + np.cos(v)) * np.cos(u), (3 + np.cos(v)) * np.sin(u), np.sin(v)])
    number = lambda a, b: (a % columns) * rows + b % rows  # noqa: E731
    corners = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]
    return Polyhedron.from_faces(points, np.stack([c.ravel() for c in corners], axis=1))


def flat_map(mesh: Polyhedron, columns: int, rows: int, first: np.ndarray, second: np.ndarray) -> Triangulation:
    """The map of a triangulated grid torus onto the lattice of columns * first and rows * second."""
    place = np.column_stack(np.divmod(np.arange(columns * rows), rows)).astype(float)
    step = place[mesh.head] - place[mesh.tail]
    size = np.array([columns, rows])
    turns = -np.round(step / size).astype(int)
    kinds, kind = np.unique(turns, axis=0, return_inverse=True)
    kinds = np.concatenate([[[0, 0]], kinds])
    isometry = np.tile(np.eye(3), (len(kinds), 1, 1))
    isometry[:, 1:, 0] = (kinds * size) @ np.stack([first, second])
    inverse = np.array([0, *(1 + int(np.flatnonzero((kinds[1:] == -k).all(axis=1))[0]) for k in kinds[1:])])
    ends = np.where(np.arange(len(kinds)) > 0, 0, -1)
    atlas = Atlas(geometry(0), np.array([np.inf]), ends, ends, inverse, isometry)
    area = abs(np.linalg.det([columns * first, rows * second]))
    points = np.column_stack([np.ones(len(place)), place @ np.stack([first, second])])
    zeros = np.zeros(len(place), dtype=np.intp)
    return Triangulation(Orbifold(atlas, 0, True, area), mesh, zeros, points, 1 + kind.ravel())


def measured(first: tuple[float, float], second: tuple[float, float]) -> FaceShapes:
    polyhedron = grid_torus(7, 5)
    refinement = bisected(triangulated(polyhedron), 1e9)
    return face_shapes(polyhedron, refinement, flat_map(refinement.polyhedron, 7, 5, np.array(first), np.array(second)))


@pytest.mark.parametrize(
    ("first", "second", "angle", "adjacent"),
    [
        ((1, 0), (0, 1), 0, 1),
        ((3, 0), (0, 1), 0, 3),
        ((0.5, 0), (0, 2), 0, 4),
        ((1, 0), (np.cos(1.2), np.sin(1.2)), np.pi / 2 - 1.2, 1),
        ((2, 0), (np.cos(2), np.sin(2)), 2 - np.pi / 2, 2),
    ],
)
def test_parallelograms(first, second, angle, adjacent):
    shapes = measured(first, second)
    np.testing.assert_allclose(shapes.angle, angle, rtol=0, atol=1e-12)
    np.testing.assert_allclose(shapes.adjacent, adjacent, rtol=1e-12)
    np.testing.assert_allclose(shapes.opposite, 1, rtol=1e-12)
    np.testing.assert_allclose(shapes.area, np.linalg.det([first, second]), rtol=1e-12)
    np.testing.assert_allclose(shapes.size, 1, rtol=1e-12)


def test_one_moved_vertex_is_seen_by_its_four_faces():
    polyhedron = grid_torus(6, 6)
    refinement = bisected(triangulated(polyhedron), 1e9)
    flat = flat_map(refinement.polyhedron, 6, 6, np.array([1.0, 0]), np.array([0, 1.0]))
    points = flat.points.copy()
    points[14, 1:] += [0.2, 0.1]
    shapes = face_shapes(polyhedron, refinement, replace(flat, points=points))
    touched = np.flatnonzero((polyhedron.tail.reshape(-1, 4) == 14).any(axis=1))
    np.testing.assert_array_equal(np.flatnonzero(shapes.angle > 1e-9), touched)
    # A unit square whose corner (1, 1) moves to (1.2, 1.1): sides 1, hypot(1.1, 0.2), hypot(1.2, 0.1), 1.
    square = next(f for f in touched if polyhedron.tail[4 * f + 2] == 14)
    assert shapes.opposite[square] == pytest.approx(np.hypot(1.2, 0.1))
    assert shapes.adjacent[square] == pytest.approx(np.hypot(1.2, 0.1))
    assert shapes.area[square] == pytest.approx(1 + 0.1 + 0.05)
    assert shapes.angle[square] == pytest.approx(np.abs(np.array(_angles()) - np.pi / 2).max())


def _angles() -> list[float]:
    corners = np.array([[0, 0], [1, 0], [1.2, 1.1], [0, 1]])
    found = []
    for k in range(4):
        a, b = corners[(k + 1) % 4] - corners[k], corners[k - 1] - corners[k]
        found.append(float(np.arccos(a @ b / np.linalg.norm(a) / np.linalg.norm(b))))
    return found


@pytest.mark.parametrize("name", ["cube", "dodecahedron"])
def test_platonic_faces_are_regular_on_the_sphere(name):
    """Interior angles 120 degrees at three faces a vertex, and areas 4 pi / F (Girard)."""
    registry = Registry.discover()
    polyhedron = read(DATASETS / f"{name}.off", registry)
    refinement = bisected(triangulated(polyhedron), 0.5)
    made = registry.load("parametrizer", "sphere")(refinement.polyhedron, geometry(1), None)
    shapes = face_shapes(polyhedron, refinement, made)
    flattened = {"cube": 1e-6, "dodecahedron": 0.2}[name]
    assert shapes.angle.max() < flattened
    np.testing.assert_allclose(shapes.area.sum(), 4 * np.pi, rtol=1e-9)
    assert np.isnan(shapes.opposite).all() == (name == "dodecahedron")


def reordered(polyhedron: Polyhedron, rng: np.random.Generator) -> tuple[Polyhedron, np.ndarray]:
    """The faces in another order, each from another first corner, and the old number of every face."""
    order = rng.permutation(polyhedron.face_count)
    corners = [
        polyhedron.offsets[f] + np.roll(np.arange(n), rng.integers(n))
        for f, n in zip(order, polyhedron.face_sizes[order], strict=True)
    ]
    old = np.concatenate(corners)
    new = np.argsort(old)
    offsets = np.concatenate([[0], np.cumsum(polyhedron.face_sizes[order])])
    twin, same = new[polyhedron.twin[old]], polyhedron.same[old]
    return Polyhedron(polyhedron.vertices, offsets, polyhedron.tail[old], twin, same), order


@pytest.mark.parametrize("name", ["torus", "Klein bottle", "double torus", "projective plane"])
def test_the_order_of_faces_does_not_matter(name):
    """Nonorientable surfaces too: every face has positive area, from whatever corner it runs."""
    registry = Registry.discover(only=["geometries", "parametrizers"])
    curvature = {"torus": 0, "Klein bottle": 0, "projective plane": 1, "double torus": -1}[name]
    make = registry.load("parametrizer", "sphere" if curvature > 0 else "harmonic")
    found = []
    first = reference_polyhedra()[name]
    second, order = reordered(first, np.random.default_rng(5))
    for polyhedron in (first, second):
        refinement = bisected(triangulated(polyhedron), 0.5 * polyhedron.edge_lengths.max())
        found.append(face_shapes(polyhedron, refinement, make(refinement.polyhedron, geometry(curvature), None)))
    assert (found[0].area > 0).all()
    for measure in ("angle", "adjacent", "opposite", "area"):
        before, after = (getattr(shapes, measure) for shapes in found)
        np.testing.assert_allclose(after, before[order], rtol=1e-4, atol=1e-4)


def test_the_summary_names_the_worst_face():
    values = np.array([0.1, 0.5, 0.2, 0.3])
    ratios = np.array([1.0, 1.5, 3.0, 2.0])
    summary = FaceShapes(np.full(4, 3), values, ratios, np.full(4, np.nan), np.array([1.0, 1, 1, -1])).summary()
    assert summary["angle"]["worst_face"] == 1
    assert summary["angle"]["max"] == pytest.approx(np.degrees(0.5))
    assert summary["adjacent"] == {"median": 1.5, "p95": 2.0, "max": 3.0, "worst_face": 2}
    assert summary["opposite"] == {"median": None, "p95": None, "max": None, "worst_face": None}
    assert summary["size"]["max"] == np.inf
    assert summary["size"]["worst_face"] == 3


# ---- what it is made of ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["torus", "Klein bottle", "projective plane", "double torus", "tetrahedron"])
def test_regular_triangles_fill_regular_polygons(name):
    polyhedron = reference_polyhedra()[name]
    target = regular_triangles(polyhedron)
    after, before = target[:, 1] - target[:, 0], target[:, 2] - target[:, 0]
    areas = (after[:, 0] * before[:, 1] - after[:, 1] * before[:, 0]) / 2
    n = polyhedron.face_sizes
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx((n / 4 / np.tan(np.pi / n)).sum())
    sides = np.linalg.norm(np.roll(target, -1, axis=1) - target, axis=2).ravel()
    np.testing.assert_allclose(sides[outline(polyhedron)], 1)
    twin = triangulated(polyhedron).twin
    np.testing.assert_allclose(sides, sides[twin])


@pytest.mark.parametrize("name", ["torus", "Klein bottle", "double torus"])
def test_the_outline_is_the_boundary_of_the_faces(name):
    polyhedron = reference_polyhedra()[name]
    triangles = triangulated(polyhedron)
    np.testing.assert_array_equal(triangles.tail[outline(polyhedron)], polyhedron.tail)
    np.testing.assert_array_equal(triangles.head[outline(polyhedron)], polyhedron.head)


@pytest.mark.parametrize("part", [0.15, 0.6, 9.0])
@pytest.mark.parametrize("name", ["torus", "Klein bottle"])
def test_products_along_coarse_edges(name, part):
    """Matrices G_i^-1 G_j of random G multiply to those of the two ends, whatever lies between."""
    coarse = triangulated(reference_polyhedra()[name])
    refinement = bisected(coarse, part * coarse.edge_lengths.max())
    mesh = refinement.polyhedron
    g = np.eye(3) + 0.2 * np.random.default_rng(1).normal(size=(len(mesh.vertices), 3, 3))
    steps = np.linalg.inv(g)[mesh.tail] @ g[mesh.head]
    exact = np.linalg.inv(g)[coarse.tail] @ g[coarse.head]
    np.testing.assert_allclose(refinement.composed(steps), exact, rtol=0, atol=1e-9)


def test_values_spread_linearly():
    coarse = triangulated(reference_polyhedra()["torus"])
    refinement = bisected(coarse, 0.3 * coarse.edge_lengths.max())
    spread = refinement.spread(coarse.vertices[coarse.triangles])
    fine = refinement.polyhedron
    np.testing.assert_allclose(spread, fine.vertices[fine.triangles], rtol=0, atol=1e-13)
