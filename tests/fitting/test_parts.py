"""Several surfaces in one file: each as if it were alone, one mesh of all, and one report."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from fitted import DATASETS, REGISTRY, config, mesh_of

from orbiframe import load_surface, read
from orbiframe.errors import TopologyError
from orbiframe.files import gate
from orbiframe.fitting import pipeline
from orbiframe.fitting.parts import fit_parts
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.surface_type import surface_type
from orbiframe.meshes.unions import disjoint_union

pytestmark = pytest.mark.long

NAMES = ("plate_genus2_coarse.off", "torus.off", "klein_bottle.off")


def three() -> Polyhedron:
    """A plate of genus 2, a torus and a Klein bottle side by side."""
    meshes = [read(DATASETS / name, REGISTRY) for name in NAMES]
    moved = [m.with_vertices(m.vertices + np.array([20.0 * k, 0, 0])) for k, m in enumerate(meshes)]
    return disjoint_union(moved)


@pytest.fixture(scope="module")
def found():
    return fit_parts(three(), config(600), REGISTRY)


def test_every_part_is_fitted_as_if_it_were_alone(found) -> None:
    names = sorted(part["surface"]["name"] for part in found.report["parts"])
    assert names == sorted(surface_type(read(DATASETS / name, REGISTRY)).name for name in NAMES)
    sizes = [part["fit"]["size"] for part in found.report["parts"]]
    assert sum(sizes) == found.report["fit"]["size"]
    assert sum(sizes) == pytest.approx(600, abs=100)
    assert min(sizes) >= 100
    for part in found.report["parts"]:
        assert part["map"]["not_positive"] == 0
    whole = next(k for k, part in enumerate(found.report["parts"]) if part["surface"]["euler_characteristic"] == -2)
    alone = read(DATASETS / NAMES[0], REGISTRY)
    again = pipeline.fit(alone, config(sizes[whole]), REGISTRY)
    assert again.report["fit"]["rms"] == pytest.approx(found.report["parts"][whole]["fit"]["rms"], rel=1e-6)


def test_a_share_of_the_functions_goes_by_area(found) -> None:
    areas = [result.surface.scale**2 for result in found.results]
    assert len(areas) == 3
    parts = found.report["parts"]
    errors = [part["fit"]["rms"] * r.surface.scale for part, r in zip(parts, found.results, strict=True)]
    assert found.report["fit"]["rms"] <= max(errors) / three().diagonal
    assert found.report["fit"]["rms"] >= min(errors) / three().diagonal


def test_the_output_is_all_of_them(found) -> None:
    kinds = surface_type(found.output)
    assert (kinds.components, kinds.closed) == (3, True)
    assert found.output.normals is not None
    assert found.report["output"]["euler_characteristic"] == -2
    assert found.output.face_count == sum(result.output.face_count for result in found.results)


def test_one_part_is_a_fit_like_any_other() -> None:
    one = mesh_of("torus")
    parts, alone = fit_parts(one, config(100), REGISTRY), pipeline.fit(one, config(100), REGISTRY)
    assert parts.report.keys() == alone.report.keys()
    np.testing.assert_array_equal(parts.output.vertices, alone.output.vertices)


def test_an_open_part_is_refused_with_its_place() -> None:
    mesh = three()
    last = int(mesh.offsets[-2])
    torn = Polyhedron.from_corners(mesh.vertices, mesh.offsets[:-1], mesh.tail[:last])
    with pytest.raises(TopologyError, match="open edges"):
        fit_parts(torn, config(300), REGISTRY)


def test_the_command_writes_one_mesh_one_report_and_a_surface_for_each(orbiframe, tmp_path: Path) -> None:
    gate.write(tmp_path / "three.ply", three(), REGISTRY)
    asked = (
        "--size",
        300,
        "--refine",
        1,
        "--set",
        "data.lift=false",
        "--report",
        tmp_path / "r.json",
        "--save",
        tmp_path / "s.npz",
    )
    ran = orbiframe("fit", tmp_path / "three.ply", "-o", tmp_path / "out.ply", *asked)
    assert ran.status == 0
    assert "part      1 of 3" in ran.out
    assert "of the diagonal of the box of all parts" in ran.out
    assert surface_type(read(tmp_path / "out.ply", REGISTRY)).components == 3
    assert len(json.loads((tmp_path / "r.json").read_text())["parts"]) == 3
    for number in (1, 2, 3):
        load_surface(tmp_path / f"s-{number}.npz", REGISTRY)


def test_a_component_is_still_chosen(orbiframe, tmp_path: Path) -> None:
    gate.write(tmp_path / "three.ply", three(), REGISTRY)
    ran = orbiframe("fit", tmp_path / "three.ply", "-o", tmp_path / "o.ply", "--component", 1, "--size", 100)
    assert ran.status == 0
    assert "of 3" not in ran.out
    assert surface_type(read(tmp_path / "o.ply", REGISTRY)).components == 1
