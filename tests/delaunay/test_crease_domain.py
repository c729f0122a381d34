"""Creases as edges of a domain: placed on every kind of surface, straight in X, and refused with the place."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import spline_checks as checks
from creased import flat_map, placed
from hypothesis import given, settings, strategies as st

from orbiframe.delaunay import crease_domain
from orbiframe.delaunay.crease_domain import crease_triangulation, creased, off_geodesics
from orbiframe.delaunay.crease_sites import Asked
from orbiframe.delaunay.forced_edges import with_edge
from orbiframe.delaunay.site_triangulation import delaunay_of_vertices
from orbiframe.delaunay.sites import vertex_points
from orbiframe.errors import MapError
from orbiframe.meshes.bending import sharp_edges
from orbiframe.triangulations.crease_chains import CreaseGraph
from orbiframe.triangulations.point_location import Locator

NAMES = ["cube.off", "cylinder", "plate_genus2_coarse.off", "projective_plane.off", "klein_bottle.off"]
each_mesh = pytest.mark.parametrize("name", NAMES)


@each_mesh
def test_creases_run_along_edges_of_the_domain(name: str) -> None:
    found, flat = placed(name), flat_map(name)[0]
    domain, mesh = crease_triangulation(found), found.polyhedron
    pieces = list(CreaseGraph.of(mesh, found.crease, found.sites).chains(found))
    assert (domain.creased & domain.reference).sum() == len(pieces)
    assert (domain.creased == domain.creased[domain.twin]).all()
    geometry = domain.geometry
    length = sum(float(geometry.distance(x[0], x[-1])) for x in (piece.lifted(found) for piece in pieces))
    np.testing.assert_allclose(domain.edge_lengths[domain.creased & domain.reference].sum(), length)
    assert domain.vertex_count == len(found.sites)
    np.testing.assert_allclose(domain.areas.sum(), flat.orbifold.area)
    assert domain.gluing_defect < 1e-10


@each_mesh
def test_the_map_follows_them(name: str) -> None:
    found, flat = placed(name), flat_map(name)[0]
    assert found.not_positive == 0
    assert off_geodesics(found) < 1e-12
    if name.startswith("plate"):
        assert off_geodesics(replace(flat, crease=found.crease, sites=found.sites)) > 1e-4
    moved = np.flatnonzero((found.points != flat.points).any(axis=1))
    on_crease = np.unique(found.polyhedron.tail[found.crease])
    assert np.isin(moved, on_crease).all()
    assert not np.isin(moved, found.sites).any()
    assert found.area_defect < 1e-9


@each_mesh
def test_corners_and_ends_are_sites(name: str) -> None:
    """By counting marked edges at every vertex."""
    found = placed(name)
    mesh = found.polyhedron
    chosen = np.flatnonzero(found.crease & mesh.representative)
    degree = np.bincount(np.concatenate([mesh.tail[chosen], mesh.head[chosen]]), minlength=len(mesh.vertices))
    assert np.isin(np.flatnonzero((degree != 0) & (degree != 2)), found.sites).all()
    # A closed curve has three sites at least.
    for chain in CreaseGraph.of(mesh, found.crease).chains(found):
        assert np.isin(chain.vertices, found.sites).sum() >= (4 if chain.vertices[0] == chain.vertices[-1] else 2)


def test_chains_cover_every_crease_once() -> None:
    found = placed("klein_bottle.off")
    graph = CreaseGraph.of(found.polyhedron, found.crease)
    edges = sum(len(chain.steps) for chain in graph.chains(found))
    assert edges == (found.crease & found.polyhedron.representative).sum()
    for chain in graph.chains(found):
        atlas = found.orbifold.atlas
        ends = found.patch[chain.vertices]
        known = chain.steps > 0
        assert (atlas.tail[chain.steps[known]] == ends[:-1][known]).all()
        assert (atlas.head[chain.steps[known]] == ends[1:][known]).all()


def test_as_many_sites_as_functions_ask_for() -> None:
    few, many = placed("plate_genus2_coarse.off", 400), placed("plate_genus2_coarse.off", 1200)
    assert 1.5 * len(few.sites) < len(many.sites) < 4.5 * len(few.sites)


def test_sites_follow_the_curvature() -> None:
    """On the cylinder: twice as many on the wall in each direction, if it is twice as curved; no more than the most."""
    triangulation, refinement = flat_map("cylinder")
    crease = sharp_edges(refinement.polyhedron, 30)
    wall = np.abs(refinement.polyhedron.vertices[:, 2] - 0.5) < 0.49
    counts = []
    for radius in (0.5, 0.25, 0.125):
        asked = Asked(100, (3, 0, 0), np.where(wall, 1 / radius, 0.0), most=100_000)
        found = creased(triangulation, crease, asked)
        counts.append(int(wall[found.sites].sum()))
        assert crease_triangulation(found).vertex_count == len(found.sites)
    assert counts[0] < counts[1] < counts[2]
    assert 2.5 < counts[2] / counts[1] < 5.5
    few = creased(triangulation, crease, Asked(100, (3, 0, 0), np.where(wall, 8.0, 0.0), most=300))
    assert 3 * len(few.sites) < 700


def test_a_crease_that_finds_no_place_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crease_domain, "with_edge", lambda *_: None)
    monkeypatch.setattr(crease_domain, "_ROUNDS", 1)
    monkeypatch.setattr(crease_domain, "_LAST_ROUNDS", 0)
    triangulation, refinement = flat_map("klein_bottle.off")
    with pytest.raises(MapError, match=r"a crease near \(.*\) of the mesh.*more functions.*larger angle"):
        creased(triangulation, sharp_edges(refinement.polyhedron, 30), Asked(300, (3, 0, 0)))


def test_sites_without_their_edges_are_refused() -> None:
    found = placed("cube.off")
    ends = np.flatnonzero(found.crease)
    corner = found.polyhedron.tail[ends[0]]
    with pytest.raises(MapError):
        crease_triangulation(replace(found, sites=found.sites[found.sites != corner][::7]))


# ---- edges by flips -------------------------------------------------------------------------------------------------


@settings(max_examples=25, deadline=None)
@given(name=st.sampled_from(["sphere", "torus", "Klein bottle", "Bolza", "three crosscaps"]), seed=st.integers(0, 200))
def test_a_geodesic_through_a_few_triangles_becomes_an_edge(name: str, seed: int) -> None:
    """Between the vertices opposite an edge of the Delaunay triangulation, and to one beyond the next."""
    domain = delaunay_of_vertices(checks.domain(name).refined()).triangulation
    geometry, halfedge = domain.geometry, int(np.random.default_rng(seed).integers(3 * domain.face_count))
    face, c = divmod(halfedge, 3)
    start = domain.corners[face, (c + 2) % 3]
    beyond = domain.twin[halfedge]
    end = geometry.act(domain.gluing[halfedge], domain.corners[beyond // 3, (beyond % 3 + 2) % 3])
    place = domain.placement[face]
    ends = [geometry.settle(geometry.act(place, x)) for x in (start, end)]
    found = with_edge(domain, int(domain.patch[face]), *ends)
    if found is None:
        # The geodesic runs through a vertex, or the triangles are one.
        a, b = domain.corners[face, c], domain.corners[face, (c + 1) % 3]
        turns = [np.linalg.det(np.stack([start, end, x])) for x in (a, b)]
        assert beyond // 3 == face or min(-turns[0], turns[1]) < 1e-8
        return
    new = found.triangulation
    np.testing.assert_allclose(new.areas.sum(), domain.areas.sum())
    assert new.areas.min() > 0
    assert new.gluing_defect < 1e-9
    length = float(geometry.distance(start, end))
    assert np.abs(new.edge_lengths - length).min() < 1e-9
    np.testing.assert_array_equal(np.sort(found.vertex), np.arange(domain.vertex_count))
    location = Locator(domain).locate(vertex_points(new))
    away = geometry.distance(domain.corners[location.face], location.columns[:, None, :, 0])
    assert away.min(axis=1).max() < 1e-6
    old = domain.vertex[location.face, away.argmin(axis=1)]
    np.testing.assert_array_equal(found.vertex[old], location.order)


def test_an_edge_across_many_triangles() -> None:
    """On the torus, against the straight line in the plane: all in between is flipped away."""
    domain = checks.domain("torus").refined().refined()
    geometry = domain.geometry
    start = vertex_points(domain)
    first = start.x[0]
    others = np.flatnonzero(start.patch == start.patch[0])
    far = others[np.argsort(-geometry.distance(first, start.x[others]))]
    made = [with_edge(domain, int(start.patch[0]), first, start.x[k]) for k in far[:12]]
    found = [
        (made[n].triangulation, float(geometry.distance(first, start.x[far[n]])))
        for n in range(12)
        if made[n] is not None
    ]
    assert found
    for new, length in found:
        assert np.abs(new.edge_lengths - length).min() < 1e-9
        assert new.areas.min() > 0
        np.testing.assert_allclose(new.areas.sum(), domain.areas.sum())
