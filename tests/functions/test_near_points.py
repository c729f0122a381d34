"""Points far from their patch: values and derivatives are those of the same point seen from nearby."""

from __future__ import annotations

import numpy as np
import pytest
import reference_surfaces as surfaces
from orbiframe_bases.gaussian import Gaussian

from orbiframe import Points
from orbiframe.functions import near_points as module
from orbiframe.functions.near_points import near_points

NAMES = ["octagon", "klein_bottle"]


def moved(triangulation, seed=0):
    """Points of a surface of one patch, and the same points beyond some side: both and the isometries between them."""
    atlas, rng = triangulation.orbifold.atlas, np.random.default_rng(seed)
    face = rng.integers(triangulation.polyhedron.face_count, size=40)
    points = triangulation.locate(face, rng.dirichlet(np.ones(3), 40))
    way = rng.integers(1, len(atlas.head), size=40)
    x = atlas.geometry.settle(atlas.geometry.act(atlas.isometry[way], points.x))
    return points, Points(atlas.tail[way], x), atlas.isometry[way]


@pytest.mark.parametrize("name", NAMES)
def test_points_come_back_within_their_patch(name):
    triangulation = surfaces.triangulated(name, 2)
    orbifold = triangulation.orbifold
    _, there, _ = moved(triangulation)
    near, turn = near_points(orbifold, there)
    distance = orbifold.geometry.distance(orbifold.geometry.origin, near.x)
    assert (distance <= orbifold.atlas.radius[near.patch] * (1 + 1e-8)).all()
    assert turn is not None
    np.testing.assert_allclose(turn @ np.swapaxes(turn, 1, 2), np.tile(np.eye(2), (40, 1, 1)), atol=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_near_points_stay_to_the_bit(name):
    triangulation = surfaces.triangulated(name, 2)
    points, _, _ = moved(triangulation)
    near, turn = near_points(triangulation.orbifold, points)
    assert turn is None
    assert near is points


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_turn_with_the_frame(name, monkeypatch):
    triangulation = surfaces.triangulated(name, 2)
    geometry = triangulation.orbifold.geometry
    basis = Gaussian(triangulation.orbifold, triangulation, size=30)
    here, there, g = moved(triangulation)
    own, carried = geometry.frame(there.x), g @ geometry.frame(here.x)
    frame = np.array([[geometry.inner(there.x, own[..., i], carried[..., j]) for j in (0, 1)] for i in (0, 1)])

    def slopes(points):
        return np.stack([m.toarray() for m in basis.jet_matrices(points, 1)[1:]])

    wanted = np.einsum("ijn,jnk->ink", frame, slopes(here))
    np.testing.assert_allclose(slopes(there), wanted, atol=1e-7 * np.abs(wanted).max())
    monkeypatch.setattr(module, "_turned", lambda orbifold, x, y, way: np.tile(np.eye(2), (len(x), 1, 1)))
    assert np.abs(slopes(there) - wanted).max() > 1e-2 * np.abs(wanted).max()
