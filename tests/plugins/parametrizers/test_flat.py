"""Flat lattices against intrinsic flat metrics, where they are exact, and tori of revolution, where they converge."""

from __future__ import annotations

import numpy as np
import pytest
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.developing import developed
from orbiframe_parametrizers.flat import with_best_lattice
from orbiframe_parametrizers.harmonic import harmonic
from orbiframe_parametrizers.harmonic_energy import HarmonicEnergy, minimised
from reference_meshes import connected_sum, edge_lengths, geometry, grid, lifted_edges, revolved

from orbiframe import surface_type


def flat_map(mesh, weights):
    packing = packed(mesh, 0)
    layout = developed(mesh, geometry(0), packing.lengths, packing.angles, surface=surface_type(mesh), patch_radius=3.0)
    points = minimised(layout, weights)
    return with_best_lattice(type(layout)(layout.orbifold, mesh, layout.patch, points, layout.transition), weights)


def parallelogram_weights(mesh, first, second):
    """Cotangent weights (H,) of `grid` whose squares are parallelograms: per face along, across, diagonal or so."""
    area = abs(first[0] * second[1] - first[1] * second[0])
    along, across = (second @ (first + second)) / area, (first @ (first + second)) / area
    diagonal = -(first @ second) / area
    return np.tile([along, across, diagonal, diagonal, along, across], mesh.face_count // 2)


STEPS = [((1.0, 0), (0, 1)), ((1, 0), (0, 2.5)), ((1, 0), (-0.4, 0.9)), ((1.2, 0.3), (0.4, 0.8))]


@pytest.mark.parametrize(("first", "second"), STEPS)
def test_a_flat_torus_gets_its_own_lattice(first, second):
    first, second = np.array(first, dtype=float), np.array(second, dtype=float)
    mesh = grid(7, 5)
    result = flat_map(mesh, parallelogram_weights(mesh, first, second))
    check_steps(result, first, second)


@pytest.mark.parametrize("second", [0.4, 1.0, 3.0])
def test_a_flat_klein_bottle_gets_its_own_sides(second):
    first, second = np.array([1.0, 0]), np.array([0, second])
    mesh = grid(8, 6, twisted=True)
    result = flat_map(mesh, parallelogram_weights(mesh, first, second))
    check_steps(result, first, second)
    # Isometries stay isometries: shaping may not touch the reflection.
    assert result.orbifold.geometry.isometry_defect(result.orbifold.atlas.isometry).max() < 1e-13


def check_steps(result, first, second):
    vectors = [first, second, first + second]
    steps = np.array([np.linalg.norm(vectors[k]) for k in (0, 1, 2, 2, 0, 1)])
    lengths = edge_lengths(result).reshape(-1, 6)
    scale = lengths[0, 0] / steps[0]
    assert np.allclose(lengths, scale * steps, rtol=1e-9, atol=0)
    assert result.relation_defect < 1e-12
    assert result.not_positive == 0
    assert result.area_defect < 1e-12


def translation(result, halfedges) -> np.ndarray:
    near, far = lifted_edges(result)
    return (far - near)[halfedges, 1:].sum(axis=0)


def test_a_torus_of_revolution_has_the_modulus_of_calculus():
    """The metric is a multiple of du^2 + dw^2 with dw = r dv / (R + r cos v): sides 2 pi, 2 pi r / sqrt(R^2 - r^2)."""
    errors = []
    for n in (8, 16, 32):
        mesh = grid(2 * n, n)
        u, v = np.divmod(np.arange(2 * n * n), n)
        mesh = mesh.with_vertices(revolved(2.0, 1.0, np.pi * u / n, 2 * np.pi * v / n))
        result = harmonic(mesh, geometry(0), weights="cotangent")
        along = translation(result, [6 * i * n for i in range(2 * n)])
        across = -translation(result, [6 * j + 5 for j in range(n)])
        modulus = complex(*across) / complex(*along)
        errors.append(abs(modulus - 1j / np.sqrt(3)))
    assert errors[0] < 0.1
    assert errors[1] < errors[0] / 3.5
    assert errors[2] < errors[1] / 3.5


@pytest.mark.parametrize(("twisted", "turn"), [(False, 0.4), (True, 0.0)])
def test_no_other_lattice_has_less_energy(twisted, turn):
    """Energy over area, after linear maps near the identity that keep the group."""
    mesh = grid(6, 7, twisted=twisted)
    weights = np.random.default_rng(3).uniform(0.5, 2, mesh.edge_count)[mesh.edge]
    result = flat_map(mesh, weights)
    near, far = lifted_edges(result)
    edges = (far - near)[mesh.representative, 1:]

    def energy(shape):
        return weights[mesh.representative] @ np.linalg.norm(edges @ shape.T, axis=1) ** 2 / abs(np.linalg.det(shape))

    best = energy(np.eye(2))
    for stretch in (np.diag([1.01, 1]), np.diag([1, 1.01]), np.array([[1, turn * 0.01], [turn * 0.01, 1]])):
        assert energy(stretch) >= best * (1 - 1e-12)
    assert energy(np.diag([1.01, 1])) > best


def test_the_map_stays_harmonic_and_linear_on_lifts():
    mesh = connected_sum("PP")
    weights = np.random.default_rng(4).uniform(0.5, 2, mesh.edge_count)[mesh.edge]
    result = flat_map(mesh, weights)
    energy = HarmonicEnergy(result, weights)
    gradient = energy.gradient(energy.terms(result.points))
    assert np.abs(gradient).max() < 1e-9 * np.sqrt(result.orbifold.area)
    assert result.relation_defect < 1e-12
