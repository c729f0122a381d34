"""Circle packings against closed forms, theorems on circles, and finite differences."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import orbiframe_parametrizers.circle_packing as module
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_parametrizers.circle_packing import PackingLaw, packed
from reference_meshes import connected_sum, dataset, grid, klein_quartic, platonic, reference, shuffled, split_face

from orbiframe import MapError, surface_type

HYPERBOLIC = ("plate_genus2_coarse", "plate_genus2", "plate_genus3", "plate_genus5", "three_crosscaps")


def curvature_of(mesh) -> int:
    return int(np.sign(surface_type(mesh).euler_characteristic))


def angles_by_cosines(lengths: np.ndarray, curvature: int) -> np.ndarray:
    """The corner angles (F, 3) of triangles with these sides (F, 3), by the law of cosines."""
    a, b, c = lengths[:, [1, 2, 0]], lengths[:, [2, 0, 1]], lengths
    if curvature == 0:
        return np.arccos((b**2 + c**2 - a**2) / (2 * b * c))
    return np.arccos((np.cosh(b) * np.cosh(c) - np.cosh(a)) / (np.sinh(b) * np.sinh(c)))


def test_the_klein_quartic_has_equal_circles_of_known_size():
    """Seven equilateral triangles meet at every vertex: cosh r = 1 / (2 sin(pi/7))."""
    radii = packed(klein_quartic(), -1).radii
    assert np.allclose(np.cosh(radii), 1 / (2 * np.sin(np.pi / 7)), rtol=1e-12, atol=0)


@pytest.mark.parametrize("mesh", [reference("torus"), grid(7, 5), grid(6, 8, twisted=True)], ids=["7", "grid", "Klein"])
def test_six_circles_round_each_are_equal(mesh):
    packing = packed(mesh, 0)
    assert np.ptp(packing.radii) < 1e-12 * packing.radii.mean()
    assert np.allclose(packing.angles, np.pi / 3, rtol=0, atol=1e-12)


@settings(max_examples=15, deadline=None)
@given(st.sampled_from(["TT", "TTT", "PPP", "PT"]), st.integers(0, 2**32 - 1))
def test_a_circle_in_a_gap_moves_no_other_and_obeys_descartes(parts, seed):
    """2 sum k^2 = (sum k)^2 + 4 for the curvatures k = coth r of four circles that touch (Mauldon 1962)."""
    rng = np.random.default_rng(seed)
    mesh = shuffled(connected_sum(parts), 10, rng)
    face = int(rng.integers(mesh.face_count))
    before, after = packed(mesh, -1).radii, packed(split_face(mesh, face), -1).radii
    assert np.allclose(after[:-1], before, rtol=1e-9, atol=0)
    k = 1 / np.tanh(after[np.append(mesh.triangles[face], len(before))])
    assert 2 * (k**2).sum() == pytest.approx(k.sum() ** 2 + 4, rel=1e-9)


def test_a_sphere_without_a_face_fills_the_gap_of_three_circles():
    """Descartes: the curvature of the circle between three unit circles that touch is 3 + 2 sqrt 3."""
    mesh = platonic("tetrahedron")
    radii = packed(mesh, 0, without_face=2).radii
    inner = np.setdiff1d(np.arange(4), mesh.triangles[2])
    assert np.allclose(radii[inner], 1 / (3 + 2 * np.sqrt(3)), rtol=1e-13)
    assert np.allclose(radii[mesh.triangles[2]], 1)


@settings(max_examples=40, deadline=None)
@given(st.sampled_from(["T", "PP", "TT", "TTT", "PPP", "PPPP", "PT"]), st.integers(0, 40), st.integers(0, 2**32 - 1))
def test_every_triangulation_is_packed(parts, moves, seed):
    mesh = shuffled(connected_sum(parts), moves, np.random.default_rng(seed))
    curvature = curvature_of(mesh)
    packing = packed(mesh, curvature)
    angles = angles_by_cosines(packing.lengths.reshape(-1, 3), curvature)
    assert np.allclose(angles, packing.angles.reshape(-1, 3), rtol=0, atol=1e-6)
    sums = np.bincount(mesh.tail, weights=packing.angles)
    assert np.allclose(sums, 2 * np.pi, rtol=0, atol=1e-11)
    assert packing.steps <= 15


@pytest.mark.parametrize("name", HYPERBOLIC)
def test_the_area_is_that_of_gauss_and_bonnet(name):
    """tan^2(area / 4) = tanh(s/2) tanh((s-a)/2) tanh((s-b)/2) tanh((s-c)/2), from the sides alone (L'Huilier)."""
    mesh = dataset(name)
    sides = packed(mesh, -1).lengths.reshape(-1, 3)
    s = sides.sum(axis=1, keepdims=True) / 2
    area = 4 * np.arctan(np.sqrt(np.tanh(np.hstack([s, s - sides]) / 2).prod(axis=1)))
    # Every angle sum is right to 1e-11.
    total = -2 * np.pi * surface_type(mesh).euler_characteristic
    assert area.sum() == pytest.approx(total, abs=1e-11 * len(mesh.vertices))


@pytest.mark.parametrize(("name", "density"), [*((name, 1) for name in HYPERBOLIC), ("plate_genus2", 5)])
def test_few_newton_steps(name, density):
    assert packed(dataset(name, density), -1).steps <= 7


@pytest.mark.parametrize("parts", ["TT", "PPP", "PPPP"])
def test_the_start_has_the_right_total_area(parts):
    mesh = shuffled(connected_sum(parts), 20, np.random.default_rng(7))
    law = PackingLaw(mesh, -1)
    assert law.state(law.start).curvatures.sum() == pytest.approx(0, abs=1e-9)


CASES = [("T", 0, None), ("PP", 0, None), ("TT", -1, None), ("PPP", -1, None)]


@pytest.mark.parametrize(("parts", "curvature", "hole"), CASES)
def test_the_hessian_is_the_derivative_of_the_curvatures(parts, curvature, hole):
    mesh = shuffled(connected_sum(parts), 10, np.random.default_rng(2))
    check_hessian(mesh, curvature, hole)


def test_the_hessian_of_a_sphere_without_a_face():
    check_hessian(shuffled(platonic("icosahedron"), 10, np.random.default_rng(4)), 0, 3)


def check_hessian(mesh, curvature: int, hole: int | None) -> None:
    law = PackingLaw(mesh, curvature, hole)
    rng = np.random.default_rng(5)
    u = law.start + rng.uniform(-0.3, 0, law.count)
    direction = np.where(law.fixed, 0.0, rng.normal(size=law.count))
    coupling, diagonal = law.hessian(law.state(u))
    tail, head = mesh.tail[mesh.representative], mesh.head[mesh.representative]
    product = diagonal * direction
    np.add.at(product, tail, -coupling * direction[head])
    np.add.at(product, head, -coupling * direction[tail])
    h = 1e-5
    difference = (law.state(u + h * direction).curvatures - law.state(u - h * direction).curvatures) / (2 * h)
    assert np.allclose(product[~law.fixed], difference[~law.fixed], rtol=0, atol=1e-8)
    assert (coupling[~(law.fixed[tail] | law.fixed[head])] > 0).all()


def test_the_iteration_that_does_not_arrive_says_so(monkeypatch):
    monkeypatch.setattr(module, "_STEPS", 1)
    with pytest.raises(MapError, match=r"the circle packing stopped at an angle error of .*e.* refine the mesh"):
        packed(dataset("plate_genus3"), -1)


@pytest.mark.filterwarnings("ignore:invalid value")
def test_a_sphere_has_no_hyperbolic_packing():
    with pytest.raises(MapError, match="stopped at an angle error of nan"):
        packed(platonic("icosahedron"), -1)


def test_a_vertex_of_a_thousand_neighbours():
    """A wheel of 1000 spokes in one face: the rounding of its angle sum is above the usual tolerance."""
    mesh = connected_sum("TT")
    hub, (a, b, c) = 0, next(face for face in mesh.triangles.tolist() if 0 in face)
    turn = [a, b, c].index(hub)
    _, first, last = [a, b, c][turn:] + [a, b, c][:turn]
    chain = [first, *range(len(mesh.vertices), len(mesh.vertices) + 1000), last]
    faces = [face for face in mesh.triangles.tolist() if face != [a, b, c]]
    faces += [[hub, i, j] for i, j in pairwise(chain)]
    # The far side of the chain: a strip back to the edge from first to last.
    apex = len(mesh.vertices) + 1000
    faces += [[apex, j, i] for i, j in pairwise(chain)] + [[apex, first, last]]
    vertices = np.random.default_rng(0).normal(size=(apex + 1, 3))
    wheel = type(mesh).from_faces(vertices, faces)
    assert surface_type(wheel).genus == 2
    packing = packed(wheel, -1)
    sums = np.bincount(wheel.tail, weights=packing.angles)
    assert np.allclose(sums, 2 * np.pi, rtol=0, atol=1e-11)
    assert packing.steps <= 25


@pytest.mark.parametrize("parts", ["T", "TT", "PPP"])
def test_a_packing_that_stops_early_is_refused(parts, monkeypatch):
    """Newton's method squares the error: a step or two before the end it is small, and not small enough."""
    mesh = shuffled(connected_sum(parts), 10, np.random.default_rng(0))
    curvature = curvature_of(mesh)
    errors = []
    for steps in range(1, packed(mesh, curvature).steps - 1):
        monkeypatch.setattr(module, "_STEPS", steps)
        with pytest.raises(MapError, match="stopped at an angle error of") as refusal:
            packed(mesh, curvature)
        errors.append(float(str(refusal.value).split("angle error of ")[1].split(",")[0]))
    assert errors[0] > errors[-1]
    assert errors[-1] < 5e-3
