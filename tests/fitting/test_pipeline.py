"""The chain from a mesh to a surface: the same every time, told stage by stage, with a sentence where it ends."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fitted import DATASETS, REGISTRY, config, fitted, mesh_of
from random_polyhedra import face_lists, relabelled

from orbiframe.components.registry import Registry
from orbiframe.errors import ConfigError, FitError, FormatError, MapError, OrbiframeError, TopologyError, UsageError
from orbiframe.fitting import approximation, mapping, pipeline
from orbiframe.fitting.config import Config
from orbiframe.meshes.orientation import reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.surface_type import surface_type
from orbiframe.testing.polyhedra import reference_polyhedra

SIZE = 60
REPORT_PAGE = Path(__file__).parents[2] / "docs" / "reference" / "report.md"


def flattened(data: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    found = {}
    for key, value in data.items():
        found |= flattened(value, f"{prefix}{key}.") if isinstance(value, dict) else {f"{prefix}{key}": value}
    return found


def timeless(report: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in report.items() if key != "seconds"}


# ---- the same every time --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["projective plane", "double torus"])
def test_two_runs_give_the_same_bits(name: str) -> None:
    first, second = fitted(name, SIZE), pipeline.fit(mesh_of(name), config(SIZE), REGISTRY)
    assert timeless(first.report) == timeless(second.report)
    np.testing.assert_array_equal(first.surface.coefficients, second.surface.coefficients)
    for part in ("vertices", "normals", "tail", "twin"):
        np.testing.assert_array_equal(getattr(first.output, part), getattr(second.output, part))


def test_the_order_of_faces_and_vertices_hardly_matters() -> None:
    """Not to the last digit: equal choices, of edges and of centres, are made by index."""
    mesh = reference_polyhedra()["double torus"]
    rng = np.random.default_rng(1)
    mesh = mesh.with_vertices(mesh.vertices + rng.normal(scale=0.05, size=mesh.vertices.shape))
    first, second = (pipeline.fit(m, config(SIZE), REGISTRY).report for m in (mesh, relabelled(mesh, rng)))
    assert first["surface"] == second["surface"]
    assert second["map"]["triangles"] == pytest.approx(first["map"]["triangles"], rel=0.05)
    assert second["map"]["angle_distortion"]["median"] == pytest.approx(
        first["map"]["angle_distortion"]["median"], rel=0.02
    )
    assert second["fit"]["rms"] == pytest.approx(first["fit"]["rms"], rel=0.3)


def test_a_path_a_string_and_an_object_are_the_same_mesh() -> None:
    from orbiframe.files import gate

    path = DATASETS / "torus.off"
    made = [pipeline.fit(m, config(SIZE), REGISTRY) for m in (str(path), gate.read(path, REGISTRY))]
    for result in made:
        np.testing.assert_array_equal(result.output.vertices, fitted("torus.off", SIZE).output.vertices)


def test_unoriented_faces_are_oriented_and_unused_vertices_left_out() -> None:
    mesh = reference_polyhedra()["double torus"]
    turned = reversed_faces(mesh, np.arange(mesh.face_count) % 3 == 0)
    messy = Polyhedron.from_faces(np.vstack([turned.vertices, [[99, 99, 99]]]), face_lists(turned))
    result = pipeline.fit(messy, config(SIZE), REGISTRY)
    assert not result.output.same.any()
    assert result.report["map"]["not_positive"] == 0
    assert np.abs(result.output.vertices).max() < 10
    assert timeless(result.report)["surface"] == fitted("double torus", SIZE).report["surface"]


# ---- the report -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["tetrahedron", "Klein bottle", "double torus"])
def test_the_report_has_the_documented_keys(name: str) -> None:
    documented = set(re.findall(r"^\| `([\w.]+)` \|", REPORT_PAGE.read_text(), re.MULTILINE))
    keys = {re.sub(r"^(seconds|versions)\..*", r"\1", key) for key in flattened(fitted(name, SIZE).report)}
    assert keys == documented


@pytest.mark.parametrize("name", ["tetrahedron", "Klein bottle", "double torus"])
def test_the_report_says_what_was_done(name: str) -> None:
    result = fitted(name, SIZE)
    report, given = result.report, mesh_of(name)
    kind = surface_type(given)
    assert report["surface"] == {
        "name": kind.name,
        "euler_characteristic": kind.euler_characteristic,
        "orientable": kind.orientable,
        "genus": kind.genus,
        "components": 1,
    }
    assert report["geometry"] == {1: "s2", 0: "e2", -1: "h2"}[int(np.sign(kind.euler_characteristic))]
    assert report["output"]["euler_characteristic"] == kind.euler_characteristic
    assert (report["output"]["vertices"], report["output"]["faces"]) == (
        len(result.output.vertices),
        result.output.face_count,
    )
    assert report["fit"]["size"] == SIZE
    assert 0 < report["fit"]["rms"] <= report["fit"]["max"] < 1
    ratio = report["map"]["angle_distortion"]
    assert 1 <= ratio["median"] <= ratio["p95"] <= ratio["max"]
    json.dumps(report, allow_nan=False)


# ---- progress and hooks ---------------------------------------------------------------------------------------------

STAGES = [
    "topology",
    "triangles",
    "refinement",
    "map",
    "basis",
    "samples",
    "fit",
    "error",
    "tessellation",
    "inspection",
]


def test_progress_is_told_at_the_start_and_the_end_of_every_stage() -> None:
    told: list[tuple[str, float | None]] = []
    result = pipeline.fit(DATASETS / "cube.off", config(SIZE), REGISTRY, lambda *stage: told.append(stage))
    assert [name for name, _ in told[0::2]] == [name for name, _ in told[1::2]] == ["read", *STAGES]
    assert all(seconds is None for _, seconds in told[0::2])
    assert all(seconds is not None and seconds >= 0 for _, seconds in told[1::2])
    assert list(result.report["seconds"]) == ["read", *STAGES]


def test_the_registry_hears_of_every_stage_with_its_result(monkeypatch: pytest.MonkeyPatch) -> None:
    heard: list[tuple[str, str]] = []
    registry = Registry.discover()
    monkeypatch.setattr(registry, "stage_done", lambda name, result, _: heard.append((name, type(result).__name__)))
    pipeline.fit(mesh_of("tetrahedron"), config(SIZE), registry)
    assert [name for name, _ in heard] == STAGES
    assert dict(heard)["map"] == "Triangulation"
    assert dict(heard)["tessellation"] == "Polyhedron"


# ---- tolerance ------------------------------------------------------------------------------------------------------


def tolerance(value: float) -> Config:
    return Config.load(overrides=["output.refine=1", f"output.tolerance={value}"])


def test_a_tolerance_is_reached_with_few_functions() -> None:
    result = pipeline.fit(DATASETS / "torus.off", tolerance(1e-3), REGISTRY)
    assert result.report["fit"]["rms"] <= 1e-3
    assert result.report["fit"]["size"] == 500
    assert len(result.surface.coefficients) == result.report["fit"]["size"]


def test_a_tolerance_out_of_reach_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(approximation, "_LARGEST_SIZE", 500)
    with pytest.raises(FitError, match=r"500 functions reach an error of .*, not 1.00e-09"):
        pipeline.fit(DATASETS / "cube.off", tolerance(1e-9), REGISTRY)


# ---- errors ---------------------------------------------------------------------------------------------------------


def test_a_mesh_in_one_point_has_no_extent() -> None:
    mesh = reference_polyhedra()["cube"]
    with pytest.raises(TopologyError, match="one point"):
        pipeline.fit(mesh.with_vertices(mesh.vertices * 0 + 3), config(SIZE), REGISTRY)


def test_a_mesh_too_large_for_numbers_is_refused() -> None:
    mesh = reference_polyhedra()["cube"]
    with pytest.raises(TopologyError, match="scale the mesh down"):
        pipeline.fit(mesh.with_vertices((2 * mesh.vertices - 1) * 1.7e308), config(SIZE), REGISTRY)


def test_open_and_empty_meshes_are_refused() -> None:
    cube = reference_polyhedra()["cube"]
    with pytest.raises(TopologyError, match="4 open edges"):
        pipeline.fit(Polyhedron.from_faces(cube.vertices, face_lists(cube)[1:]), config(SIZE), REGISTRY)
    with pytest.raises(TopologyError, match="no faces"):
        pipeline.fit(Polyhedron.from_faces(cube.vertices, []), config(SIZE), REGISTRY)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"absent\.off"):
        pipeline.fit(tmp_path / "absent.off", config(SIZE), REGISTRY)


@pytest.mark.parametrize("size", [0, -3])
def test_a_number_of_functions_that_is_not_positive_is_refused(size: int) -> None:
    with pytest.raises(UsageError, match="size"):
        pipeline.fit(mesh_of("tetrahedron"), config(size), REGISTRY)


def test_more_functions_than_vertices_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mapping, "even_edge_length", lambda triangles, vertices: math.inf)
    with pytest.raises(FitError, match="500 functions need as many distinct vertices"):
        pipeline.fit(DATASETS / "sphere.off", config(500), REGISTRY)


def test_a_group_of_another_surface_is_refused() -> None:
    with pytest.raises(OrbiframeError, match="group"):
        pipeline.fit(mesh_of("double torus"), config(SIZE, "group.method=finite"), REGISTRY)


def test_a_map_to_another_geometry_is_refused() -> None:
    with pytest.raises(MapError, match="does not live on"):
        pipeline.fit(mesh_of("tetrahedron"), config(SIZE, "map.method=harmonic"), REGISTRY)


def test_names_and_options_are_checked_before_the_mesh_is_read(tmp_path: Path) -> None:
    for override in ("basis.name=gausian", "basis.siez=3", "fitter.fairing=much"):
        with pytest.raises(ConfigError):
            pipeline.fit(tmp_path / "absent.off", config(SIZE, override), REGISTRY)


def test_a_folded_map_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    load = REGISTRY.load

    def folding(mesh, geometry, group=None):
        made = load("parametrizer", "harmonic")(mesh, geometry, group)
        points = made.points.copy()
        points[[0, 1]] = points[[1, 0]]
        return replace(made, points=points)

    registry = Registry.discover()
    monkeypatch.setattr(registry, "load", lambda kind, name: folding if kind == "parametrizer" else load(kind, name))
    with pytest.raises(MapError, match=r"\d+ of \d+ triangles are folded"):
        pipeline.fit(mesh_of("torus"), config(SIZE), registry)


@pytest.mark.parametrize("name", ["pillow", "flat box", "coincident"])
def test_degenerate_closed_meshes_are_fitted_or_refused_in_words(name: str) -> None:
    cube = reference_polyhedra()["cube"]
    vertices = cube.vertices.copy()
    vertices[3] = vertices[1]
    mesh = {
        "pillow": Polyhedron.from_faces(np.eye(3), [[0, 1, 2], [2, 1, 0]]),
        "flat box": cube.with_vertices(cube.vertices * [1, 1, 0]),
        "coincident": cube.with_vertices(vertices),
    }[name]
    try:
        result = pipeline.fit(mesh, config(SIZE), REGISTRY)
    except OrbiframeError:
        return
    assert result.report["map"]["not_positive"] == 0
    assert surface_type(result.output).euler_characteristic == 2
