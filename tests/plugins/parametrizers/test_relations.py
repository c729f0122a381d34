"""Projection onto the relations: perturbed transitions come back, and only as far as they were moved."""

from __future__ import annotations

import numpy as np
import pytest
from orbiframe_parametrizers import relations
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.developing import developed
from orbiframe_parametrizers.relations import with_relations
from reference_meshes import dataset, geometry
from scipy.linalg import expm

from orbiframe import surface_type

NAMES = ("plate_genus2", "plate_genus5", "three_crosscaps", "torus", "klein_bottle")


def layout(name):
    mesh = dataset(name)
    surface = surface_type(mesh)
    curvature = int(np.sign(surface.euler_characteristic))
    packing = packed(mesh, curvature)
    scale = 1.0 if curvature else 3.0 / packing.lengths.max()
    lengths = scale * packing.lengths
    return developed(mesh, geometry(curvature), lengths, packing.angles, surface=surface, patch_radius=1.0)


def perturbed(plane, isometry, size, rng):
    xi = size * rng.normal(size=(len(isometry) // 2, 3))
    moved = plane.nearest_isometry(isometry[1::2] @ np.array([expm(m) for m in relations._algebra(plane, xi)]))
    noisy = isometry.copy()
    noisy[1::2], noisy[2::2] = moved, plane.inverse(moved)
    return noisy


def defect(isometry, transition) -> float:
    g = isometry[transition.reshape(-1, 3)]
    return float(np.abs(g[:, 0] @ g[:, 1] @ g[:, 2] - np.eye(3)).max())


@pytest.mark.parametrize("name", NAMES)
def test_perturbed_transitions_are_brought_back(name):
    result = layout(name)
    atlas, transition = result.orbifold.atlas, result.transition
    noisy = perturbed(atlas.geometry, atlas.isometry, 1e-6, np.random.default_rng(3))
    assert defect(noisy, transition) > 1e-7
    mended = with_relations(atlas.geometry, transition, noisy)
    assert defect(mended, transition) < 4e-14
    assert atlas.geometry.isometry_defect(mended).max() < 1e-13
    assert np.abs(mended - noisy).max() < 1e-4
    assert np.abs(mended @ mended[atlas.inverse] - np.eye(3)).max() < 1e-13


@pytest.mark.parametrize("name", NAMES)
def test_matrices_off_the_group_are_brought_back(name):
    """Long products leave the group, and no correction within it helps."""
    result = layout(name)
    atlas, rng = result.orbifold.atlas, np.random.default_rng(5)
    noisy = atlas.isometry.copy()
    noisy[1::2] += 1e-8 * rng.normal(size=noisy[1::2].shape)
    noisy[2::2] = atlas.geometry.inverse(noisy[1::2])
    assert atlas.geometry.isometry_defect(noisy).max() > 1e-8
    mended = with_relations(atlas.geometry, result.transition, noisy)
    assert defect(mended, result.transition) < 1e-13
    assert atlas.geometry.isometry_defect(mended).max() < 1e-13


@pytest.mark.parametrize("name", NAMES)
def test_iteration_finds_what_the_factors_find(name, monkeypatch):
    """Also where a relation says nothing, g e g^-1 = e, whose row is zero."""
    result = layout(name)
    atlas, transition = result.orbifold.atlas, result.transition
    one = 1 + int(np.flatnonzero(atlas.inverse[1:] != np.arange(1, len(atlas.inverse)))[0])
    transition = np.concatenate([transition, [one, 0, atlas.inverse[one]]])
    noisy = perturbed(atlas.geometry, atlas.isometry, 1e-6, np.random.default_rng(3))
    by_factors = with_relations(atlas.geometry, transition, noisy)
    monkeypatch.setattr(relations, "_FACTORED", 0)
    by_iteration = with_relations(atlas.geometry, transition, noisy)
    assert defect(by_iteration, transition) < 5e-14
    assert np.abs(by_iteration - by_factors).max() < 1e-9


@pytest.mark.parametrize("name", NAMES)
def test_transitions_without_defect_stay_and_nothing_is_solved(name, monkeypatch):
    result = layout(name)
    atlas = result.orbifold.atlas
    monkeypatch.setattr(relations, "_least_squares", None)
    again = with_relations(atlas.geometry, result.transition, atlas.isometry)
    assert np.array_equal(again, atlas.isometry)


def test_without_relations_nothing_moves():
    isometry = np.stack([np.eye(3)] * 3)
    assert with_relations(geometry(-1), np.zeros(12, dtype=np.intp), isometry) is isometry


@pytest.mark.parametrize("curvature", [-1, 0, 1])
def test_the_algebra_generates_isometries(curvature):
    plane, xi = geometry(curvature), np.array([0.3, -0.4, 0.5])
    g = expm(relations._algebra(plane, xi))
    assert plane.isometry_defect(g) < 1e-14
    assert np.allclose(relations._algebra_coordinates(relations._algebra(plane, xi)), xi)
    straight = expm(relations._algebra(plane, np.array([0.0, 0.3, 0.4])))
    assert np.allclose(straight[:, 0], plane.from_polar(0.5, np.arctan2(0.4, 0.3)))
    assert np.allclose(expm(relations._algebra(plane, np.array([0.7, 0.0, 0.0]))), plane.rotation(0.7))


@pytest.mark.parametrize("curvature", [-1, 0, 1])
def test_the_adjoint_carries_generators(curvature):
    plane, xi = geometry(curvature), np.array([0.3, -0.4, 0.5])
    g = plane.translation(0.8, 1.0) @ plane.reflection(0.3)
    carried = expm(relations._algebra(plane, relations._adjoint(plane, g[None])[0] @ xi))
    assert np.allclose(carried, g @ expm(relations._algebra(plane, xi)) @ plane.inverse(g), atol=1e-13)
