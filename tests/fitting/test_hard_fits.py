"""Fits of hard meshes: what the report and the terminal say of crowding, diagonals and cells with common edges."""

from __future__ import annotations

from pathlib import Path

import hard_surfaces as hard
import numpy as np
import pytest
from fitted import REGISTRY, config, grid
from signed_faces import WORDS, wandering

from orbiframe import fit
from orbiframe.cli.report import summary
from orbiframe.errors import FitError, TopologyError
from orbiframe.fitting import pipeline
from orbiframe.fitting.closed_mesh import mapping_of
from orbiframe.fitting.stages import Stages
from orbiframe.meshes.defects import faces_with_repeated_vertices
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.polyhedra import reference_polyhedra

pytestmark = pytest.mark.long

FOX = Path(__file__).parents[3] / "shared" / "cases" / "meshes" / "fox.off"
CROSSCAP = Path(__file__).parents[3] / "shared" / "meshes" / "crosscap_torus_k1.off"


def test_a_warning_comes_where_digits_are_missed_in_a_fit() -> None:
    mesh = hard.with_finger(hard.plate_cells(1, 1), (0, 0, 0), 18, 2)
    report = pipeline.fit(mesh, config(60), REGISTRY).report
    assert report["map"]["not_positive"] == 0
    assert 6 <= report["map"]["crowding"]["digits_lost"] <= 9
    assert 1e-20 < report["map"]["crowding"]["area_ratio"] < 1e-12
    assert "warning" not in summary(report)
    report["map"]["crowding"]["digits_lost"] = 13.2
    assert "13 of 16 digits are lost" in summary(report)


def test_a_finger_of_80_radii_is_fitted_as_well_as_a_short_one() -> None:
    """In both cases 300 functions for about the same number of radii of the finger: the error is that of its tip."""
    slab = {(i, j, 0) for i in range(3) for j in range(3)}
    short, long = (pipeline.fit(hard.with_finger(slab, (0, 0, 0), r, 1), config(300), REGISTRY) for r in (5, 80))
    assert long.report["map"]["not_positive"] == 0
    assert long.report["map"]["crowding"]["digits_lost"] < 4
    assert long.report["fit"]["rms"] < 1.5 * short.report["fit"]["rms"]


def test_diagonals_are_told_and_a_cube_gets_no_warning() -> None:
    report = pipeline.fit(reference_polyhedra()["prism"], config(60), REGISTRY).report
    assert report["triangles"] == {
        "faces_cut": 7,
        "diagonals": 9,
        "points": 0,
        "rule": "the shortest diagonal inside the face, again and again",
    }
    assert "9 diagonals in 7 faces: the shortest diagonal inside" in summary(report)
    assert "warning" not in summary(report)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_faces_that_meet_themselves_are_mapped_where_twins_are_given() -> None:
    mesh = wandering(WORDS["torus"], 1, 25).polyhedron()
    assert len(faces_with_repeated_vertices(mesh))
    mapped = mapping_of(mesh, config(60), Stages(REGISTRY, lambda *_: None)).for_size(60)
    assert mapped.triangulation.not_positive == 0
    assert mapped.triangulation.orbifold.euler_characteristic == 0
    # Its thin parts need hundreds of thousands of functions.
    with pytest.raises(FitError, match=r"the surface leaves the mesh by .* too few for the thin parts"):
        pipeline.fit(mesh, config(60), REGISTRY)


def test_edges_that_a_list_of_vertices_cannot_tell_apart_are_explained() -> None:
    """The torus of two by two squares: every two neighbours share two edges."""
    faces = [[0, 1, 3, 2], [1, 0, 2, 3], [2, 3, 1, 0], [3, 2, 0, 1]]
    mesh = Polyhedron.from_faces(np.eye(4, 3), faces)
    with pytest.raises(TopologyError, match=r"several edges are meant to join the same two vertices.* put a vertex on"):
        pipeline.fit(mesh, config(60), REGISTRY)


def test_twelve_by_eight_vertices_are_a_torus() -> None:
    """Its 45 degrees about the tube are no creases: nearer than the facets are by a factor of twenty."""

    def place(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        ring = 1 + 0.4 * np.cos(v)
        return np.stack([ring * np.cos(u), ring * np.sin(u), 0.4 * np.sin(v)], axis=1)

    result = fit(grid(12, 8, place), size=300, progress=False)
    x, y, z = result.output.vertices.T
    away = np.abs(np.hypot(np.hypot(x, y) - 1, z) - 0.4) / result.input.diagonal
    assert result.report["data"]["means"] == "smooth"
    assert np.sqrt((away**2).mean()) < 4e-4


@pytest.mark.skipif(not CROSSCAP.exists(), reason="the folder shared with meshes to try things on is not here")
def test_a_fold_in_a_smooth_shape_makes_no_horn() -> None:
    """A torus with a crosscap: as smooth the surface rises over a fold by the size of a facet."""
    found = fit(CROSSCAP, progress=False).report
    assert found["data"]["means"] == "semi-smooth"
    assert "as smooth the surface leaves a facet" in found["data"]["reason"]
    asked = fit(CROSSCAP, data="smooth", progress=False).report
    assert found["distance"]["hausdorff"] < 0.015 < asked["distance"]["hausdorff"]


@pytest.mark.skipif(not FOX.exists(), reason="the folder shared with meshes to try things on is not here")
@pytest.mark.parametrize("basis", ["dms", "ps6"])
def test_too_few_functions_make_no_spikes_but_an_error(basis: str) -> None:
    with pytest.raises(FitError, match=r"leaves the mesh by 0\.\d+ of the diagonal; .* too few .* take about"):
        fit(FOX, basis=basis, size=200, progress=False)
