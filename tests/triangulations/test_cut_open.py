"""X/H cut open: a fundamental domain of triangles, each of them once."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fitted import fitted_linearly
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.triangulations.cut_open import Unrolled, unrolled
from orbiframe.triangulations.triangulation import Triangulation

OPENED = ["torus.off", "klein_bottle.off", "projective_plane.off", "plate_genus2.off", "three_crosscaps.off"]
NAMES = [*OPENED, "sphere.off", "plate_genus5.off"]


def triangulation(name: str) -> Triangulation:
    return fitted_linearly(name).surface.triangulation


def corners(map: Triangulation, found: Unrolled) -> np.ndarray:
    return np.einsum("fij,fcj->fci", found.placement, map.lifts)


def euler_characteristic(map: Triangulation, found: Unrolled) -> int:
    """Of the triangles, glued along the edges that are joined."""
    p = map.polyhedron
    h = np.flatnonzero(found.joined)
    tails = np.where(p.same[h], p.twin[h], p.next[p.twin[h]])
    heads = np.where(p.same[h], p.next[p.twin[h]], p.twin[h])
    rows, columns = np.concatenate([h, p.next[h]]), np.concatenate([tails, heads])
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(p.tail), len(p.tail)))
    vertices = connected_components(graph, directed=False)[0]
    return vertices - (len(p.tail) - len(h) // 2) + p.face_count


@pytest.mark.parametrize("name", NAMES)
def test_the_domain_is_a_disc_whose_triangles_meet_at_joined_edges(name):
    map = triangulation(name)
    found, p, geometry = unrolled(map), map.polyhedron, map.orbifold.geometry
    assert euler_characteristic(map, found) == (2 if name == "sphere.off" else 1)
    x = corners(map, found)
    h = np.flatnonzero(found.joined & ~p.same)
    tail, twin_head = x.reshape(-1, 3)[h], x.reshape(-1, 3)[p.next[p.twin[h]]]
    assert np.abs(geometry.distance(tail, twin_head)).max() < 1e-10
    assert np.array_equal(found.joined, found.joined[p.twin])
    assert geometry.isometry_defect(found.placement).max() < 1e-11


@pytest.mark.parametrize("name", OPENED)
def test_every_point_of_the_domain_lies_in_one_triangle(name):
    """Monte Carlo in the projective model, where triangles are straight: the covered share is the area of X/H."""
    map = triangulation(name)
    x = corners(map, unrolled(map))
    centre = map.orbifold.geometry.project(x.sum(axis=1))[::37]
    # Triple products, positive on one side of a plane through an edge.
    sides = [np.einsum("fi,ni->nf", np.cross(x[:, k], x[:, (k + 1) % 3]), centre) for k in range(3)]
    turn = np.sign(np.linalg.det(x))
    inside = np.all([side * turn > 0 for side in sides], axis=0)
    assert (inside.sum(axis=1) == 1).all()
    assert math.isclose(np.abs(map.areas).sum(), map.orbifold.area, rel_tol=1e-9)


@pytest.mark.parametrize("name", OPENED)
def test_the_domain_is_about_as_small_as_that_of_dirichlet(name):
    """Its points lie not much farther out than those of a disc of its area."""
    map = triangulation(name)
    geometry = map.orbifold.geometry
    x = corners(map, unrolled(map))
    far = geometry.distance(geometry.origin, geometry.project(x.sum(axis=1)))
    # Ways along triangles are longer than geodesics; by a third at most, in meshes of triangles that are not thin.
    area, curvature = map.orbifold.area, geometry.curvature
    disc = {1: lambda a: math.acos(1 - a / 2 / math.pi), 0: lambda a: math.sqrt(a / math.pi)}
    least = disc.get(curvature, lambda a: math.acosh(1 + a / 2 / math.pi))(area)
    assert 0.9 * least < far.max() < 2.2 * least


def test_groups_are_not_cut_apart():
    map = triangulation("plate_genus2.off")
    p = map.polyhedron
    apart = unrolled(map)
    band = np.flatnonzero(~apart.joined)[0]
    group = np.arange(p.face_count)
    group[p.face[p.twin[band]]] = group[p.face[band]]
    found = unrolled(map, group)
    assert found.joined[band]
    assert euler_characteristic(map, found) == 1


def test_far_corners_keep_their_digits():
    """Neighbours in a domain of genus 5 agree to rounding times e^R, not to rounding times e^2R."""
    map = triangulation("plate_genus5.off")
    geometry, found = map.orbifold.geometry, unrolled(map)
    x = corners(map, found)
    radius = geometry.distance(geometry.origin, x).max()
    p = map.polyhedron
    h = np.flatnonzero(found.joined & ~p.same)
    gap = geometry.distance(x.reshape(-1, 3)[h], x.reshape(-1, 3)[p.next[p.twin[h]]]).max()
    assert gap < 200 * np.finfo(float).eps * math.exp(radius)
