"""Even meshes on the smooth surface: angles, topology, and vertices that lie on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from creased import fitted_with_creases, mesh_of
from fitted import fitted
from orbiframe_remeshing import even_sites, relaxation, remeshing, surface_mesh
from orbiframe_remeshing.even_sites import scattered, surface_area
from orbiframe_remeshing.lifted_edges import lifted
from orbiframe_remeshing.quality import quality
from orbiframe_remeshing.remeshing import Wanted, remeshed
from scipy.spatial import cKDTree

from orbiframe import FitError, Points, UsageError
from orbiframe.functions import foot_points
from orbiframe.meshes import require_closed_surface
from orbiframe.meshes.bending import bending
from orbiframe.meshes.sizes import vector_areas

SHAPES = ["plate_genus2_coarse.off", "torus.off", "klein_bottle.off", "projective_plane.off", "cube.off"]


@pytest.mark.parametrize("name", SHAPES)
def test_triangles_are_even_closed_and_of_the_topology(name):
    surface = fitted(name).surface
    mesh = remeshed(surface, 600)
    found, told = quality(mesh), require_closed_surface(mesh)
    assert len(mesh.vertices) == 600
    assert told.euler_characteristic == surface.orbifold.euler_characteristic
    assert told.orientable == surface.orbifold.orientable
    assert found["angles"]["least"] >= 25
    assert found["angles"]["mean_of_least"] > 46
    assert found["regular"] > 0.93
    assert found["edges"]["deviation"] < 0.2 * found["edges"]["mean"]


@pytest.mark.parametrize("name", ["plate_genus2_coarse.off", "klein_bottle.off"])
def test_vertices_lie_on_the_surface(name):
    """The nearest point of the surface, looked for from a fine mesh on it, is as near as rounding allows."""
    surface = fitted(name).surface
    mesh = remeshed(surface, 300)
    start = surface.triangulation
    corners = surface.basis.values(Points(start.patch, start.points), surface.coefficients)
    place = (mesh.vertices - surface.origin) / surface.scale
    # Where the surface passes through itself the nearest vertex of the map may lie on another sheet.
    nearest = cKDTree(corners).query(place, 12)[1].ravel()
    first, targets = Points(start.patch[nearest], start.points[nearest]), np.repeat(place, 12, axis=0)
    distance = foot_points(surface.basis, surface.coefficients, first, targets, 0.05, steps=20)[1]
    assert distance.reshape(-1, 12).min(axis=1).max() < 1e-9


def test_normals_look_outward_and_are_those_of_the_surface():
    mesh = remeshed(fitted("round sphere", 300).surface, 400)
    outward = mesh.vertices / np.linalg.norm(mesh.vertices, axis=1, keepdims=True)
    assert np.einsum("vi,vi->v", outward, mesh.normals).min() > 0.999
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    assert (np.einsum("fi,fi->f", np.cross(b - a, c - a), a) > 0).all()


def test_random_sites_are_spread_by_area_in_space():
    """Of a torus of radii 3 and 1 the outer half has (pi R + 2 r) / (2 pi R) of the area 4 pi^2 R r."""
    surface = fitted("round torus", 300).surface
    assert surface_area(surface) == pytest.approx(4 * np.pi**2 * 3, rel=3e-3)
    x = surface.evaluate(scattered(surface, 6000, seed=1))
    outside = np.hypot(x[:, 0], x[:, 1]) > 3
    assert outside.mean() == pytest.approx((3 * np.pi + 2) / (6 * np.pi), abs=0.01)
    with_other_seed = surface.evaluate(scattered(surface, 6000, seed=2))
    assert np.abs(x - with_other_seed).max() > 0.01


def test_edges_are_as_long_as_asked_for():
    surface = fitted("round torus", 300).surface
    for length, quads in ((0.3, False), (0.5, True)):
        count = Wanted(length, None, quads).total(surface_area(surface))
        found = quality(remeshed(surface, count, quads=quads))
        assert found["edges"]["mean"] == pytest.approx(length, rel=0.06)


@pytest.mark.parametrize("name", ["plate_genus2_coarse.off", "klein_bottle.off", "cube.off"])
def test_quadrilaterals_are_three_of_each_triangle(name):
    surface = fitted(name).surface
    chi = surface.orbifold.euler_characteristic
    mesh = remeshed(surface, 1500, quads=True)
    told = require_closed_surface(mesh)
    assert (told.euler_characteristic, told.orientable) == (chi, surface.orbifold.orientable)
    assert set(mesh.face_sizes.tolist()) == {4}
    corners = round((1500 + 5 * chi) / 6)
    assert (len(mesh.vertices), mesh.face_count) == (6 * corners - 5 * chi, 6 * (corners - chi))
    found = quality(mesh)
    assert found["angles"]["mean_of_least"] > 54
    assert found["angles"]["small"] < 0.03 * mesh.face_count


def test_the_nearest_lift_is_that_of_all_copies():
    """Against every copy of the patch within a large radius, one edge after the other."""
    surface = fitted("plate_genus2_coarse.off").surface
    orbifold, points = surface.orbifold, scattered(surface, 60, seed=4)
    tail, head = np.arange(30), np.arange(30, 60)
    x = surface.evaluate(points)
    head = np.array([30 + np.linalg.norm(x[30:] - x[i], axis=1).argmin() for i in tail])
    found = lifted(orbifold, points, tail, head)
    for i, j, place in zip(tail, head, found, strict=True):
        patch, isometry = orbifold.lifts(int(points.patch[i]), 6.0)
        copies = orbifold.geometry.act(isometry[patch == points.patch[j]], points.x[j])
        least = orbifold.geometry.distance(points.x[i], copies).min()
        assert orbifold.geometry.distance(points.x[i], place) == pytest.approx(least, abs=1e-9)


@pytest.mark.parametrize("quads", [False, True])
def test_the_unit_is_that_of_the_mesh(quads):
    surface = fitted("cube.off").surface
    metres = replace(surface.refinement.coarse, unit="metre")
    surface = replace(surface, refinement=replace(surface.refinement, coarse=metres))
    assert remeshed(surface, 150, quads=quads).unit == "metre"


def test_the_same_seed_gives_the_same_mesh():
    surface = fitted("cube.off").surface
    one, two, other = (remeshed(surface, 200, seed=seed).vertices for seed in (0, 0, 1))
    assert np.array_equal(one, two)
    assert not np.array_equal(one, other)


def test_the_surface_is_evaluated_a_few_dozen_times_at_each_vertex(monkeypatch):
    """What costs time is the functions: six steps of Lloyd, fifteen in space, and trials at poor triangles only."""
    surface, seen = fitted("plate_genus2_coarse.off").surface, [0]
    for module in (even_sites, relaxation, surface_mesh):
        plain = module.jets_at

        def counted(surface, points, plain=plain):
            seen[0] += len(points.patch)
            return plain(surface, points)

        monkeypatch.setattr(module, "jets_at", counted)
    remeshed(surface, 500)
    assert 15 * 500 < seen[0] < 30 * 500


def test_numbers_that_no_mesh_has():
    for wanted in ({"edge_length": 0.0}, {"edge_length": float("nan")}, {"vertices": 3}, {"vertices": 10**9}):
        with pytest.raises(UsageError, match="give"):
            Wanted(**wanted)
    for length in (1e-6, 50.0):
        with pytest.raises(FitError, match="makes about"):
            Wanted(length).total(20.0)
    with pytest.raises(FitError, match="take more"):
        remeshed(fitted("plate_genus2_coarse.off").surface, 6)


def test_a_mesh_of_another_topology_is_refused(monkeypatch):
    surface = fitted("cube.off").surface
    other = remeshed(fitted("torus.off").surface, 300)
    monkeypatch.setattr(remeshing, "relaxed", lambda _: type("Mesh", (), {"polyhedron": lambda self: other})())
    with pytest.raises(FitError, match="not the surface"):
        remeshed(surface, 300)


# ---- creases --------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def creased():
    return fitted_with_creases("plate_genus2_coarse.off", size=600).surface


def test_creases_are_edges_of_the_triangles(creased):
    """Edges that bend by more than 45 degrees are as long together as those of the plate, and at right angles."""
    mesh = remeshed(creased, 500)
    bends, plate = bending(mesh).angle, mesh_of("plate_genus2_coarse.off")
    sharp = [(m.edge_lengths * (bending(m).angle > np.pi / 4)).sum() for m in (mesh, plate)]
    assert sharp[0] == pytest.approx(sharp[1], rel=1e-4)
    assert ((bends < 0.02) | (np.abs(bends - np.pi / 2) < 0.02)).all()
    found = require_closed_surface(mesh)
    assert found.euler_characteristic == -2
    assert 350 < len(mesh.vertices) < 650


def test_creases_that_may_flip_are_lost(creased, monkeypatch):
    """The mutant: without marks the flips of relaxation cut corners."""
    plain = remeshing.creased_mesh
    monkeypatch.setattr(remeshing, "creased_mesh", lambda *args: replace(plain(*args), creases=None))
    mesh = remeshed(creased, 500)
    bends = bending(mesh).angle
    assert ((bends > 0.02) & (np.abs(bends - np.pi / 2) > 0.02)).any()


def test_more_vertices_than_the_refined_mesh_has_for_creases(creased):
    with pytest.raises(FitError, match=r"more than \d+, a quarter of those of its refined mesh; .*more functions"):
        remeshed(creased, 100_000)


def test_creases_are_sides_of_the_quadrilaterals(creased):
    """Every quadrilateral lies in one plane of the plate, and their sharp sides are as long together as its edges."""
    mesh, plate = remeshed(creased, 1500, quads=True), mesh_of("plate_genus2_coarse.off")
    assert (mesh.face_sizes == 4).all()
    corners = mesh.vertices[mesh.tail.reshape(-1, 4)]
    thin = np.linalg.svd(corners - corners.mean(axis=1, keepdims=True), compute_uv=False)[:, 2]
    assert thin.max() < 1e-3 * plate.diagonal
    normal = vector_areas(mesh)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    sharp = np.einsum("hi,hi->h", normal[mesh.face], normal[mesh.face[mesh.twin]]) < 0.5
    edges = (plate.edge_lengths * (bending(plate).angle > np.pi / 4)).sum()
    assert mesh.edge_lengths[sharp].sum() == pytest.approx(edges, rel=1e-4)
    assert require_closed_surface(mesh).euler_characteristic == -2
