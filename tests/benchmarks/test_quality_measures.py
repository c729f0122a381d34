"""Measures on spheres, tables, and a tiny run of the whole."""

from __future__ import annotations

import importlib.util
import json

import numpy as np
import pytest
from documents import ROOT
from quality import charts, measures
from quality.results import Result, Results
from quality.shapes import SPHERE
from quality.skins import Skin
from quality.table import tables

pytestmark = pytest.mark.long


def sphere(radius: float) -> Skin:
    mesh = charts.icosphere(24)
    return Skin(radius * mesh.vertices, mesh.triangles, mesh.vertices, np.full(len(mesh.vertices), radius**-2))


def test_a_sphere_of_another_radius_is_off_by_the_difference_both_ways():
    mesh = charts.icosphere(24)
    found = measures.errors(sphere(1.01), mesh, SPHERE)
    assert found.rms == pytest.approx(0.01 / mesh.diagonal, rel=1e-3)
    assert found.max == pytest.approx(0.01 / mesh.diagonal, rel=1e-3)
    assert found.normals < 1e-5
    assert found.curvature == pytest.approx(1 - 1.01**-2, rel=1e-6)
    assert found.crossing == 0
    faces = measures.errors(sphere(1.01), mesh, None)
    assert faces.rms == pytest.approx(0.01 / mesh.diagonal, rel=0.1)
    assert np.isnan(faces.curvature)


def test_the_exact_surface_has_errors_far_below_those_of_its_triangles():
    assert measures.errors(sphere(1), charts.icosphere(24), SPHERE).max < 1e-6


def test_a_part_that_is_missing_shows_from_the_other_side():
    mesh, skin = charts.icosphere(24), sphere(1)
    low = (skin.vertices[skin.triangles][:, :, 2] < 0.5).all(axis=1)
    for truth in (SPHERE, None):
        found = measures.errors(skin._replace(triangles=skin.triangles[low]), mesh, truth)
        assert found.max == pytest.approx(1 / mesh.diagonal, rel=0.2)


def test_triangles_that_meet_are_counted():
    one = sphere(1)
    both = np.concatenate([one.triangles, one.triangles + len(one.vertices)])
    moved = np.concatenate([one.vertices, one.vertices + np.array([0.5, 0.1, 0.02])])
    pair = Skin(moved, both, np.tile(one.normals, (2, 1)), np.tile(one.gaussian, 2))
    assert measures.crossing_triangles(one) == 0
    assert measures.crossing_triangles(pair) > 100


def test_results_are_kept_and_the_best_is_bold(tmp_path):
    results = Results(tmp_path / "quality.json")
    for method, rms in (("a", 1e-3), ("b", 2e-4)):
        results.add(Result("ball", "smooth", "smooth", "closed", 12, method, 1.0, rms, 2 * rms, 0.5, 0.1, 0))
    results.add(Result("ball", "smooth", "smooth", "closed", 12, "c", reason="no"))
    again = Results(tmp_path / "quality.json")
    assert again.rows == results.rows
    lines = list(tables(again.of(["ball"], "abc"), "abc"))
    assert "| ball | 12 | 1.0e-03 | **2.0e-04** | – |" in lines
    assert "| surfaces made | 1 | 1 | 1 | 0 |" in lines


def load_command():
    """`benchmarks/quality.py`: the name `quality` is that of the folder beside it."""
    found = importlib.util.spec_from_file_location("quality_command", ROOT / "benchmarks" / "quality.py")
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_a_tiny_run_prints_tables_fills_a_page_and_goes_on_where_it_stopped(tmp_path, capsys):
    command = load_command()
    page = tmp_path / "page.md"
    page.write_text("above\n<!-- results -->\nold\n<!-- end of results -->\nbelow\n")
    options = [
        "--shape",
        "torus 12 x 8",
        "--method",
        "Loop",
        "--method",
        "linear gaussian size=60",
        "--out",
        str(tmp_path),
    ]
    command.main([*options, "--page", str(page)])
    out = capsys.readouterr().out
    kept = json.loads((tmp_path / "quality.json").read_text())["results"]
    assert {row["method"] for row in kept} == {"Loop", "linear gaussian size=60"}
    assert all(0 < row["rms"] < 0.05 for row in kept)
    assert page.read_text().startswith("above\n")
    assert page.read_text().endswith("below\n")
    assert "old" not in page.read_text()
    assert "| torus 12 x 8 | 96 |" in page.read_text()
    assert (tmp_path / "sheet_1.png").stat().st_size > 10_000
    before = (tmp_path / "quality.json").read_bytes()
    command.main(options)
    assert capsys.readouterr().out == out
    assert (tmp_path / "quality.json").read_bytes() == before


def test_a_method_is_a_basis_with_options():
    from quality.ours import LINEAR, overrides_of

    assert overrides_of("default") == []
    assert overrides_of("ps6 size=500 fitter.fairing=0") == ["basis.name=ps6", "basis.size=500", "fitter.fairing=0"]
    assert overrides_of("linear") == list(LINEAR)
    assert overrides_of("linear ps2") == [*LINEAR, "basis.name=ps2"]
