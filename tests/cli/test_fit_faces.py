"""Fits that are written for CAD as a few faces."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from fitted import DATASETS

from orbiframe import read, write

CUBE = DATASETS / "cube.off"


@pytest.fixture(autouse=True)
def _open_cascade():
    pytest.importorskip("OCP", reason='Open CASCADE is the extra "orbiframe[cad]"')


@pytest.mark.parametrize("name", ["cube.step", "cube.igs"])
def test_few_faces_are_what_a_cad_file_holds(orbiframe, tmp_path, name):
    ran = orbiframe("fit", CUBE, "-o", tmp_path / name, "--size", 100)
    assert (ran.status, ran.err) == (0, "")
    assert "B-spline faces" in ran.out
    assert "tangent planes within 0.0" in ran.out or "tangent planes within 0.10" in ran.out
    assert (tmp_path / name).stat().st_size < 1_500_000


def test_the_report_has_the_faces(orbiframe, tmp_path):
    options = ("--size", 100, "--faces", 40, "--export-tolerance", 1e-3, "--json")
    found = json.loads(orbiframe("fit", CUBE, "-o", tmp_path / "cube.stp", *options).out)["export"]
    assert found["faces"] == 40
    assert found["error"] <= 1e-3
    assert found["angle"] <= 0.1
    assert found["reached"]
    assert found["valid"]


def test_splines_have_exact_patches_where_these_are_asked_for(orbiframe, tmp_path):
    exact = orbiframe("fit", CUBE, "-o", tmp_path / "a.step", "--basis", "ps6", "--size", 60, "--exact")
    few = orbiframe("fit", CUBE, "-o", tmp_path / "b.step", "--basis", "ps6", "--size", 60)
    assert "exact rational patches" in exact.out
    assert "B-spline faces" in few.out


@pytest.mark.parametrize("form", [("--export-tolerance", 1e-2), ("--basis", "ps2", "--exact")])
@pytest.mark.parametrize(("unit", "words"), [("in", "INCH"), ("m", "SI_UNIT($,.METRE.)"), (None, ".MILLI.,.METRE.")])
def test_lengths_are_in_the_unit_that_is_asked_for(orbiframe, tmp_path, unit, words, form):
    """The numbers of a mesh without a unit stay; a reader that works in millimetres sees them in the unit."""
    asked = () if unit is None else ("--unit", unit)
    ran = orbiframe("fit", CUBE, "-o", tmp_path / "part.step", "--size", 40, "--fast", *form, *asked)
    assert (ran.status, ran.err) == (0, "")
    text = (tmp_path / "part.step").read_text()
    assert words in text
    assert "PRODUCT('cube','cube'" in text
    millimetres = {"in": 25.4, "m": 1000.0, None: 1.0}[unit]
    assert volume_of(tmp_path / "part.step") / millimetres**3 == pytest.approx(1, rel=0.1)


def test_lengths_of_iges_are_in_the_unit_that_is_asked_for(orbiframe, tmp_path):
    path = tmp_path / "a.iges"
    options = ("--size", 40, "--fast", "--export-tolerance", 1e-2, "--unit", "in")
    assert orbiframe("fit", CUBE, "-o", path, *options).status == 0
    assert "INCH" in path.read_text()
    assert volume_of(path) / 25.4**3 == pytest.approx(1, rel=0.1)


def volume_of(path):
    from opened_shapes import read_back, volume

    return abs(volume(read_back(path)))


@pytest.mark.parametrize("name", ["plate.step", "plate.xml"])
def test_blocks_of_quads_become_faces(orbiframe, tmp_path, name):
    """The 50 unit squares of the plate, where 32 faces are the default; with 100 asked for there are no blocks."""
    for asked, faces in (((), 50), (("--faces", 100), 100)):
        options = ("--size", 60, "--fast", "--export-tolerance", 1e-2, *asked, "--json")
        ran = orbiframe("fit", DATASETS / "plate_genus2.off", "-o", tmp_path / name, *options)
        assert ran.status == 0
        assert json.loads(ran.out)["export"]["faces"] == faces


def test_colours_that_divide_faces_are_told(orbiframe, tmp_path):
    mesh = read(CUBE)
    paint = np.eye(3)[np.arange(mesh.face_count) % 3]
    write(tmp_path / "painted.off", replace(mesh, face_colors=paint))
    ran = orbiframe("fit", tmp_path / "painted.off", "-o", tmp_path / "a.step", "--size", 40, "--fast")
    assert ran.status == 0
    assert "colours of the mesh divide" in ran.err
    assert (tmp_path / "a.step").read_text().count("FILL_AREA_STYLE_COLOUR") >= 16


def test_what_is_not_reached_is_told_with_its_place(orbiframe, tmp_path, monkeypatch):
    from orbiframe_exact import few_faces

    monkeypatch.setattr(few_faces, "_ROUNDS", 1)
    ran = orbiframe("fit", CUBE, "-o", tmp_path / "a.step", "--size", 100, "--export-tolerance", 1e-6)
    assert ran.status == 0
    assert "near (" in ran.err
    assert "--faces" in ran.err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--faces", 0), "give 1 to"),
        (("--export-tolerance", 0), "give 1e-07 to 1"),
        (("--faces", 20, "--exact"), "without --exact"),
        (("--faces", 20, "-o", "a.ply"), "for CAD"),
        (("--exact", "-o", "a.ply"), "--exact"),
    ],
)
def test_what_cannot_be(orbiframe, tmp_path, monkeypatch, options, words):
    monkeypatch.chdir(tmp_path)
    ran = orbiframe("fit", CUBE, "-o", "a.step", *options)
    assert ran.status == 2
    assert words in ran.err
    assert list(tmp_path.iterdir()) == []
