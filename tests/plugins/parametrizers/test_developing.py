"""Layouts of circle packings as atlases: relations, embedding, twins, parity, patches, lengths and angles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.developing import developed, with_patch_radii
from reference_meshes import connected_sum, dataset, edge_lengths, geometry, grid, klein_quartic, lifted_edges, shuffled

from orbiframe import MapError, surface_type
from orbiframe.testing.lab import Lab
from orbiframe.testing.parametrizer_laws import patches_cover, transitions_form_a_cocycle


def layout(mesh, patch_radius=1.0):
    surface = surface_type(mesh)
    curvature = int(np.sign(surface.euler_characteristic))
    packing = packed(mesh, curvature)
    return packing, developed(
        mesh, geometry(curvature), packing.lengths, packing.angles, surface=surface, patch_radius=patch_radius
    )


def check(mesh, patch_radius=1.0, rounding=1e-13):
    packing, result = layout(mesh, patch_radius)
    atlas = result.orbifold.atlas
    assert result.relation_defect < rounding
    assert result.not_positive == 0
    assert result.area_defect < 1e-9
    assert np.array_equal(atlas.inverse[atlas.inverse], np.arange(len(atlas.inverse)))
    assert np.array_equal(atlas.tail[1:], atlas.head[atlas.inverse[1:]])
    assert np.abs(atlas.isometry @ atlas.isometry[atlas.inverse] - np.eye(3)).max() < 10 * rounding
    assert np.allclose(edge_lengths(result), packing.lengths, rtol=1e-8, atol=1e-11)
    assert result.orbifold.orientable == surface_type(mesh).orientable
    return result


@pytest.mark.parametrize("name", ["plate_genus2_coarse", "plate_genus2", "plate_genus3", "plate_genus5"])
def test_orientable_datasets(name):
    result = check(dataset(name))
    assert (np.linalg.det(result.orbifold.atlas.isometry) > 0).all()


@pytest.mark.parametrize("name", ["torus", "klein_bottle", "three_crosscaps"])
def test_flat_and_nonorientable_datasets(name):
    result = check(dataset(name))
    reversing = np.linalg.det(result.orbifold.atlas.isometry) < 0
    assert reversing.any() == (name != "torus")


@settings(max_examples=20, deadline=None)
@given(st.text("TP", min_size=2, max_size=10), st.integers(0, 40), st.integers(0, 2**32 - 1))
def test_random_surfaces(parts, moves, seed):
    # Products of three matrices with entries up to 10 have an error of 1000 eps.
    check(shuffled(connected_sum(parts), moves, np.random.default_rng(seed)), rounding=3e-13)


@pytest.mark.parametrize(("patch_radius", "rounding"), [(0.3, 1e-13), (3.0, 1e-10)])
def test_small_and_large_patches(patch_radius, rounding):
    """Rounding grows like cosh^2 of the transitions, which are twice as long as a patch."""
    check(dataset("plate_genus2"), patch_radius, rounding)
    check(dataset("three_crosscaps"), patch_radius, rounding)


def test_the_laws_of_the_atlas_hold(tmp_path):
    def component(mesh, plane, group):
        if plane.curvature > 0:
            raise MapError("no sphere")
        return layout(mesh)[1]

    transitions_form_a_cocycle(component, Lab(tmp_path))
    patches_cover(component, Lab(tmp_path))


def test_corner_angles_are_kept():
    """In the lifted triangles too seven equilateral ones meet at every vertex of the Klein quartic."""
    _, result = layout(klein_quartic())
    x, plane = result.lifts, result.orbifold.geometry
    for c in range(3):
        angle = plane.angle(x[:, c], x[:, (c + 1) % 3], x[:, (c + 2) % 3])
        assert np.allclose(angle, 2 * np.pi / 7, rtol=0, atol=1e-11)


def holonomy(result, walk) -> np.ndarray:
    """The product of the transitions of a closed walk of halfedges."""
    product = np.eye(3)
    for h in walk:
        product = product @ result.orbifold.atlas.isometry[result.transition[h]]
    return product


def grid_loops(along, across):
    """The halfedges from (0, 0) along, and from (0, 0) across, in `grid`."""
    first = [6 * (i * across) for i in range(along)]
    second = [6 * j + 5 for j in range(across)]
    return first, second


@pytest.mark.parametrize("patch_radius", [0.5, 1.0])
def test_holonomies_of_a_flat_torus_are_translations_that_commute(patch_radius):
    _, result = layout(grid(9, 6), patch_radius)
    loops = grid_loops(9, 6)
    mesh, back = result.polyhedron, result.orbifold.atlas.inverse
    a = holonomy(result, loops[0])
    # The loop across runs against its halfedges: 5 is the side from (i, j + 1) to (i, j).
    assert mesh.tail[loops[1][0]] == 1
    assert mesh.head[loops[1][0]] == 0
    b = np.linalg.multi_dot([result.orbifold.atlas.isometry[back[result.transition[h]]] for h in loops[1]])
    assert np.abs(a @ b - b @ a).max() < 1e-13
    for g in (a, b):
        assert np.abs(g[1:, 1:] - np.eye(2)).max() < 1e-13
    # Nine and six unit edges at an angle of 60 degrees, since diagonals of the squares have length one too.
    step = a[1:, 0] / 9
    assert np.linalg.norm(b[1:, 0]) == pytest.approx(6 * np.linalg.norm(step), rel=1e-12)
    assert step @ b[1:, 0] / (6 * step @ step) == pytest.approx(-0.5, rel=1e-11)


def test_the_closed_walk_of_a_klein_bottle_is_a_glide():
    _, result = layout(grid(8, 6, twisted=True))
    g = holonomy(result, grid_loops(8, 6)[0])
    assert np.linalg.det(g) == pytest.approx(-1)
    assert np.linalg.norm((g @ g)[1:, 0]) > 1


def test_an_edge_that_leaves_the_plane_is_named():
    _, result = layout(dataset("plate_genus2_coarse"))
    points = result.points.copy()
    points[0] = np.inf
    with np.errstate(invalid="ignore"), pytest.raises(MapError, match="an edge is too long"):
        with_patch_radii(replace(result, points=points))


def test_radii_are_reached():
    """No patch is larger than it must be: some corner lies at its radius."""
    _, result = layout(dataset("plate_genus3"))
    near, far = lifted_edges(result)
    plane, atlas = result.orbifold.geometry, result.orbifold.atlas
    patch = result.patch[result.polyhedron.tail]
    reached = np.zeros(atlas.patch_count)
    for x in (near, far):
        np.maximum.at(reached, patch, plane.distance(plane.origin, x))
    assert np.allclose(reached, atlas.radius, rtol=1e-12)
