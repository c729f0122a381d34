"""Lifts: each copy once, none missing, by closed form and by brute force."""

from __future__ import annotations

import numpy as np
import pytest
import reference_surfaces as surfaces

from orbiframe.orbifolds.atlas import Atlas
from orbiframe.orbifolds.orbifold import Orbifold


@pytest.mark.parametrize("radius", [0.3, 1.2, 3.3, 7.4])
@pytest.mark.parametrize("surface", [surfaces.torus, surfaces.klein_bottle])
def test_flat_lifts_are_the_lattice_points_in_a_disc(surface, radius: float) -> None:
    n = np.arange(-10, 11)
    expected = (n[:, None] ** 2 + n**2 <= radius**2).sum()
    patch, isometry = surface().lifts(0, radius)
    assert len(patch) == expected
    assert len(np.unique(np.round(isometry[:, 1:, 0], 6), axis=0)) == expected


def test_the_sphere_has_one_lift_and_the_projective_plane_two() -> None:
    assert len(surfaces.sphere().lifts(0, np.pi)[0]) == 1
    _, isometry = surfaces.projective_plane().lifts(0, np.pi)
    np.testing.assert_array_equal(isometry, [np.eye(3), -np.eye(3)])
    assert len(surfaces.projective_plane().lifts(0, 3.0)[0]) == 1


def test_octagon_lifts_are_all_words_whose_origin_lies_in_the_disc() -> None:
    orbifold = surfaces.octagon()
    geometry, radius = orbifold.geometry, 4.9
    # All tiles that share a corner with the octagon are words of up to 4 letters; their origins reach 2 circumradii.
    words = surfaces.brute_force_group(orbifold.atlas.isometry[1:], 4)
    inside = geometry.distance(geometry.origin, words[:, :, 0]) <= radius
    _, isometry = orbifold.lifts(0, radius)
    assert inside.sum() == len(isometry)
    apart = geometry.distance(isometry[:, None, :, 0], words[inside][None, :, :, 0])
    assert (apart.min(axis=1) < 1e-9).all()
    assert (apart.min(axis=0) < 1e-9).all()


def test_hyperbolic_lifts_grow_like_the_area_of_the_disc() -> None:
    """Published count of tiles against 2 pi (cosh R - 1) / (2 pi |chi|): 265 and 793 at R = 7 and 8 for genus 2."""
    count = [len(surfaces.octagon().lifts(0, r)[0]) for r in (7.0, 8.0)]
    np.testing.assert_allclose(count, (np.cosh([7.0, 8.0]) - 1) / 2, rtol=0.1)


@pytest.mark.parametrize("name", surfaces.ALL)
def test_first_lift_is_the_patch_itself(name: str) -> None:
    patch, isometry = surfaces.ALL[name]().lifts(0, 1.0)
    assert patch[0] == 0
    np.testing.assert_array_equal(isometry[0], np.eye(3))


def two_patches(name: str) -> Orbifold:
    orbifold = surfaces.ALL[name]()
    geometry = orbifold.geometry
    return surfaces.in_two_patches(orbifold, geometry.translation(0.4, 0.7) @ geometry.reflection(1.0))


@pytest.mark.parametrize("name", surfaces.ALL)
def test_lifts_do_not_depend_on_the_patches(name: str) -> None:
    """Patch 1 seen from patch 0 is g `change` for the lifts g of patch 0; the relation of one to two."""
    orbifold, plain = two_patches(name), surfaces.ALL[name]()
    geometry, radius = plain.geometry, 3.0
    patch, isometry = orbifold.lifts(0, radius)
    group = plain.lifts(0, radius)[1]
    assert (patch == 0).sum() == len(group)
    change = orbifold.atlas.isometry[1]
    moved = plain.lifts(0, radius + 0.5)[1] @ change
    moved = moved[geometry.distance(geometry.origin, moved[:, :, 0]) <= radius]
    assert (patch == 1).sum() == len(moved)
    apart = np.abs(isometry[patch == 1][:, None] - moved[None]).max(axis=(2, 3)).min(axis=1)
    assert apart.max() < 1e-9


def test_many_walks_at_once_agree_with_one_at_a_time() -> None:
    orbifold = two_patches("octagon")
    copies = orbifold.copies([1, 0, 1], [3.0, 2.0, 4.0])
    for base, (patch, radius) in enumerate([(1, 3.0), (0, 2.0), (1, 4.0)]):
        patches, isometry = orbifold.lifts(patch, radius)
        mine = copies.take(copies.base == base)
        np.testing.assert_array_equal(mine.patch[0], patch)
        assert len(mine.patch) == len(patches)
        apart = np.abs(mine.isometry[:, None] - isometry[None]).max(axis=(2, 3)).min(axis=1)
        assert apart.max() < 1e-9


def test_every_point_is_covered_by_some_lift() -> None:
    """A disc of radius 3 about the origin is covered by the lifts within 3 plus the circumradius."""
    orbifold = surfaces.octagon()
    geometry, rng = orbifold.geometry, np.random.default_rng(2)
    x = geometry.from_polar(3 * rng.random(500), rng.uniform(0, 7, 500))
    _, isometry = orbifold.lifts(0, 3 + surfaces.OCTAGON_RADIUS)
    nearest = geometry.distance(x[:, None], isometry[None, :, :, 0]).min(axis=1)
    assert nearest.max() <= surfaces.OCTAGON_RADIUS + 1e-12


def chequered(side: int, shift: float) -> tuple[Orbifold, np.ndarray]:
    """The torus in side x side squares that know their four neighbours alone, and the origins of their frames.

    The origin of a black square lies `shift` sides away from its middle: a neighbour of a white one may be far from it.
    """
    i, j = np.divmod(np.arange(side**2), side)
    away = (i + j) % 2 * shift / side
    origin = (np.stack([i, j], axis=1) + 0.5) / side + np.outer(away, [1.0, 1.0])
    ends, steps = [(-1, -1)], [np.eye(3)]
    for k in range(side**2):
        for across in ((1, 0), (0, 1), (-1, 0), (0, -1)):
            beyond = np.array([i[k], j[k]]) + across
            ends.append((k, int(beyond[0] % side * side + beyond[1] % side)))
            step = np.eye(3)
            step[1:, 0] = origin[ends[-1][1]] + beyond // side - origin[k]
            steps.append(step)
    tail, head = np.array(ends).T
    back = [0] + [1 + 4 * q + (n + 2) % 4 for n, q in zip(np.tile(range(4), side**2), head[1:], strict=True)]
    radius = np.sqrt(0.5) / side + np.sqrt(2) * away
    atlas = Atlas(surfaces.torus().geometry, radius, tail, head, np.array(back), np.array(steps))
    return Orbifold(atlas, 0, True, 1.0), origin


@pytest.mark.parametrize("radius", [0.2, 0.36, 0.6, 1.4])
def test_lifts_that_are_reached_only_through_patches_farther_out_are_found(radius: float) -> None:
    """Every square has one frame in each cell of the lattice: all of Z^2 is tried."""
    orbifold, origin = chequered(4, 0.49)
    n = np.arange(-5, 6)
    lattice = np.stack(np.meshgrid(n, n), axis=-1).reshape(-1, 2)
    for patch in range(16):
        found, isometry = orbifold.lifts(patch, radius)
        place = origin[:, None] + lattice - origin[patch]
        square, cell = np.nonzero(np.linalg.norm(place, axis=-1) <= radius)
        expected = np.column_stack([square, place[square, cell]])
        got = np.column_stack([found, isometry[:, 1:, 0]])
        assert len(np.unique(np.round(got, 6), axis=0)) == len(got) == len(expected)
        np.testing.assert_allclose(_sorted(got), _sorted(expected), atol=1e-9)


def _sorted(rows: np.ndarray) -> np.ndarray:
    return rows[np.lexsort(np.round(rows, 6).T)]
