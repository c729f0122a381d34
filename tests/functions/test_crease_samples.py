"""Samples of meshes with creases: on every side of a crease, with its normal, and what counts on curved facets."""

from __future__ import annotations

import numpy as np
import pytest
from creased import flat_map, mesh_of, placed

from orbiframe.errors import FitError
from orbiframe.functions import Samples, Sides, crease_samples
from orbiframe.functions.samples_of_sides import crease_of_facets
from orbiframe.meshes.bending import sharp_edges
from orbiframe.meshes.sizes import vector_areas
from orbiframe.triangulations.point_location import Locator

SPACING = 0.05


def test_sides_of_a_crease_have_its_normals() -> None:
    found, refinement = placed("cube.off"), flat_map("cube.off")[1]
    samples = crease_samples(found, refinement, SPACING, curved="bent")
    assert samples.still.all()
    assert np.isfinite(samples.normals).all()
    centred = mesh_of("cube.off").vertices.mean(axis=0)
    depth = np.abs(((samples.values - centred) * samples.normals).sum(axis=1))
    np.testing.assert_allclose(depth, np.abs(mesh_of("cube.off").vertices - centred).max(), atol=1e-12)
    corner = np.abs(samples.values - mesh_of("cube.off").vertices[0]).max(axis=1) < 1e-12
    assert corner.sum() == 3
    np.testing.assert_allclose(np.abs(samples.normals[corner]).sum(axis=0), 1, atol=1e-9)


@pytest.mark.parametrize("name", ["cube.off", "klein_bottle.off"])
def test_areas_add_up(name: str) -> None:
    found, refinement = placed(name), flat_map(name)[1]
    samples = crease_samples(found, refinement, SPACING, curved="none")
    area = np.linalg.norm(vector_areas(refinement.polyhedron), axis=1).sum()
    sides = Sides.of(found)
    share = samples.shares[: len(sides.vertex) + refinement.polyhedron.face_count]
    np.testing.assert_allclose(share.sum(), area)
    on_flat_crease = np.zeros(len(samples.weights), dtype=bool)
    on_flat_crease[: len(sides.vertex)] = sides.parted & np.isfinite(samples.normals[: len(sides.vertex)]).all(axis=1)
    np.testing.assert_allclose(samples.weights, np.where(on_flat_crease, 12, 1) * samples.shares)


def test_points_lie_on_their_sides() -> None:
    """Each in a triangle of the mesh that has a corner on the side."""
    found = placed("cylinder")
    sides, mesh = Sides.of(found), found.polyhedron
    locator = Locator(placed_triangles(found))
    location = locator.locate(sides.points)
    face = np.empty(len(sides.vertex), dtype=int)
    face[location.order] = location.face
    for side in np.flatnonzero(sides.parted):
        assert side in sides.corner[3 * face[side] : 3 * face[side] + 3]
    assert (mesh.tail[np.unique(sides.corner, return_index=True)[1]] == sides.vertex).all()


def placed_triangles(found):
    from orbiframe.triangulations import GeodesicTriangulation

    return GeodesicTriangulation.of_map(found)


def test_of_a_cylinder_vertices_and_straight_edges_count() -> None:
    found, refinement = placed("cylinder"), flat_map("cylinder")[1]
    samples = crease_samples(found, refinement, SPACING, curved="bent")
    radius = np.hypot(samples.values[:, 0], samples.values[:, 1])
    lids = np.isfinite(samples.normals).all(axis=1)
    np.testing.assert_allclose(np.abs(samples.normals[lids][:, 2]), 1)
    on_walls = ~lids & (np.abs(samples.values[:, 2] - 0.5) < 0.49)
    density = samples.weights / np.maximum(samples.shares, 1e-300)
    on_cylinder = np.abs(radius - 0.5) < 1e-9
    assert (density[on_walls & on_cylinder] > 0.9).all()
    assert (on_walls & on_cylinder).sum() >= 24
    facets = 0.5 * (1 - np.cos(np.pi / 24))
    assert np.abs(radius[on_walls] - 0.5).max() < 0.01 * facets
    assert not samples.still[on_walls].any()
    rim = ~lids & (np.abs(np.abs(samples.values[:, 2] - 0.5) - 0.5) < 1e-9)
    assert samples.still[rim].all()
    given = rim & on_cylinder
    assert given.sum() == 48
    assert samples.weights[given].min() > 10 * samples.weights[rim & ~on_cylinder].max()


def test_of_a_smooth_mesh_vertices_alone_count() -> None:
    found, refinement = placed("cylinder"), flat_map("cylinder")[1]
    samples = crease_samples(found, refinement, SPACING, curved="all")
    counted = samples.values[samples.weights > 0]
    away = np.abs(counted[:, None] - mesh_of("cylinder").vertices[None]).max(axis=2).min(axis=1)
    assert away.max() < 1e-12
    assert np.isnan(samples.normals).all()


def test_every_triangle_of_the_domain_has_samples() -> None:
    from orbiframe.delaunay.crease_domain import crease_triangulation

    found, refinement = placed("klein_bottle.off", 3000), flat_map("klein_bottle.off")[1]
    samples = crease_samples(found, refinement, SPACING, curved="bent")
    domain = crease_triangulation(found)
    count = np.bincount(Locator(domain).locate(samples.points).face, minlength=domain.face_count)
    assert count.min() >= 16


def test_samples_in_small_triangles_lie_on_the_mesh() -> None:
    """At the place that the map gives them: the values of the map at their parameters."""
    found, refinement = placed("cube.off", 3000), flat_map("cube.off")[1]
    samples = crease_samples(found, refinement, SPACING, curved="none")
    first = len(Sides.of(found).vertex) + refinement.polyhedron.face_count
    assert len(samples.weights) > first
    extra = samples.values[first:]
    centre = mesh_of("cube.off").vertices.mean(axis=0)
    half = np.abs(mesh_of("cube.off").vertices - centre).max()
    np.testing.assert_allclose(np.abs(extra - centre).max(axis=1), half, atol=1e-9)


def test_creases_of_facets_are_those_of_the_mesh() -> None:
    found, refinement = placed("klein_bottle.off"), flat_map("klein_bottle.off")[1]
    np.testing.assert_array_equal(crease_of_facets(found, refinement), sharp_edges(refinement.facets, 30))


def test_normals_of_another_number_are_refused() -> None:
    found, refinement = placed("cube.off"), flat_map("cube.off")[1]
    s = crease_samples(found, refinement, SPACING, curved="none")
    with pytest.raises(FitError, match=r"normals and flags of shapes"):
        Samples(s.points, s.values, s.weights, s.stretch, normals=s.normals[1:])
