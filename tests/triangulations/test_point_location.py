"""Location of points of X/H: the triangle and the lift do not depend on where the point is seen from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import reference_surfaces as surfaces
import spline_checks as checks

from orbiframe import FitError, Points
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe.triangulations.point_location import Locator

each_domain = pytest.mark.parametrize("name", list(checks.MAKERS))


def points_inside(domain: GeodesicTriangulation, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Random points well inside of random triangles, in the frames of the triangles."""
    rng = np.random.default_rng(0)
    face = rng.integers(domain.face_count, size=count)
    share = 0.02 + 0.94 * rng.dirichlet(np.ones(3), size=count)
    return face, domain.geometry.project(np.einsum("nc,nci->ni", share, domain.corners[face]))


def located(domain: GeodesicTriangulation, points: Points, *, frames: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Triangles and columns in the order of the points."""
    found = Locator(domain).locate(points, frames=frames)
    back = np.argsort(found.order)
    return found.face[back], found.columns[back]


def sizes(isometry: np.ndarray) -> np.ndarray:
    """By how much the error of coordinates grows on the way there and back, (n,)."""
    return 10 + np.abs(isometry).max(axis=(1, 2)) ** 2


def words(domain: GeodesicTriangulation, count: int, length: int) -> np.ndarray:
    """Random products of transitions, (count, 3, 3); all patches are one here."""
    steps = domain.orbifold.atlas.isometry
    choice = np.random.default_rng(1).integers(len(steps), size=(count, length))
    found = np.tile(np.eye(3), (count, 1, 1))
    for k in range(length):
        found = found @ steps[choice[:, k]]
    return found


@each_domain
@pytest.mark.parametrize("length", [0, 1, 2, 3])
def test_points_moved_by_the_group_come_back_to_their_lift(name: str, length: int) -> None:
    domain = checks.domain(name)
    face, x = points_inside(domain, 200)
    word = words(domain, len(face), length)
    moved = np.einsum("nij,njk,nk->ni", word, domain.placement[face], x)
    found, lift = located(domain, Points(domain.patch[face], moved))
    np.testing.assert_array_equal(found, face)
    error = np.abs(lift[:, :, 0] - x).max(axis=1)
    assert (error < 1e-12 * sizes(word @ domain.placement[face])).all()


@each_domain
def test_frames_are_carried_along(name: str) -> None:
    """The frame at a point arrives as the image of the frame by one isometry, the same that moves the point."""
    domain, geometry = checks.domain(name), checks.domain(name).geometry
    face, x = points_inside(domain, 50)
    there = words(domain, len(face), 1) @ domain.placement[face]
    moved = np.einsum("nij,nj->ni", there, x)
    found, columns = located(domain, Points(domain.patch[face], geometry.settle(moved)), frames=True)
    np.testing.assert_array_equal(found, face)
    assert (np.abs(columns[:, :, 0] - x).max(axis=1) < 1e-12 * sizes(there)).all()
    assert (geometry.isometry_defect(columns) < 1e-11 * sizes(there)).all()


@each_domain
def test_corners_and_edges_belong_to_some_triangle(name: str) -> None:
    domain = checks.domain(name)
    middle = domain.geometry.project(domain.corners + np.roll(domain.corners, -1, axis=1))
    x = np.einsum("fij,fcj->fci", domain.placement, np.concatenate([domain.corners, middle], axis=1)).reshape(-1, 3)
    face, lift = located(domain, Points(np.repeat(domain.patch, 6), x))
    share = np.linalg.solve(np.swapaxes(domain.corners[face], 1, 2), lift)
    assert share.min() > -1e-9


def test_a_refined_triangle_lies_in_its_parent() -> None:
    domain = checks.domain("Bolza")
    fine = domain.refined()
    face, x = points_inside(fine, 3000)
    points = Points(fine.patch[face], np.einsum("nij,nj->ni", fine.placement[face], x))
    np.testing.assert_array_equal(located(domain, points)[0], face // 4)


@pytest.mark.parametrize("place", range(3))
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_points_that_are_not_finite(bad: float, place: int) -> None:
    domain = checks.domain("torus")
    x = np.array([[1.0, 0.1, 0.1], [1.0, 0.1, 0.0]])
    x[1, place] = bad
    with pytest.raises(FitError, match="point 1"):
        Locator(domain).locate(Points(np.zeros(2, dtype=np.intp), x))


def test_a_patch_without_triangles_starts_from_those_of_its_neighbour() -> None:
    """All triangles are placed in patch 0, the first of them is number 0."""
    domain = checks.domain("torus")
    change = domain.geometry.translation(0.05, 0.5)
    two = surfaces.in_two_patches(domain.orbifold, change)
    both = replace(domain, orbifold=two)
    face, x = points_inside(domain, 200)
    here = np.einsum("nij,nj->ni", domain.placement[face], x)
    for patch, moved in ((0, here), (1, here @ domain.geometry.inverse(change).T)):
        found, _ = located(both, Points(np.full(200, patch), moved))
        np.testing.assert_array_equal(found, face)
