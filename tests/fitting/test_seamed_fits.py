"""Fits of shapes with rounds that end in planes, against the shapes themselves: what the meshes were cut from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from creased import fitted_with_creases, mesh_of
from documents import ROOT
from fitted import REGISTRY

from orbiframe.files.surface_file import load_surface, save_surface
from orbiframe.fitting import pipeline
from orbiframe.fitting.config import Config
from orbiframe.meshes.sizes import vector_areas
from orbiframe.surfaces import folds as folds_module
from orbiframe.surfaces.folds import folds

PLATE = ROOT.parent / "shared" / "meshes" / "trimesh_plate_holes.STL"


def from_bar(x: np.ndarray, width: float = 4.0, radius: float = 0.5) -> np.ndarray:
    """Distances of points from the bar of `creased.rounded_bar`, signed: a square with two round corners, 3 high."""
    to = np.abs(x[:, :2] - width / 2) - (width / 2 - radius)
    square = np.abs(x[:, :2] - width / 2).max(axis=1) - width / 2
    rounded = np.hypot(*np.maximum(to, 0).T) + np.minimum(to.max(axis=1), 0) - radius
    # Corners at (w, w) and (0, w) are round.
    outline = np.where(x[:, 1] > width / 2, rounded, square)
    return np.maximum(outline, np.abs(x[:, 2] - 1.5) - 1.5)


def from_plate(x: np.ndarray) -> np.ndarray:
    """Distances from the plate of the collection: 203.2 x 304.8 x 12.7 with corners of 25.4, its lower edge rounded
    with 6.35, four countersunk holes, and a hole with a counterbore.
    """
    to = np.abs(x[:, :2] - [101.6, 152.4]) - [76.2, 127.0]
    outline = np.hypot(*np.maximum(to, 0).T) + np.minimum(to.max(axis=1), 0) - 25.4
    u, v = outline + 6.35, 6.35 - x[:, 2]
    found = np.where((u > 0) & (v > 0), np.hypot(u, v) - 6.35, np.maximum(outline, -x[:, 2]))
    found = np.maximum(found, x[:, 2] - 12.7)
    steep = np.array([12.7 - 9.1791, 3.378199 - 6.438899]) / np.hypot(12.7 - 9.1791, 6.438899 - 3.378199)
    for centre in ((39.898196, 47.774171), (163.301798, 47.774171), (163.301798, 257.025834), (39.898196, 257.025834)):
        away = np.hypot(*(x[:, :2] - centre).T) - 3.378199
        found = np.maximum(found, -np.minimum(away, away * steep[0] + (x[:, 2] - 9.1791) * steep[1]))
    away = np.hypot(*(x[:, :2] - [101.6, 154.480743]).T)
    return np.maximum(found, -np.minimum(away - 3.378199, np.maximum(away - 5.55625, 6.35 - x[:, 2])))


def off(surface, shape) -> tuple[float, float]:
    """Root mean square and largest distance of a surface from a shape, in diagonals of the mesh."""
    mesh = surface.tessellate(1, bisected=True)
    weight = np.bincount(mesh.tail, weights=np.repeat(np.linalg.norm(vector_areas(mesh), axis=1), 3))
    away = np.abs(shape(mesh.vertices)) / surface.scale
    return float(np.sqrt(weight @ away**2 / weight.sum())), float(away.max())


def test_the_shapes_of_the_tests_hold_the_meshes() -> None:
    assert np.abs(from_bar(mesh_of("rounded bar").vertices)).max() < 1e-12
    if PLATE.exists():
        from orbiframe.files import gate

        assert np.abs(from_plate(gate.read(PLATE, REGISTRY).vertices)).max() < 1e-4


def test_a_round_between_planes_is_round_and_the_planes_are_plane() -> None:
    """Many times nearer to the bar than its facets, without a kink or a fold."""
    result = fitted_with_creases("rounded bar", 30, 600)
    facets = 0.5 * (1 - np.cos(np.pi / 24)) / result.surface.scale
    rms, largest = off(result.surface, from_bar)
    assert rms < 0.02 * facets
    assert largest < 0.3 * facets
    report = result.report
    assert report["creases"]["kinks"][1] < 0.2
    assert report["shape"]["folded_share"] == 0
    assert report["fit"]["rms"] < 0.02 * facets
    assert report["distance"]["mesh_to_surface"]["rms"] > 5 * report["distance"]["arcs_to_surface"]["rms"]


def test_without_seams_the_planes_are_not_plane(monkeypatch: pytest.MonkeyPatch) -> None:
    """The mutant: with the same functions, and no border between rounds and planes."""
    from orbiframe.fitting import mapping

    monkeypatch.setattr(mapping, "seams", lambda mesh, crease: np.zeros_like(crease))
    config = Config.load(overrides=["basis.size=600", "data.creases=30", "output.refine=1"])
    plain = pipeline.fit(mesh_of("rounded bar"), config, REGISTRY)
    assert off(plain.surface, from_bar)[0] > 3 * off(fitted_with_creases("rounded bar", 30, 600).surface, from_bar)[0]


def test_a_saved_surface_has_its_seams(tmp_path: Path) -> None:
    surface = fitted_with_creases("rounded bar", 30, 600).surface
    save_surface(surface, tmp_path / "bar.npz")
    again = load_surface(tmp_path / "bar.npz", REGISTRY)
    np.testing.assert_array_equal(again.triangulation.seam, surface.triangulation.seam)
    np.testing.assert_array_equal(again.basis.domain.seam, surface.basis.domain.seam)
    np.testing.assert_array_equal(again.tessellate(2).vertices, surface.tessellate(2).vertices)
    refined = surface.basis.domain.refined()
    assert refined.seam.sum() == 2 * surface.basis.domain.seam.sum()
    assert (refined.crease | ~refined.seam).all()


def test_a_map_with_seams_is_taken_over() -> None:
    """A bar of the same triangles, longer by a tenth, on the map of the first: with its creases and seams."""
    first = fitted_with_creases("rounded bar", 30, 600).surface
    mesh = mesh_of("rounded bar")
    longer = mesh.with_vertices(mesh.vertices * [1, 1, 1.1])
    words = [f"basis.size={first.basis.size}", "data.creases=30", "output.refine=1"]
    found = pipeline.fit(longer, Config.load(overrides=words), REGISTRY, like=first)
    np.testing.assert_array_equal(found.surface.triangulation.seam, first.triangulation.seam)
    np.testing.assert_array_equal(found.surface.triangulation.sites, first.triangulation.sites)
    assert off(found.surface, lambda x: from_bar(x / [1, 1, 1.1]))[0] < 1e-4


def test_folds_beside_sharp_edges_are_told_by_their_own_side(monkeypatch: pytest.MonkeyPatch) -> None:
    """A wedge whose faces turn by 166 degrees has no fold; it seems so, if normals are those of the other side."""
    surface = fitted_with_creases("wedge", 30, 300, "basis.name=ps2").surface
    fine = surface.tessellate(bisected=True)
    assert folds(surface, fine) == (0.0, (0.0, 0.0, 0.0))
    monkeypatch.setattr(folds_module, "_INSIDE", 0.0)
    found = folds(surface, replace(fine, corner_normals=None))
    assert found.share > 1e-5
    on_edge = np.hypot(*np.array(found.place)[:2])
    assert on_edge < 0.5


@pytest.mark.long
def test_a_plate_with_holes_from_cad_with_defaults() -> None:
    """Against the plate itself, from which the facets are 5.5e-5 off."""
    if not PLATE.exists():
        pytest.skip(f"{PLATE} is not there")
    result = pipeline.fit(PLATE, Config.load(overrides=["data.creases=30"]), REGISTRY)
    rms, largest = off(result.surface, from_plate)
    assert rms < 2e-5
    assert largest < 5e-4
    report = result.report
    assert report["fit"]["rms"] < 2e-5
    assert report["shape"]["folded_share"] < 1e-8
    assert report["creases"]["kinks"][1] < 1.0
    assert report["fit"]["size"] < 8000
