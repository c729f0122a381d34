from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from orbiframe import MapError
from orbiframe.cli.report import json_text, summary, write_report
from orbiframe.fitting import parts, pipeline

KEYS = {
    "surface": {"euler_characteristic", "orientable", "genus", "components"},
    "group": {"source", "patches", "relation_defect"},
    "map": {"triangles", "not_positive", "area_defect", "angle_distortion", "weights"},
    "fit": {"basis", "size", "samples", "rms", "max"},
    "output": {"vertices", "faces", "euler_characteristic"},
}


@pytest.fixture
def small(cube):
    """Arguments of a fit that takes a moment only."""
    return [cube, "--size", "60", "--refine", "4"]


def test_a_cube_becomes_smooth(orbiframe, small, tmp_path):
    out, report, saved = tmp_path / "smooth.ply", tmp_path / "report.json", tmp_path / "smooth.native"
    ran = orbiframe("fit", *small, "-o", out, "--report", report, "--save", saved)
    assert (ran.status, ran.err) == (0, "")
    assert "closed, orientable, genus 0, 1 component" in ran.out
    written = json.loads(report.read_text())
    for table, keys in KEYS.items():
        assert keys <= set(written[table])
    assert {"median", "p95", "max"} == set(written["map"]["angle_distortion"])
    assert (written["geometry"], written["fit"]["size"], written["output"]["faces"]) == ("s2", 60, 12 * 16)
    assert written["surface"] == written["surface"] | {"euler_characteristic": 2, "orientable": True, "genus": 0}
    assert 0 < written["fit"]["rms"] <= written["fit"]["max"] < 0.1
    assert sum(written["seconds"].values()) > 0
    assert "numpy" in written["versions"]
    assert saved.stat().st_size > 0
    described = json.loads(orbiframe("info", out, "--json").out)
    assert (described["faces"], described["genus"], described["closed"]) == (12 * 16, 0, True)
    assert {path.name for path in tmp_path.iterdir()} == {"cube.off", "smooth.ply", "report.json", "smooth.native"}


def test_json_and_quiet(orbiframe, small, tmp_path):
    ran = orbiframe("fit", *small, "-o", tmp_path / "a.ply", "--json")
    assert json.loads(ran.out)["fit"]["basis"] == "gaussian"
    assert orbiframe("fit", *small, "-o", tmp_path / "b.ply", "--quiet") == (0, "", "")
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()


def test_a_configuration_file_and_overrides(orbiframe, cube, tmp_path):
    config = tmp_path / "my.toml"
    config.write_text("[basis]\nsize = 50\n[output]\nrefine = 2\n")
    ran = orbiframe("fit", cube, "-o", tmp_path / "a.ply", "--config", config, "--set", "basis.size=40", "--json")
    report = json.loads(ran.out)
    assert (report["fit"]["size"], report["output"]["faces"]) == (40, 12 * 4)


@pytest.mark.usefixtures("_no_fit")
def test_options_with_a_name_of_their_own_win_over_set(orbiframe, cube, tmp_path, monkeypatch):
    """Whatever their order on the command line is."""
    asked = []

    def fit(mesh, config, *rest, **more):
        asked.append((config.basis.name, config.basis.options["size"], config.output.refine))
        raise MapError("enough")

    monkeypatch.setattr(parts, "fit", fit)
    given = ["--set", "basis.size=300", "--set", "output.refine=7", "--set", "basis.name=gaussian"]
    named = ["--size", "40", "--refine", "2", "--basis", "ps2"]
    for arguments in (given + named, named + given):
        assert orbiframe("fit", cube, "-o", tmp_path / "a.ply", *arguments).status == 1
    assert asked == [("ps2", 40, 2)] * 2


def test_a_plugin_file_takes_part(orbiframe, small, tmp_path):
    (tmp_path / "my_plain_fitter.py").write_text(
        """
from orbiframe import Component, Fitter, hookimpl
@hookimpl
def orbiframe_components():
    return [Component("fitter", "plain", "my_plain_fitter:Plain", "least squares without fairing")]
class Plain(Fitter):
    def fit(self, basis, samples):
        import numpy as np
        matrix = basis.design_matrix(samples.points).toarray()
        return np.linalg.lstsq(matrix, samples.values, rcond=None)[0]
"""
    )
    config = tmp_path / "my.toml"
    config.write_text("plugins = ['./my_plain_fitter.py']\n[fitter]\nname = 'plain'\n")
    assert orbiframe("fit", *small, "-o", tmp_path / "a.ply", "--config", config).status == 0


@pytest.fixture
def _no_fit(monkeypatch):
    def fit(*arguments):
        raise AssertionError("the long work has begun")

    monkeypatch.setattr(pipeline, "fit", fit)


@pytest.mark.usefixtures("_no_fit")
@pytest.mark.parametrize(
    ("arguments", "status", "said"),
    [
        (["-o", "a.plyy"], 1, "'.plyy'"),
        (["-o", "absent/a.ply"], 1, "there is no folder"),
        (["-o", "a.ply", "--report", "absent/r.json"], 1, "there is no folder"),
        (["-o", "a.ply", "--save", "absent/s"], 1, "there is no folder"),
        (["-o", "cube.off"], 2, "the input itself"),
        (["-o", "a.ply", "--report", "cube.off"], 2, "the input itself"),
        (["-o", "a.ply", "--save", "./a.ply"], 2, "named by -o and by --save"),
        (["-o", "a.ply", "--report", "r", "--save", "r"], 2, "named by --report and by --save"),
        (["-o", "a.ply", "--config", "c.toml", "--report", "c.toml"], 2, "--config itself"),
        (["-o", "a.ply", "--report", "/dev/null"], 1, "is a device"),
        (["-o", "a.ply", "--save", "/dev/null"], 1, "is a device"),
        (["-o", "pipe.ply"], 1, "it is a pipe"),
        (["-o", "a.ply", "--report", "pipe.ply"], 1, "it is a pipe"),
        (["-o", "a.ply", "--config", "pipe.ply"], 2, "this is a pipe"),
        (["-o", "a.ply", "--size", "1000000000"], 2, "basis.size = 1000000000: that takes about 20000 GB"),
        (["-o", "a.ply", "--size", "0"], 2, "basis.size = 0; give 1 to 100000"),
        (["-o", "a.ply", "--size", "-3"], 2, "basis.size = -3; give 1 to 100000"),
        (["-o", "a.ply", "--set", "basis.size=" + "9" * 40], 2, "about 10^40: that takes about 10^35 GB"),
        (["-o", "a.ply", "--set", "basis.size=" + "9" * 3000], 2, "about 10^3000: that takes"),
        (["-o", "a.ply", "--set", "basis.size=" + "9" * 9000], 2, "4300 digits"),
        (["-o", "a.ply", "--set", "basis.size=" + "[" * 5000], 2, "nested too deep"),
        (["-o", "a.ply", "--set", "basis.size=" + "[" * 40 + "]" * 40], 2, "nested more than 20 deep"),
        (["-o", "a.ply", "--set", "basis.width=nan"], 2, "nan is no finite number"),
        (["-o", "a.ply", "--tolerance", "inf"], 2, "inf is no finite number"),
        (["-o", "a.ply", "--set", "x" * 10**6 + ".a=1"], 2, "no table named"),
        (["-o", "a.ply", "--set", "basis." + "x" * 10**6 + "=1"], 2, "has no option"),
        (["-o", "a.ply", "--set", "basis.name=" + "x" * 10**6], 2, "no basis named"),
        (["-o", "a.ply", "--set", "basis.name=a\n[output]\nrefine=3"], 2, "no basis named"),
        (["-o", "a.ply", "--size", "many"], 2, "invalid int value: 'many'"),
        (["-o", "a.ply", "--refine", "0"], 2, "output.refine = 0"),
        (["-o", "a.ply", "--tolerance", "-1"], 2, "output.tolerance = -1"),
        (["-o", "a.ply", "--set", "basis.siez=3"], 2, "Did you mean 'size'?"),
        (["-o", "a.ply", "--set", "basis.name=gausian"], 2, "Did you mean 'gaussian'?"),
        (["-o", "a.ply", "--config", "absent.toml"], 2, "absent.toml cannot be read"),
    ],
)
def test_what_is_wrong_is_said_before_the_work(orbiframe, cube, tmp_path, monkeypatch, arguments, status, said):
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe.ply")
    (tmp_path / "c.toml").write_text("[basis]\nsize = 30\n")
    before = cube.read_bytes()
    ran = orbiframe("fit", "cube.off", *arguments)
    assert ran.status == status
    assert said in ran.err
    assert len(ran.err) < 3000
    assert ran.out == ""
    assert cube.read_bytes() == before


def test_a_mesh_with_a_hole_is_refused_in_one_sentence(orbiframe, cube, tmp_path):
    lines = cube.read_text().splitlines()
    cube.write_text("\n".join([lines[0], "8 5 12", *lines[2:-1]]) + "\n")
    ran = orbiframe("fit", cube, "-o", tmp_path / "a.ply")
    assert ran.status == 1
    assert ran.err.startswith("orbiframe: ")
    assert "4 open edges" in ran.err
    assert len(ran.err.splitlines()) == 1
    assert not (tmp_path / "a.ply").exists()


DATASETS = Path(__file__).parents[2] / "datasets"

REPORT = {
    "surface": {"name": "closed, orientable, genus 2, 1 component", "euler_characteristic": -2},
    "triangles": {"diagonals": 50, "faces_cut": 50, "points": 0, "rule": "the shortest"},
    "geometry": "h2",
    "group": {"source": "mesh", "patches": 1, "relation_defect": 2.5e-15},
    "map": {
        "triangles": 400,
        "not_positive": 0,
        "crowding": {"area_ratio": 0.1, "digits_lost": 1.0},
        "angle_distortion": {"median": 1.1, "p95": 1.5, "max": float("inf")},
    },
    "faces": {
        "corners": 4,
        "angle": {"median": 3.21, "max": 9.0},
        "adjacent": {"median": 1.25, "max": 2.0},
        "before": {"angle": {"median": 30.0, "max": 40.0}, "adjacent": {"median": 4.5, "max": 7.0}},
    },
    "data": {"means": "facets", "reason": "asked for"},
    "fit": {"basis": "gaussian", "size": 100, "samples": 900, "fitter": "sliding", "rms": 1e-3, "max": 5e-3},
    "distance": {
        key: {"rms": 1e-3, "max": 5e-3, "place": [1.0, 2.0, 3.0]}
        for key in ("mesh_to_surface", "surface_to_mesh", "vertices_to_surface")
    },
    "notes": [],
    "output": {"vertices": 800, "faces": 1600},
    "seconds": {"map": 1.5, "fit": 0.25},
}


def test_the_summary_says_what_came_out():
    text = summary(REPORT)
    for words in (
        "genus 2",
        "h2",
        "1 patch,",
        "2.5e-15",
        "median 1.10",
        "50 diagonals",
        "off by 3.2° (max 9.0°), sides 1 : 1.25 (max 2.00) (before: angles off by 30.0°",
        "100 functions",
        "1.00e-03",
        "800 vertices",
        "1.8 (",
    ):
        assert words in text


def test_triangles_have_no_line_of_faces():
    triangles = {**REPORT, "faces": {**REPORT["faces"], "corners": 3}}
    assert "\nfaces" in summary(REPORT)
    assert "\nfaces" not in summary(triangles)


def test_shapes_are_improved_and_reported_before_and_after(orbiframe, tmp_path):
    """A grid on a Klein bottle becomes squares."""
    out = tmp_path / "out.ply"
    ran = orbiframe("fit", DATASETS / "klein_bottle.off", "-o", out, "--size", 50, "--shape", "regular-faces", "--json")
    report = json.loads(ran.out)
    faces = report["faces"]
    assert report["map"]["not_positive"] == 0
    assert report["map"]["weights"] == "shape"
    assert faces["count"] == faces["before"]["count"] == 288
    assert faces["adjacent"]["max"] < 1 + 1e-9 < 3 < faces["before"]["adjacent"]["max"]
    assert faces["angle"]["max"] < 1e-9 < 20 < faces["before"]["angle"]["max"]
    assert "shape" in report["seconds"]


def test_an_unknown_optimizer_is_refused(orbiframe, tmp_path):
    ran = orbiframe("fit", DATASETS / "cube.off", "-o", tmp_path / "out.ply", "--shape", "regular-face")
    assert ran.status == 2
    assert "Did you mean 'regular-faces'" in ran.err


def test_a_report_is_written_whole_or_not_at_all(tmp_path):
    path = tmp_path / "report.json"
    write_report(path, REPORT)
    first = path.read_text()
    assert json.loads(first)["map"]["angle_distortion"]["max"] is None
    with pytest.raises(TypeError):
        write_report(path, {"surface": object()})
    assert path.read_text() == first
    assert list(tmp_path.iterdir()) == [path]
    assert json_text({"a": (1, float("nan"))}).split() == ["{", '"a":', "[", "1,", "null", "]", "}"]


@pytest.mark.parametrize("density", [600, 10**9, 10**40])
def test_an_output_too_large_is_refused_with_its_number(orbiframe, cube, tmp_path, density):
    ran = orbiframe("fit", cube, "-o", tmp_path / "a.ply", "--size", 30, "--refine", density)
    assert ran.status == 2
    assert "triangles of 12: that takes about" in ran.err
    assert "GB of memory; give 1 to 577" in ran.err
    assert [path.name for path in tmp_path.iterdir()] == ["cube.off"]


def test_links_and_modes_of_report_and_surface_are_kept(orbiframe, cube, tmp_path):
    places = [tmp_path / name for name in ("a.ply", "r.json", "s.npz")]
    (tmp_path / "behind").mkdir()
    for place in places:
        behind = tmp_path / "behind" / place.name
        behind.write_text("old")
        behind.chmod(0o600)
        place.symlink_to(behind)
    out, report, save = places
    assert (
        orbiframe("fit", cube, "-o", out, "--report", report, "--save", save, "--size", 30, "--refine", 1).status == 0
    )
    for place in places:
        assert place.is_symlink()
        assert place.stat().st_size > 100
        assert place.stat().st_mode & 0o777 == 0o600
    assert sorted(path.name for path in (tmp_path / "behind").iterdir()) == ["a.ply", "r.json", "s.npz"]


def test_a_bent_edge_comes_out_closed(orbiframe, cube, tmp_path):
    """A vertex of valence 2: both faces at it, cut alone, get the same diagonal."""
    lines = cube.read_text().splitlines()
    lines[1] = "9 6 13"
    lines.insert(10, "0.5 -0.3 -0.3")
    lines[-6:] = ["4 0 1 3 2", "4 4 6 7 5", "5 0 8 4 5 1", "4 2 3 7 6", "5 0 2 6 4 8", "4 1 5 7 3"]
    cube.write_text("\n".join(lines) + "\n")
    triangles, surface = tmp_path / "t.off", tmp_path / "s.ply"
    assert orbiframe("convert", "--triangulate", cube, triangles).status == 0
    assert orbiframe("fit", cube, "-o", surface, "--size", 40).status == 0
    for path in (triangles, surface):
        assert "closed, orientable, genus 0, 1 component" in orbiframe("info", path).out


def test_uv_coordinates_are_written_and_told(orbiframe, cube, tmp_path):
    to, report = tmp_path / "a.obj", tmp_path / "a.json"
    ran = orbiframe("fit", cube, "-o", to, "--uv", "--size", 40, "--fast", "--report", report)
    assert ran.status == 0
    assert "uv        cut open along" in ran.out
    told = json.loads(report.read_text())["uv"]
    assert told["folded"] == 0
    assert told["angle_distortion"]["median"] >= 1
    assert to.read_text().count("\nvt ") > 1000


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["-o", "a.ply"], "a.ply: this format holds no texture coordinates; write .glb, .gltf, .obj"),
        (["-o", "a.msh", "--order", "2"], "belong to meshes of flat faces, such as surface.obj"),
    ],
)
def test_uv_coordinates_need_a_format_that_holds_them(orbiframe, cube, tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    ran = orbiframe("fit", cube, *arguments, "--uv")
    assert (ran.status, said in ran.err) == (2, True), ran.err
    assert list(tmp_path.glob("a.*")) == []
