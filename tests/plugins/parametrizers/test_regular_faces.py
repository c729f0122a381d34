"""Regular faces: exact squares where they exist, exact regular tessellations, and never a fold."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_parametrizers.even_areas import evened
from orbiframe_parametrizers.flat import _reshaped
from orbiframe_parametrizers.harmonic import harmonic
from orbiframe_parametrizers.regular_faces import _conformal, regular_faces
from orbiframe_parametrizers.second_order import SecondOrder, turning_angle
from orbiframe_parametrizers.shape_energy import ShapeEnergy, _searched, half_square, reshaped
from orbiframe_parametrizers.vertex_scaling import scaled
from reference_meshes import DATASETS, REGISTRY, connected_sum, dataset, geometry, klein_quartic

from orbiframe import MapError, Polyhedron
from orbiframe.files.gate import read
from orbiframe.meshes.bisection import bisected
from orbiframe.meshes.face_diagonals import outline, triangulated
from orbiframe.meshes.orientation import oriented
from orbiframe.meshes.regular_triangles import regular_triangles
from orbiframe.meshes.surface_type import surface_type
from orbiframe.testing.optimizer_laws import distortion
from orbiframe.testing.parametrizer_laws import edge_lengths
from orbiframe.testing.reference import RECIPES, reference_triangulations
from orbiframe.triangulations.face_shapes import face_shapes

EQUILATERAL = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(0.75)]])


def mapped(polyhedron: Polyhedron, vertices: int = 600):
    """A refinement with about so many vertices (1: none), its map, and the wished triangles."""
    coarse = triangulated(polyhedron)
    longest = coarse.edge_lengths.mean() * max(0.2, np.sqrt(len(coarse.vertices) / vertices))
    refinement = bisected(coarse, longest if vertices > 1 else 1e9)
    curvature = int(np.sign(surface_type(coarse).euler_characteristic))
    made = harmonic(refinement.polyhedron, geometry(curvature))
    return refinement, made, refinement.spread(regular_triangles(polyhedron))


def equilateral(mesh: Polyhedron) -> np.ndarray:
    return np.tile(EQUILATERAL, (mesh.face_count, 1, 1))


# ---- exact answers --------------------------------------------------------------------------------------------------


def grid_torus(columns: int, rows: int, twisted: bool = False) -> Polyhedron:
    """A torus of columns x rows quadrilaterals; a Klein bottle if twisted, with vertices anywhere."""
    i, j = (x.ravel() for x in np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij"))

    def number(a, b):
        turned = twisted & (a >= columns)
        return (a % columns) * rows + np.where(turned, -b, b) % rows

    faces = np.stack([number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)], axis=1)
    u, v = 2 * np.pi * i / columns, 2 * np.pi * j / rows
    points = np.column_stack([(3 + np.cos(v)) * np.cos(u), (3 + np.cos(v)) * np.sin(u), np.sin(v)])
    return Polyhedron.from_faces(points, faces)


@pytest.mark.parametrize("columns", [5, 15])
@pytest.mark.parametrize("twisted", [False, True])
def test_grids_become_squares(columns, twisted):
    """A 15 x 5 grid asks for a lattice of 3 : 1, which is found; no vertex of it has another valence than 4."""
    polyhedron = grid_torus(columns, 5, twisted)
    refinement, first, target = mapped(polyhedron)
    before = face_shapes(polyhedron, refinement, first)
    made = regular_faces(first, target)
    shapes = face_shapes(polyhedron, refinement, made)
    assert before.adjacent.max() > 1.2
    np.testing.assert_allclose(shapes.angle, 0, atol=1e-9)
    np.testing.assert_allclose(shapes.adjacent, 1, atol=1e-9)
    np.testing.assert_allclose(shapes.size, 1, atol=1e-9)
    np.testing.assert_allclose(distortion(made, target), 1, atol=1e-9)


def test_a_kept_lattice_stretches_all_squares_alike():
    """The best map of a square torus to a rectangle of 2 : 1 in the class of the map is the linear one."""
    _, first, target = mapped(grid_torus(6, 6))
    square = regular_faces(first, target)
    stretched = _reshaped(square, np.diag([np.sqrt(2), np.sqrt(0.5)]))
    noise = np.random.default_rng(0).normal(size=(len(first.points), 2))
    rough = replace(stretched, points=ShapeEnergy(stretched, target, 0.0).moved(stretched.points, 0.005 * noise))
    assert rough.not_positive == 0
    for area in (0.0, 1.0):
        made = regular_faces(rough, target, group="kept", area=area)
        np.testing.assert_allclose(distortion(made, target), (2 + 1 / 2) / 2, rtol=1e-4)


def brings_surface() -> Polyhedron:
    """The regular map {4, 5} of genus 4: 24 vertices, 60 edges, 30 quadrilaterals; vertices anywhere.

    Its 120 halfedges are the permutations of five letters: `next` multiplies by (0 1 2 3) from the right, `twin` by
    (3 4), and their product has order 5.
    """
    group = [tuple(g) for g in permutations(range(5))]
    number = {g: n for n, g in enumerate(group)}
    times = lambda g, h: tuple(g[h[k]] for k in range(5))  # noqa: E731
    turn, flip = (1, 2, 3, 0, 4), (0, 1, 2, 4, 3)
    faces, seen = [], set()
    for g in group:
        if g not in seen:
            face = [g]
            while (g := times(g, turn)) != face[0]:
                face.append(g)
            seen.update(face)
            faces.append(face)
    order = [number[g] for face in faces for g in face]
    place = np.argsort(order)
    twin = place[[number[times(group[n], flip)] for n in order]]
    offsets = np.arange(len(faces) + 1) * 4
    following = np.arange(120) + np.where(np.arange(120) % 4 == 3, -3, 1)
    tail = np.full(120, -1)
    for h in range(120):
        if tail[h] < 0:
            vertex = tail.max() + 1
            while tail[h] < 0:
                tail[h] = vertex
                h = following[twin[h]]
    points = np.random.default_rng(2).normal(size=(tail.max() + 1, 3))
    return Polyhedron(points, offsets, tail, twin, np.zeros(120, dtype=np.bool_))


def test_brings_surface_gets_regular_quadrilaterals():
    """{4, 5}: angles 2 pi / 5, cosh(half a side) = cos(pi/4) / sin(pi/5), areas 12 pi / 30.

    The metric of regular faces is exact on the faces themselves, whatever diagonals they have; a refinement that
    follows the random place of the vertices in space sees it through thin triangles, and so roughly.
    """
    polyhedron = brings_surface()
    assert (len(polyhedron.vertices), polyhedron.face_count) == (24, 30)
    assert surface_type(polyhedron).euler_characteristic == -6
    whole, first, target = mapped(polyhedron, 1)
    exact = _conformal(first, target)
    shapes = face_shapes(polyhedron, whole, exact)
    np.testing.assert_allclose(shapes.angle, 0, atol=1e-7)
    np.testing.assert_allclose(shapes.area, 2 * np.pi / 5, rtol=1e-7)
    sides = edge_lengths(exact)[outline(polyhedron)]
    np.testing.assert_allclose(np.cosh(sides / 2), np.cos(np.pi / 4) / np.sin(np.pi / 5), rtol=1e-8)
    refinement, first, target = mapped(polyhedron, 2000)
    before, after = (face_shapes(polyhedron, refinement, m) for m in (first, regular_faces(first, target)))
    assert np.degrees(before.angle.max()) > 20
    assert np.degrees(after.angle.max()) < 6
    np.testing.assert_allclose(after.area, 2 * np.pi / 5, rtol=0.1)


def test_kleins_quartic_gets_regular_triangles():
    """{3, 7}: cosh(half an edge) = 1 / (2 sin(pi/7)), from vertices that lie anywhere."""
    mesh = klein_quartic()
    mesh = mesh.with_vertices(np.random.default_rng(0).normal(size=mesh.vertices.shape))
    made = regular_faces(harmonic(mesh, geometry(-1)), equilateral(mesh))
    np.testing.assert_allclose(np.cosh(edge_lengths(made) / 2), 1 / (2 * np.sin(np.pi / 7)), rtol=1e-8)
    assert made.relation_defect < 1e-12


# ---- the energy -----------------------------------------------------------------------------------------------------


def test_the_flat_energy_is_the_mean_distortion():
    first = reference_triangulations()["torus"]
    target = EQUILATERAL + 0.2 * np.random.default_rng(1).normal(size=(len(first.lifts), 3, 2))
    wished = np.linalg.det(target[:, 1:] - target[:, :1])
    target, wished = np.where((wished < 0)[:, None, None], target[:, ::-1], target), np.abs(wished)
    share = wished / wished.sum()
    growth = first.areas / first.areas.sum() / share
    for area in (0.0, 0.5, 2.0):
        exact = share @ (distortion(first, target) * ((growth + 1 / growth) / 2) ** area)
        assert ShapeEnergy(first, target, area).value(first.points) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("area", [0.0, 0.7])
@pytest.mark.parametrize("name", RECIPES)
def test_derivatives_are_those_of_differences(name, area):
    first = reference_triangulations()[name]
    rng = np.random.default_rng(3)
    target = EQUILATERAL + 0.2 * rng.random((len(first.lifts), 3, 2))
    energy = ShapeEnergy(first, target, area)
    terms = energy.terms(first.points)
    assert terms.value.sum() == pytest.approx(energy.value(first.points), rel=1e-12)
    step = rng.normal(size=(len(first.points), 2))
    along = step[first.polyhedron.triangles].reshape(-1, 6)
    h = 1e-3 * np.sqrt(first.areas.min())
    before, here, after = (energy.value(energy.moved(first.points, t * step)) for t in (-h, 0.0, h))
    slope, bend = np.einsum("fi,fi->", terms.gradient, along), np.einsum("fi,fij,fj->", along, terms.hessian, along)
    assert (after - before) / (2 * h) == pytest.approx(slope, rel=1e-3, abs=1e-3 * np.sqrt(bend * here))
    assert (after - 2 * here + before) / h**2 == pytest.approx(bend, rel=1e-3)


def test_a_step_is_taken_only_where_the_energy_falls_as_much_as_the_slope_says():
    """A slope a hundred thousand times too steep is never followed, however short the step."""
    first = reference_triangulations()["torus"]
    energy = ShapeEnergy(first, EQUILATERAL + np.zeros((len(first.lifts), 3, 2)), 0.0)
    value = energy.value(first.points)
    step, decrement = energy.newton_step(first.points)
    points, less = _searched(energy, first.points, value, step, decrement)
    assert less < value
    assert energy.value(points) == less
    assert _searched(energy, first.points, value, step, 1e5 * decrement) is None


@pytest.mark.parametrize("curvature", [-1, 1])
@pytest.mark.parametrize("versine", [1e-9, 1e-4, 9.9e-4, 1.01e-3, 0.1, 1.5])
def test_half_the_squared_distance(curvature, versine):
    with mpmath.workdps(40):
        inverse = mpmath.acosh if curvature < 0 else mpmath.acos
        exact = lambda c: inverse(1 - curvature * c) ** 2 / 2  # noqa: E731
        known = [float(mpmath.diff(exact, mpmath.mpf(versine), n)) for n in range(3)]
    found = half_square(curvature, np.array([versine]))
    assert [float(f[0]) for f in found] == pytest.approx(known, rel=1e-9)


def test_the_chain_rule():
    """atan2(u v, u + v) of two coordinates against differences."""

    def function(x):
        u = SecondOrder(x[:, 0], np.tile([1.0, 0.0], (len(x), 1)), np.zeros((len(x), 2, 2)))
        v = SecondOrder(x[:, 1], np.tile([0.0, 1.0], (len(x), 1)), np.zeros((len(x), 2, 2)))
        return turning_angle(u * v, u + v)

    x, h = np.random.default_rng(0).normal(size=(50, 2)), 1e-5
    made = function(x)
    np.testing.assert_allclose(made.value, np.arctan2(x[:, 0] * x[:, 1], x.sum(axis=1)))
    for k, step in enumerate(np.eye(2) * h):
        gradient = (function(x + step).value - function(x - step).value) / (2 * h)
        hessian = (function(x + step).gradient - function(x - step).gradient) / (2 * h)
        np.testing.assert_allclose(made.gradient[:, k], gradient, rtol=1e-4, atol=1e-5)
        np.testing.assert_allclose(made.hessian[:, k], hessian, rtol=1e-4, atol=1e-4)


@settings(max_examples=12, deadline=None)
@given(st.sampled_from(["T", "TT", "PP", "PPP", "PT"]), st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.4, 1.5]))
def test_the_energy_falls_and_nothing_folds(parts, seed, area):
    rng = np.random.default_rng(seed)
    mesh = connected_sum(parts)
    mesh = mesh.with_vertices(rng.normal(size=mesh.vertices.shape))
    first = harmonic(mesh, geometry(int(np.sign(surface_type(mesh).euler_characteristic))))
    target = EQUILATERAL + 0.15 * rng.normal(size=(mesh.face_count, 3, 2))
    target = np.where((np.linalg.det(target[:, 1:] - target[:, :1]) < 0.1)[:, None, None], EQUILATERAL, target)
    energy = ShapeEnergy(first, target, area)
    kept = regular_faces(first, target, group="kept", area=area)
    assert energy.value(kept.points) <= energy.value(first.points)
    assert kept.not_positive == 0
    assert kept.area_defect < 1e-9
    assert kept.relation_defect == first.relation_defect


@pytest.mark.parametrize("name", ["plate_genus2_coarse", "plate_genus3", "klein_bottle", "three_crosscaps", "torus"])
def test_datasets_keep_all_laws(name):
    polyhedron = oriented(read(DATASETS / f"{name}.off", REGISTRY))
    refinement, first, target = mapped(polyhedron)
    before = ShapeEnergy(first, target, 0.0).value(first.points)
    for area in (0.0, 0.5):
        made = regular_faces(first, target, area=area)
        assert made.not_positive == 0
        assert made.relation_defect < 1e-12
        assert made.area_defect < 1e-9
        assert made.weights == "shape"
    shape_only = regular_faces(first, target)
    assert ShapeEnergy(shape_only, target, 0.0).value(shape_only.points) <= before
    evens = np.std(np.log(face_shapes(polyhedron, refinement, made).size))
    assert evens <= np.std(np.log(face_shapes(polyhedron, refinement, first).size)) + 1e-9


def test_the_least_energy_is_a_minimum():
    """No small motion lowers it; with the sign of the gradient wrong, or half of the terms, it would."""
    _, first, target = mapped(oriented(read(DATASETS / "plate_genus2_coarse.off", REGISTRY)), 100)
    made = reshaped(first, target, 0.5)
    energy = ShapeEnergy(made, target, 0.5)
    least, rng = energy.value(made.points), np.random.default_rng(0)
    for size in (1e-4, 1e-3, 1e-2):
        assert energy.value(energy.moved(made.points, size * rng.normal(size=(len(made.points), 2)))) > least
    assert energy.newton_step(made.points)[1] < 1e-6


def test_a_folded_map_is_refused():
    first = reference_triangulations()["double torus"]
    folded = replace(first, points=np.roll(first.points, 1, axis=0))
    with pytest.raises(MapError, match="triangles of the map are folded"):
        regular_faces(folded, equilateral(first.polyhedron))


# ---- other metrics, even areas --------------------------------------------------------------------------------------


def test_vertex_scaling_of_given_sides():
    """The sides in space give the same metric as none; only their ratios and the conformal class matter."""
    mesh = dataset("plate_genus2_coarse")
    plain = scaled(mesh)
    np.testing.assert_allclose(scaled(mesh, 7 * mesh.edge_lengths).lengths, plain.lengths, rtol=1e-9)
    factor = np.exp(0.1 * np.random.default_rng(0).normal(size=len(mesh.vertices)))
    other = scaled(mesh, mesh.edge_lengths * factor[mesh.tail] * factor[mesh.head])
    if np.array_equal(other.triangulation.tail, plain.triangulation.tail):
        np.testing.assert_allclose(other.lengths, plain.lengths, rtol=1e-8)


@pytest.mark.parametrize("name", ["plate_genus2_coarse", "plate_genus3", "three_crosscaps", "torus"])
def test_even_areas_even_out(name):
    mesh = dataset(name, 2)
    plane = geometry(int(np.sign(surface_type(mesh).euler_characteristic)))
    space = np.linalg.norm(np.cross(*(np.diff(mesh.vertices[mesh.triangles], axis=1)[:, k] for k in (0, 1))), axis=1)
    made = [harmonic(mesh, plane, even_areas=rounds) for rounds in (0, 2, 5)]
    spread = [np.std(np.log(result.areas / space)) for result in made]
    assert spread[0] > spread[1] > spread[2]
    assert spread[2] < 0.6 * spread[0]
    for result in made:
        assert result.not_positive == 0
        assert result.relation_defect < 1e-12
        assert result.area_defect < 1e-9
    assert made[2].weights.endswith("5 rounds of even areas")


def test_no_rounds_change_nothing():
    made = reference_triangulations()["double torus"]
    assert evened(made, 0) is made
