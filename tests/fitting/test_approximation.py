"""Sizes, accuracy and notes of fits; the loop for a tolerance."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import REGISTRY, config, fitted, grid, mesh_of

from orbiframe.errors import FitError
from orbiframe.fitting import pipeline
from orbiframe.fitting.accuracy import accuracy_of
from orbiframe.fitting.config import Config
from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.surfaces.folds import folded_share


def coarse_torus():
    def place(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        ring = 3 + np.cos(v)
        return np.stack([ring * np.cos(u), ring * np.sin(u), np.sin(v)], axis=1)

    return grid(24, 12, place)


def test_a_mesh_of_a_smooth_shape_loses_its_facets() -> None:
    """The surface is thirty times nearer to the torus than the facets are."""
    result = pipeline.fit(coarse_torus(), config(200), REGISTRY)
    assert result.report["data"]["means"] == "smooth"
    x = result.surface.tessellate(5).vertices
    off = np.abs(np.hypot(np.hypot(x[:, 0], x[:, 1]) - 3, x[:, 2]) - 1)
    assert (
        np.sqrt(np.mean(off**2)) < 0.03 * result.report["distance"]["surface_to_mesh"]["rms"] * coarse_torus().diagonal
    )
    assert result.report["fit"]["rms"] < 1e-4 < result.report["distance"]["mesh_to_surface"]["rms"]


def test_a_sliding_fit_of_a_box_is_much_nearer_than_the_linear_one() -> None:
    slid, linear = (
        pipeline.fit(mesh_of("cube.off"), config(300, f"fitter.name={name}"), REGISTRY).report
        for name in ("sliding", "least-squares")
    )
    assert slid["data"]["means"] == "facets"
    assert slid["fit"]["rms"] < 0.7 * linear["fit"]["rms"]
    assert slid["shape"]["folded_share"] < 1e-6


def test_facets_on_request() -> None:
    wanted = config(100, "data.means=facets", "fitter.name=least-squares")
    report = pipeline.fit(coarse_torus(), wanted, REGISTRY).report
    assert (report["data"]["means"], report["data"]["reason"]) == ("facets", "as asked")
    assert report["fit"]["samples"] > 5000


def test_distances_are_those_to_a_fine_mesh_of_the_surface() -> None:
    """Both ways, against brute force on 30,000 triangles."""
    result = fitted("double torus", 60)
    surface, report = result.surface, result.report["distance"]
    fine = surface.tessellate(12)
    mesh = surface.refinement.coarse
    given = mesh.with_vertices(surface.origin + surface.scale * mesh.vertices)
    rng = np.random.default_rng(0)
    face, share = rng.integers(mesh.face_count, size=4000), rng.dirichlet(np.ones(3), 4000)
    there = np.einsum("nc,nci->ni", share, given.vertices[given.triangles[face]])
    away = NearestPoints(fine).distance(there) / surface.scale
    assert away.max() <= 1.05 * report["mesh_to_surface"]["max"]
    place = np.array([report["mesh_to_surface"]["place"]])
    assert NearestPoints(given).distance(place)[0] < 1e-9
    found = NearestPoints(fine).distance(place)[0] / surface.scale
    assert found == pytest.approx(report["mesh_to_surface"]["max"], rel=0.05)
    back = NearestPoints(given).distance(np.array([report["surface_to_mesh"]["place"]]))[0] / surface.scale
    assert back == pytest.approx(report["surface_to_mesh"]["max"], rel=1e-6)


def turned_share(mesh) -> float:
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    vector = np.cross(b - a, c - a)
    area = np.linalg.norm(vector, axis=1)
    return area[np.einsum("fi,fi->f", vector, mesh.normals[mesh.triangles].sum(axis=1)) < 0].sum() / area.sum()


def test_rims_that_are_coarsely_drawn_are_no_folds() -> None:
    """A surface pushed through itself at one function: what is turned in a coarse mesh is not when it is cut fine."""
    from dataclasses import replace

    surface = fitted("double torus", 60).surface
    bent = surface.coefficients.copy()
    bent[7] *= -8
    broken = replace(surface, coefficients=bent)
    coarse = broken.tessellate(bisected=True)
    assert folded_share(broken, coarse) <= 0.2 * turned_share(coarse)
    assert folded_share(surface, surface.tessellate(bisected=True)) < 1e-6


def test_a_surface_worse_than_a_point_is_an_error() -> None:
    from dataclasses import replace

    surface = replace(fitted("double torus", 60).surface, origin=np.zeros(3), scale=1.0)
    spikes = surface.coefficients.copy()
    spikes[::7] *= 40
    with pytest.raises(FitError, match="raise the option size"):
        accuracy_of(replace(surface, coefficients=spikes))


def test_a_tolerance_is_reached_with_functions_where_the_error_is() -> None:
    result = pipeline.fit(
        mesh_of("cube.off"), Config.load(overrides=["output.refine=1", "output.tolerance=0.002"]), REGISTRY
    )
    assert result.report["fit"]["rms"] <= 0.002
    assert result.report["fit"]["size"] < 2500


def test_every_round_for_a_tolerance_has_more_functions(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the power 2/3 of what the error is too large, at least 1.3 and at most 2 times as many."""
    from orbiframe.fitting import approximation

    sizes, of_size = [], approximation.Approximations.of_size

    def recorded(self, size, density=None):
        sizes.append(size)
        return of_size(self, size, density)

    monkeypatch.setattr(approximation.Approximations, "of_size", recorded)
    monkeypatch.setattr(approximation, "_FIRST_SIZE", 60)
    wanted = ["output.refine=1", "output.tolerance=0.004", "fitter.name=least-squares"]
    pipeline.fit(mesh_of("cube.off"), Config.load(overrides=wanted), REGISTRY)
    steps = np.diff(np.log(sizes))
    assert len(steps) >= 2
    assert (steps > np.log(1.29)).all()
    assert (steps < np.log(2.01)).all()


def test_a_largest_error_is_reached() -> None:
    wanted = ["output.refine=1", "output.max_error=0.02"]
    result = pipeline.fit(mesh_of("cube.off"), Config.load(overrides=wanted), REGISTRY)
    assert result.report["fit"]["max"] <= 0.02


def test_a_tolerance_out_of_reach_says_what_was_reached(monkeypatch: pytest.MonkeyPatch) -> None:
    from orbiframe.fitting import approximation

    monkeypatch.setattr(approximation, "_LARGEST_SIZE", 500)
    with pytest.raises(FitError, match=r"500 functions reach an error of \d.*not 1.00e-07"):
        pipeline.fit(mesh_of("cube.off"), Config.load(overrides=["output.tolerance=1e-7"]), REGISTRY)
