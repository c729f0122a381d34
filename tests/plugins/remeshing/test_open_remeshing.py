"""Even meshes on surfaces with a boundary: only the surface's own part, vertices on the boundary, corners kept."""

from __future__ import annotations

from contextlib import suppress
from functools import cache

import numpy as np
import pytest
from open_shapes import SHAPES, square_sheet
from orbiframe_remeshing import open_sites, relaxation
from orbiframe_remeshing.curved import curved
from orbiframe_remeshing.even_sites import surface_area
from orbiframe_remeshing.quality import quality
from orbiframe_remeshing.remeshing import Wanted, even_triangles, remeshed, rim_length
from orbiframe_remeshing.surface_mesh import SurfaceMesh

from orbiframe import FitError, OrbifoldSurface, Polyhedron, fit, surface_type, write
from orbiframe.meshes import boundary_loops
from orbiframe.meshes.sizes import area
from orbiframe.surfaces import within_border
from orbiframe.surfaces.border import inside, nearest_on_border


@cache
def surface_of(name: str) -> OrbifoldSurface:
    return fit(SHAPES[name](), size=400, boundary="auto", progress=False).surface


@cache
def flat_square() -> OrbifoldSurface:
    flat = square_sheet(8)
    flat = flat.with_vertices(flat.vertices * [1, 1, 0])
    return fit(flat, size=300, boundary="auto", progress=False).surface


def rim_of(mesh: Polyhedron) -> np.ndarray:
    return np.unique(np.concatenate([mesh.tail[mesh.twin < 0], mesh.head[mesh.twin < 0]]))


def off_border(surface: OrbifoldSurface, places: np.ndarray) -> float:
    """How far places in space are from the boundary of the surface, at most, in its units."""
    return float(nearest_on_border(surface, (places - surface.origin) / surface.scale)[1].max()) * surface.scale


@pytest.mark.parametrize("name", SHAPES)
def test_only_the_surface_itself_is_meshed_up_to_its_boundary(name: str) -> None:
    surface = surface_of(name)
    made = even_triangles(surface, 400)
    mesh = made.polyhedron()
    assert surface_type(mesh) == surface_type(SHAPES[name]())
    assert len(boundary_loops(mesh)) == len(boundary_loops(SHAPES[name]()))
    rim = rim_of(mesh)
    assert off_border(surface, mesh.vertices[rim]) < 1e-6
    points, inner = made.points, np.setdiff1d(np.arange(len(mesh.vertices)), rim)
    assert inside(surface, type(points)(points.patch[inner], points.x[inner])).all()
    found = quality(mesh)
    assert found["angles"]["least"] > 18
    assert found["angles"]["mean_of_least"] > 46
    assert found["regular"] > 0.97
    assert len(mesh.vertices) == pytest.approx(400, rel=0.04)


def test_a_flat_square_keeps_its_corners_its_area_and_its_sides() -> None:
    mesh = remeshed(flat_square(), 300)
    for corner in ((0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0)):
        assert np.linalg.norm(mesh.vertices - corner, axis=1).min() < 5e-4
    assert area(mesh) == pytest.approx(1, abs=3e-4)
    assert mesh.edge_lengths[mesh.twin < 0].sum() == pytest.approx(4, abs=5e-3)
    assert rim_length(flat_square()) == pytest.approx(4, abs=5e-3)


def test_vertices_on_a_round_rim_are_even() -> None:
    """Rims of a tube of radius 1 have chords of 2 sin(pi / n)."""
    mesh = remeshed(surface_of("cylinder"), 500)
    edges = mesh.edge_lengths[mesh.twin < 0]
    n = len(edges) / 2
    assert n == int(n)
    assert np.abs(edges - 2 * np.sin(np.pi / n)).max() < 2e-3
    assert np.abs(np.sort(mesh.vertices[rim_of(mesh), 2]) - np.repeat([0, 2], int(n))).max() < 1e-3


@pytest.mark.parametrize("quads", [False, True])
def test_edges_are_as_long_as_asked_for(quads: bool) -> None:
    surface = surface_of("bumpy disc")
    total = Wanted(0.12, None, quads).total(surface_area(surface), rim_length(surface))
    mesh = remeshed(surface, total, quads=quads)
    assert quality(mesh)["edges"]["mean"] == pytest.approx(0.12, rel=0.11 if quads else 0.06)
    assert len(mesh.vertices) == pytest.approx(total, rel=0.08)


@pytest.mark.parametrize("name", ["Möbius band", "mask with three holes"])
def test_quadrilaterals_have_their_middles_on_the_boundary(name: str) -> None:
    surface = surface_of(name)
    mesh = remeshed(surface, 1200, quads=True)
    assert set(mesh.face_sizes.tolist()) == {4}
    assert surface_type(mesh) == surface_type(SHAPES[name]())
    assert off_border(surface, mesh.vertices[rim_of(mesh)]) < 1e-6


def test_nodes_of_curved_elements_lie_on_the_boundary() -> None:
    """Sides of triangles are geodesics of X, which the boundary of a hole with steps is not."""
    surface = surface_of("torus with a jagged hole")
    made = even_triangles(surface, 200)
    mesh = curved(made, 3)
    assert len(mesh.elements) == len(made.triangles)
    used = np.bincount(mesh.elements.ravel(), minlength=len(mesh.nodes))
    assert (used > 0).all()
    for share in (1 / 3, 2 / 3):
        points = made.rim.along(share)
        there = surface.evaluate(points)
        away = np.linalg.norm(there[:, None] - mesh.nodes[None], axis=2).min(axis=1)
        assert away.max() < 1e-12
        assert off_border(surface, there) < 1e-6


def test_a_rim_that_may_move_leaves_the_boundary(monkeypatch: pytest.MonkeyPatch) -> None:
    """The mutant: vertices on the boundary step to the middle of their triangles like all others."""
    monkeypatch.setattr(SurfaceMesh, "fixed", property(lambda mesh: np.zeros(len(mesh.places), dtype=np.bool_)))
    surface = surface_of("cylinder")
    mesh = relaxation.relaxed(open_sites.open_mesh(surface, 300)).polyhedron()
    assert off_border(surface, mesh.vertices[rim_of(mesh)]) > 1e-3


def test_a_boundary_that_does_not_become_edges_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = within_border.with_edges_along

    def none_found(current, geodesics):
        found, edges = plain(current, geodesics)
        return found, np.where(np.arange(len(edges)) == 0, -1, edges)

    monkeypatch.setattr(within_border, "with_edges_along", none_found)
    with pytest.raises(FitError, match="pieces of the boundary do not become edges"):
        remeshed(surface_of("bumpy disc"), 100)


def test_very_few_vertices_are_a_mesh_or_an_error() -> None:
    """Never another surface."""
    for count in (4, 8, 20, 40):
        for name in ("bumpy disc", "Möbius band", "mask with three holes"):
            with suppress(FitError):
                assert surface_type(remeshed(surface_of(name), count)) == surface_type(SHAPES[name]())


def test_the_command_meshes_open_meshes_when_told_how_they_are_closed(orbiframe, tmp_path) -> None:
    write(tmp_path / "sheet.off", square_sheet(8))
    refused = orbiframe("remesh", tmp_path / "sheet.off", "-o", tmp_path / "out.ply", "--vertices", 200)
    assert refused.status == 1
    assert "--boundary auto" in refused.err
    options = ("--size", 150, "--vertices", 200)
    ran = orbiframe("remesh", tmp_path / "sheet.off", "-o", tmp_path / "out.ply", *options, "--boundary", "auto")
    assert (ran.status, ran.err) == (0, "")
    assert "triangles" in ran.out
    saved = tmp_path / "sheet.npz"
    fitted = ("--size", 150, "--boundary", "auto", "--quiet")
    orbiframe("fit", tmp_path / "sheet.off", "-o", tmp_path / "fit.ply", "--save", saved, *fitted)
    again = orbiframe("remesh", saved, "-o", tmp_path / "again.ply", "--vertices", 200, "--quiet")
    assert again.status == 0
    assert (tmp_path / "again.ply").read_bytes() == (tmp_path / "out.ply").read_bytes()
    wrong = orbiframe("remesh", saved, "-o", tmp_path / "x.ply", "--vertices", 200, "--boundary", "auto")
    assert wrong.status == 2
    assert "finished surface" in wrong.err
