"""Lifted centres: every image that reaches a patch and no other, walked once, as many as discs and patches ask for."""

from __future__ import annotations

import hard_surfaces as hard
import numpy as np
import pytest
from fitted import REGISTRY

from orbiframe.functions import lifted_centres
from orbiframe.functions.lifted_centres import LiftedCentres
from orbiframe.functions.orbit_sum import in_blocks
from orbiframe.meshes.surface_type import surface_type
from orbiframe.orbifolds.atlas import Points
from orbiframe.triangulations.triangulation import Triangulation

SHAPES = {
    "torus": lambda: hard.plate(1, 1, 3),
    "genus 4": lambda: hard.plate(2, 2, 2),
    "4 crosscaps": lambda: hard.crosscaps(4, 3),
    "genus 16": lambda: hard.plate(4, 4),
}


def map_of(name: str) -> Triangulation:
    mesh = SHAPES[name]()
    geometry = REGISTRY.geometry(surface_type(mesh).euler_characteristic)
    return REGISTRY.load("parametrizer", "harmonic")(mesh, geometry)


def centres_of(made: Triangulation, count: int) -> LiftedCentres:
    """Some vertices as centres, with supports about as wide as those of a fit, each different."""
    rng = np.random.default_rng(5)
    chosen = rng.permutation(len(made.points))[:count]
    support = made.orbifold.area / count * rng.uniform(0.5, 3.0, count)
    return LiftedCentres(made.orbifold, Points(made.patch[chosen], made.points[chosen]), support)


def reach(lifted: LiftedCentres) -> np.ndarray:
    half = np.sqrt(lifted.support / 2)
    return 2 * (half if lifted.orbifold.geometry.curvature == 0 else np.arcsinh(half))


@pytest.mark.parametrize("name", SHAPES)
def test_images_are_the_lifts_of_a_long_walk_that_reach_the_patch(name: str) -> None:
    """Against copies of patches within a radius that is far too large: all that reach, each once, and no other."""
    made = map_of(name)
    orbifold, geometry = made.orbifold, made.orbifold.geometry
    lifted = centres_of(made, 12)
    far, radius = reach(lifted), orbifold.atlas.radius
    for patch in range(0, orbifold.atlas.patch_count, 1 + orbifold.atlas.patch_count // 6):
        patches, isometry = orbifold.lifts(patch, radius[patch] + far.max() + radius.max() + 0.1)
        copy, centre = np.nonzero(patches[:, None] == lifted.centres.patch)
        x = geometry.settle(geometry.act(isometry[copy], lifted.centres.x[centre]))
        near = geometry.distance(geometry.origin, x) <= radius[patch] + far[centre]
        (images,) = lifted.seen_from(np.array([patch]), np.zeros(1))
        assert np.bincount(images.column, minlength=12).tolist() == np.bincount(centre[near], minlength=12).tolist()
        apart = geometry.distance(images.x[:, None], x[near][None])
        apart[images.column[:, None] != centre[near]] = np.inf
        assert apart.min(axis=1).max(initial=0) < 1e-9
        assert apart.min(axis=0).max(initial=0) < 1e-9


def test_points_far_beyond_their_patch_see_all_that_reaches_them() -> None:
    """The same points seen from another patch, a transition away, have the same pairs."""
    made = map_of("genus 4")
    atlas, geometry = made.orbifold.atlas, made.orbifold.geometry
    lifted = centres_of(made, 30)
    step = 1
    here = np.flatnonzero(made.patch == atlas.head[step])
    there = geometry.settle(geometry.act(atlas.isometry[step], made.points[here]))
    own = Points(made.patch[here], made.points[here])
    moved = Points(np.full(len(here), atlas.tail[step]), there)

    def columns(points: Points) -> list[list[int]]:
        lists: list[list[int]] = [[] for _ in here]
        for block in in_blocks(lifted, points, lambda pairs: pairs):
            for row, first, last in zip(block.rows, block.start, block.start[1:], strict=False):
                lists[row] = block.column[first:last].tolist()
        return lists

    assert columns(own) == columns(moved)


def test_the_walk_is_walked_once(monkeypatch) -> None:
    made, walks = map_of("genus 4"), []
    walk = lifted_centres._leave_images
    monkeypatch.setattr(lifted_centres, "_leave_images", lambda *args: walks.append(1) or walk(*args))
    lifted = centres_of(made, 30)
    for _ in range(3):
        list(in_blocks(lifted, Points(made.patch, made.points), lambda pairs: pairs))
    assert len(walks) == 1


def test_the_walk_visits_little_that_no_centre_reaches(monkeypatch) -> None:
    """Images that are kept against places that the walk went through: the limits are tight."""
    made = map_of("genus 16")
    lifted = centres_of(made, 40)
    counts = []
    walk = lifted_centres._leave_images

    def everywhere(curvature, begins, leads, moves, x, patch, reaches, disc, passed):
        counts.append(len(walk(curvature, begins, leads, moves, x, patch, reaches, passed, passed)[0]))
        return walk(curvature, begins, leads, moves, x, patch, reaches, disc, passed)

    monkeypatch.setattr(lifted_centres, "_leave_images", everywhere)
    images, _ = lifted._kept
    assert counts[0] < 2.5 * len(images.column)
