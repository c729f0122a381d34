"""Principal curvature: against the fundamental forms in other coordinates, and against differences along curves."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import fitted

from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.principal import PrincipalCurvature, principal_curvature

NAMES = ["tetrahedron", "torus", "Klein bottle", "double torus"]


def places(name: str, count: int = 60):
    surface = fitted(name, 60).surface
    rng = np.random.default_rng(1)
    face = rng.integers(surface.refinement.coarse.face_count, size=count)
    return surface, surface.points(face, rng.dirichlet([1, 1, 1], size=count))


@pytest.mark.parametrize("name", NAMES)
def test_product_and_mean_are_those_of_the_two_forms(name: str) -> None:
    surface, points = places(name)
    found, forms = principal_curvature(surface, points), surface.curvature(points)
    size = np.maximum(np.abs(found.most), np.abs(found.least))
    assert (np.abs(found.most * found.least - forms.gaussian) <= 1e-9 * size**2).all()
    assert (np.abs((found.most + found.least) / 2 - forms.mean) <= 1e-9 * size).all()
    np.testing.assert_allclose(found.normal, forms.normal, atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_directions_are_orthonormal_and_bend_as_their_curvatures_say(name: str) -> None:
    """The normal turns along a principal direction by -k times the direction (Rodrigues), by differences in X."""
    surface, points = places(name)
    found = principal_curvature(surface, points)
    frame = np.stack([found.along_most, found.along_least, found.normal], axis=1)
    np.testing.assert_allclose(frame @ np.swapaxes(frame, 1, 2), np.tile(np.eye(3), (len(frame), 1, 1)), atol=1e-12)
    geometry, jet, h = surface.orbifold.geometry, surface.jet(points), 1e-4
    for direction, bend in ((found.along_most, found.most), (found.along_least, found.least)):
        inverse = np.linalg.pinv(np.swapaxes(jet.first, 1, 2))
        step = np.einsum("nij,nj->ni", inverse, direction)
        step *= (h / np.linalg.norm(step, axis=1))[:, None]
        velocity = np.einsum("nij,nj->ni", geometry.frame(points.x), step)
        ends = [Points(points.patch, geometry.exp(points.x, s * velocity)) for s in (1, -1)]
        turn = surface.normals(ends[0]) - surface.normals(ends[1])
        way = surface.evaluate(ends[0]) - surface.evaluate(ends[1])
        length = np.einsum("ni,ni->n", way, direction)
        size = np.maximum(np.abs(found.most), np.abs(found.least))
        error = np.abs(turn + bend[:, None] * way) / (np.abs(length) * size)[:, None]
        assert np.quantile(error, 0.9) < 1e-4


def test_turned_normals_swap_and_negate() -> None:
    surface, points = places("torus")
    found = principal_curvature(surface, points)
    back = found.turned(-np.ones(len(found.most)))
    assert isinstance(back, PrincipalCurvature)
    np.testing.assert_array_equal(back.most, -found.least)
    np.testing.assert_array_equal(back.along_most, found.along_least)
    np.testing.assert_array_equal(back.normal, -found.normal)
    assert (back.most >= back.least).all()
