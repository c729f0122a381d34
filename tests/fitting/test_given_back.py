"""What a fit gives back, in Python: from any mesh, in one line, in a notebook, to other libraries, copied."""

from __future__ import annotations

import copy
import pickle
import re
import time
from pathlib import Path

import numpy as np
import pytest

import orbiframe
from orbiframe.fitting import fit_parts
from orbiframe.fitting.told import told

TORUS = Path(__file__).parents[2] / "datasets" / "torus.off"


@pytest.fixture(scope="module")
def result():
    return orbiframe.fit(TORUS, size=60, fast=True, refine=1)


def test_the_registry_and_the_configuration_may_be_left_out(result):
    config = orbiframe.Config.load(
        overrides=["basis.size=60", "fitter.name=least-squares", "data.lift=false", "output.refine=1"]
    )
    same = orbiframe.fit(str(TORUS), config, orbiframe.Registry.discover())
    assert np.array_equal(result.output.vertices, same.output.vertices)


def test_arrays_and_meshes_are_fitted_like_their_file(result):
    mesh = orbiframe.read(TORUS)
    faces = [mesh.face_corners(face) for face in range(mesh.face_count)]
    found = orbiframe.fit((mesh.vertices, faces), size=60, fast=True, refine=1)
    assert np.array_equal(result.output.vertices, found.output.vertices)


def test_arrays_are_taken_where_a_mesh_is(tmp_path):
    mesh = orbiframe.read(TORUS)
    pair = mesh.vertices, [mesh.face_corners(face) for face in range(mesh.face_count)]
    assert orbiframe.surface_type(pair).genus == 1
    orbiframe.write(tmp_path / "torus.off", pair)
    assert (tmp_path / "torus.off").read_bytes().startswith(b"OFF")
    with pytest.raises(orbiframe.UsageError, match="is no mesh"):
        orbiframe.fit({"vertices": pair[0]})


def test_it_is_one_line(result):
    surface = result.surface
    parts = surface.triangulation, surface.orbifold, surface.orbifold.atlas, surface.refinement, result.output, surface
    for thing in (result, *parts, orbiframe.Registry.discover()):
        assert "\n" not in repr(thing)
        assert len(repr(thing)) < 250, repr(thing)
    assert repr(result).startswith("<Result: closed, orientable, genus 1, 1 component; 60 functions; rms ")


def test_a_notebook_shows_a_picture_and_the_report(result):
    page = result._repr_html_()
    assert 'src="data:image/png;base64,iVBORw0KGgo' in page
    rows = dict(re.findall(r"<tr><th>(.*?)</th><td>(.*?)</td></tr>", page))
    assert rows["surface"] == "closed, orientable, genus 1, 1 component, Euler characteristic 0"
    assert rows["fit"] == "60 functions of gaussian, by least-squares"


def test_words_are_no_markup(result):
    report = copy.deepcopy(result.report)
    report["notes"] = ["<script>"]
    page = type(result)(result.surface, result.output, report, result.input, result.samples)._repr_html_()
    assert "<script>" not in page
    assert "&lt;script&gt;" in page


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing))])
@pytest.mark.parametrize("basis", ["gaussian", "ps2", "simplex"])
def test_a_copy_evaluates_to_the_same_bits(basis, copied):
    result = orbiframe.fit(TORUS, basis=basis, size=60, fast=True, refine=1)
    points = result.surface.points([0, 1], np.full((2, 3), 1 / 3))
    before = result.surface.curvature(points).gaussian
    again = copied(result)
    assert again.report == result.report
    places = again.surface.points([0, 1], np.full((2, 3), 1 / 3))
    assert np.array_equal(again.surface.curvature(places).gaussian, before)


def test_a_field_a_distance_and_a_picture_are_one_call_each(result, tmp_path):
    surface = result.surface
    field = surface.fit_field(result.output.vertices[::50], result.output.vertices[::50, 2])
    assert copy.deepcopy(field).evaluate(field.points).shape == (len(field.points.patch), 1)
    assert "\n" not in repr(field)
    assert (surface.distance(result.output.vertices[:5]) < 1e-9).all()
    surface.picture(tmp_path / "surface.png", width=50)
    result.picture(tmp_path / "result.png", width=50)
    assert (tmp_path / "surface.png").read_bytes()[:4] == (tmp_path / "result.png").read_bytes()[:4] == b"\x89PNG"
    with pytest.raises(orbiframe.UsageError, match=r"a picture is written as \.png"):
        surface.picture(tmp_path / "surface.jpg", width=50)


def test_several_surfaces_are_given_back_alike(tmp_path):
    from orbiframe.meshes import disjoint_union

    mesh = orbiframe.read(TORUS)
    both = disjoint_union([mesh, mesh.with_vertices(mesh.vertices + 5)])
    parts = fit_parts(both, size=200, fast=True, refine=1)
    assert repr(parts).startswith("<Parts: 2 surfaces; 200 functions; ")
    assert "<th>all</th>" in parts._repr_html_()
    assert parts.to_meshio().points.shape == parts.output.vertices.shape


# ---- who is told -----------------------------------------------------------------------------------------------------


def test_what_takes_long_is_told_within_two_seconds(capsys):
    start = time.monotonic()
    with told(None) as heard:
        heard("map", None)
        said = ""
        while not said and time.monotonic() < start + 10:
            time.sleep(0.01)
            said = capsys.readouterr().err
    assert time.monotonic() - start < 2.5
    assert re.fullmatch(r"orbiframe: fitting, at the stage 'map', 2 s so far …\n", said)


def test_what_is_quick_is_not_told(capsys):
    with told(None) as heard:
        heard("map", None)
        heard("map", 0.0)
    assert capsys.readouterr().err == ""


def test_whoever_listens_is_told_instead(capsys):
    seen = []
    with told(lambda stage, seconds: seen.append(stage)) as heard:
        heard("map", None)
    with told(False) as heard:
        heard("map", None)
    assert seen == ["map"]
    assert capsys.readouterr().err == ""
