"""Maps of shapes that are hard to map: every triangle positive, relations and area as exact as doubles allow."""

from __future__ import annotations

from functools import partial

import hard_surfaces as hard
import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from orbiframe_parametrizers import harmonic_energy
from orbiframe_parametrizers.harmonic import harmonic
from orbiframe_parametrizers.sphere import sphere
from reference_meshes import edge_lengths, geometry
from signed_faces import WORDS, fan, wandering

from orbiframe import MapError, surface_type
from orbiframe.meshes import bisected, doubled_edges
from orbiframe.meshes.bisection import edge_length_for
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.triangulations import crowding_of
from orbiframe.triangulations.triangulation import Triangulation

pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning")
SEEDS = st.integers(0, 2**32 - 1)
NAMES = st.sampled_from(sorted(WORDS))
PLATE = partial(hard.plate, 1, 2, 2)


def mapped(mesh: Polyhedron) -> Triangulation:
    curvature = int(np.sign(surface_type(mesh).euler_characteristic))
    return (sphere if curvature > 0 else harmonic)(mesh, geometry(curvature), None)


def uniquely(mesh: Polyhedron) -> Triangulation:
    """The map with weights that are positive, whatever the triangles are like."""
    curvature = int(np.sign(surface_type(mesh).euler_characteristic))
    if curvature > 0:
        return sphere(mesh, geometry(curvature), weights="packing")
    return harmonic(mesh, geometry(curvature), weights="mean-value")


def require_lawful(found: Triangulation) -> None:
    assert found.not_positive == 0
    assert found.relation_defect < 1e-12
    assert found.area_defect < 1e-9


@pytest.mark.parametrize("genus", [0, 1, 4, 9, 20, 50, 133])
def test_handles(genus: int) -> None:
    mesh = hard.handles(genus)
    assert (surface_type(mesh).genus, surface_type(mesh).orientable) == (genus, True)
    require_lawful(mapped(mesh))


@pytest.mark.parametrize("p", [7, 13])
def test_hurwitz_surfaces_with_random_vertices(p: int) -> None:
    """84 (g - 1) symmetries: 7 triangles at every vertex."""
    mesh = hard.hurwitz(p)
    assert surface_type(mesh).genus == {7: 3, 13: 14}[p]
    assert set(np.bincount(mesh.tail)) == {7}
    require_lawful(mapped(mesh))


@pytest.mark.parametrize("count", [1, 2, 3, 7, 12, 20])
def test_crosscaps(count: int) -> None:
    mesh = hard.crosscaps(count, 2)
    assert (surface_type(mesh).genus, surface_type(mesh).orientable) == (count, False)
    require_lawful(mapped(mesh))


@pytest.mark.parametrize("ratio", [10, 30])
@pytest.mark.parametrize("cells", [hard.plate_cells(0, 1), hard.plate_cells(1, 1), hard.plate_cells(1, 2)], ids=len)
def test_fingers_are_mapped_and_their_crowding_is_known(cells: set[hard.Cell], ratio: float) -> None:
    """The tip of a finger shrinks like exp(-L / r): the digits of its area are twice those of its edges."""
    found = mapped(hard.with_finger(cells, (0, 0, 0), ratio))
    require_lawful(found)
    area_ratio, lost = crowding_of(found)
    if surface_type(found.polyhedron).euler_characteristic <= 0:
        assert area_ratio == pytest.approx(np.exp(-2 * ratio), rel=10)
        assert -np.log10(area_ratio) == pytest.approx(2 * ratio * np.log10(np.e), abs=2)
        assert lost == pytest.approx(-np.log10(area_ratio) / 2, abs=3)


@pytest.mark.parametrize("ratio", [40, 60, 80])
@pytest.mark.parametrize("cells", [hard.plate_cells(0, 1), hard.plate_cells(1, 1), hard.plate_cells(1, 2)], ids=len)
def test_fingers_beyond_all_digits_of_a_double_are_mapped_in_patches(cells: set[hard.Cell], ratio: float) -> None:
    """The tip is exp(-80) of its root; seen from a patch of its own it has nearly all digits."""
    found = mapped(hard.with_finger(cells, (0, 0, 0), ratio))
    require_lawful(found)
    assert crowding_of(found).digits_lost < 13
    assert np.median(found.angle_distortion) < 1.8  # triangles are large
    half = 1 if surface_type(found.polyhedron).euler_characteristic <= 0 else 0.5
    assert -np.log10(crowding_of(found).area_ratio) == pytest.approx(2 * half * ratio * np.log10(np.e), rel=0.25)


@pytest.mark.parametrize("cells", [hard.plate_cells(0, 1), hard.plate_cells(1, 1)], ids=len)
def test_a_finger_too_long_for_doubles_is_refused_with_the_reason(cells: set[hard.Cell]) -> None:
    with pytest.raises(MapError, match=r"crowded into so little of X/H that it takes \S+ digits .*; shorten them"):
        mapped(hard.with_finger(cells, (0, 0, 0), 800, 1))


@pytest.mark.parametrize(
    "mesh",
    [
        hard.with_slivers(PLATE(), 0.2, 1e-3, 2),
        hard.with_slivers(PLATE(), 0.2, 2e-8, 1),
        hard.stretched(PLATE(), 1e4, 1, 1),
        hard.stretched(PLATE(), 1, 1, 1e-4),
        hard.with_fan(PLATE(), 5, 1000),
        hard.with_many_of_valence_three(PLATE(), 2),
        hard.with_slivers(hard.crosscaps(4, 2), 0.2, 1e-3, 2),
        hard.with_fan(hard.crosscaps(1, 3), 5, 1000),
        hard.stretched(hard.voxels({(0, 0, 0)}, 4), 1e4, 1, 1),
    ],
    ids=["slivers", "thin slivers", "needles", "plate", "valence", "valence 3", "one-sided", "cap", "long box"],
)
def test_bad_triangles(mesh: Polyhedron) -> None:
    require_lawful(mapped(mesh))


def test_the_shapes_are_as_bad_as_they_say() -> None:
    assert least_angle(hard.with_slivers(PLATE(), 0.2, 1e-3, 2)) < 0.1
    assert np.bincount(hard.with_fan(PLATE(), 5, 1000).tail).max() > 1000
    assert (np.bincount(hard.with_many_of_valence_three(PLATE(), 1).tail) == 3).mean() > 0.6
    thin = hard.stretched(PLATE(), 1, 1, 1e-4).vertices
    assert np.ptp(thin[:, 2]) < 1e-4 * np.ptp(thin[:, 0])
    assert least_angle(hard.stretched(PLATE(), 1e4, 1, 1)) < np.degrees(2e-4)


def least_angle(mesh: Polyhedron) -> float:
    """The least angle of all triangles, in degrees."""
    side = mesh.vertices[mesh.head] - mesh.vertices[mesh.tail]
    back = -side[mesh.next[mesh.next]]
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(side, back), axis=1), (side * back).sum(axis=1)).min()))


def test_no_two_hexagons_lose_an_ear_at_the_same_vertex() -> None:
    """It would have two triangles, between two edges of one class, and no map without halving."""
    mesh = triangulated(hard.with_notched_edges(hard.crosscaps(2, 5)))
    assert not (np.bincount(mesh.tail) == 2).any()
    require_lawful(mapped(mesh))


@pytest.mark.parametrize("name", ["torus", "Klein bottle", "genus 2", "3 crosscaps"])
def test_one_vertex_is_mapped_after_halving(name: str) -> None:
    mesh = bisected(fan(WORDS[name]).polyhedron(), np.inf, True).polyhedron
    scattered = mesh.with_vertices(np.random.default_rng(0).normal(size=mesh.vertices.shape))
    require_lawful(mapped(scattered))


# ---- random triangulations of every topology ------------------------------------------------------------------------


def random_case(name: str, seed: int) -> Polyhedron:
    """A small closed surface after 40 random flips, splits and collapses, made simplicial; vertices anywhere."""
    mesh = bisected(wandering(WORDS[name], seed, 40).polyhedron(), np.inf, True).polyhedron
    assert not doubled_edges(mesh).any()
    return mesh.with_vertices(np.random.default_rng(seed).normal(size=mesh.vertices.shape))


@settings(max_examples=40, deadline=None)
@given(NAMES, SEEDS)
@example("genus 3", 2786)
def test_random_triangulations_are_mapped(name: str, seed: int) -> None:
    mesh = random_case(name, seed)
    found = mapped(mesh)
    require_lawful(found)
    assert found.orbifold.orientable == surface_type(mesh).orientable


@settings(max_examples=10, deadline=None)
@given(NAMES, SEEDS)
def test_order_and_numbers_do_not_matter(name: str, seed: int) -> None:
    """Faces in another order from other first corners, vertices with other numbers: edges keep their lengths in X.

    With positive weights, for which the map is unique; cotangents of random triangles are not.
    """
    mesh, rng = random_case(name, seed), np.random.default_rng(seed)
    order, number = rng.permutation(mesh.face_count), rng.permutation(len(mesh.vertices))
    corners = 3 * order[:, None] + (np.arange(3) + rng.integers(3, size=(mesh.face_count, 1))) % 3
    old = corners.ravel()
    new = np.argsort(old)
    vertices = np.empty_like(mesh.vertices)
    vertices[number] = mesh.vertices
    other = Polyhedron(vertices, mesh.offsets, number[mesh.tail[old]], new[mesh.twin[old]], mesh.same[old])
    np.testing.assert_allclose(edge_lengths(uniquely(other)), edge_lengths(uniquely(mesh))[old], rtol=0, atol=1e-6)


@settings(max_examples=10, deadline=None)
@given(SEEDS)
def test_refined_random_triangulations_are_mapped(seed: int) -> None:
    mesh = random_case("genus 2", seed)
    require_lawful(mapped(bisected(mesh, edge_length_for(mesh, 300), True).polyhedron))


def test_a_step_beyond_all_floats_is_shortened() -> None:
    """A direction of descent of length 10^6, as a nearly singular Hessian makes of rounding."""
    start = mapped(PLATE())
    energy = harmonic_energy.HarmonicEnergy(start, np.ones(len(start.polyhedron.tail)))
    points = start.points
    step, decrement = energy.newton_step(points)
    long = 1e6 * step / np.linalg.norm(step, axis=1).max()
    found = harmonic_energy._search(energy, points, energy.value(points), long, decrement)
    assert found is None or found[1] < energy.value(points)
