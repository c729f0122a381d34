"""Fits that keep creases, on the command line."""

from __future__ import annotations

import json

import pytest
from fitted import DATASETS

CUBE = DATASETS / "cube.off"
QUICK = ("--creases", 30, "--size", 250, "--basis", "ps2")


def test_the_summary_and_the_report_say_what_was_kept(orbiframe, tmp_path):
    ran = orbiframe("fit", CUBE, "-o", tmp_path / "cube.obj", *QUICK, "--report", tmp_path / "cube.json")
    assert (ran.status, ran.err) == (0, "")
    assert "creases   12 curves of 30° or more, 8 corners, 0 ends; within" in ran.out
    creases = json.loads((tmp_path / "cube.json").read_text())["creases"]
    assert (creases["curves"], creases["corners"], creases["ends"], creases["angle_from"]) == (12, 8, 0, 30)
    assert creases["distance"] < 5e-5


@pytest.mark.long
def test_cad_files_have_creases_as_edges_of_a_few_faces(orbiframe, tmp_path):
    pytest.importorskip("OCP", reason='Open CASCADE is the extra "orbiframe[cad]"')
    ran = orbiframe("fit", CUBE, "-o", tmp_path / "cube.step", *QUICK, "--export-tolerance", 1e-3, "--json")
    assert ran.status == 0
    found = json.loads(ran.out)["export"]
    assert (found["planes"], found["faces"], found["valid"]) == (6, 6, True)
    exact = orbiframe("fit", CUBE, "-o", tmp_path / "exact.step", *QUICK, "--exact")
    assert "exact rational patches" in exact.out
    few = orbiframe("fit", CUBE, "-o", tmp_path / "few.step", *QUICK, "--faces", 20)
    assert few.status == 2
    assert "creases decide how many faces there are" in few.err
    assert not (tmp_path / "few.step").exists()
    patches = orbiframe("fit", CUBE, "-o", tmp_path / "patches.xml", *QUICK)
    assert patches.status == 2
    assert "patches round creases off" in patches.err


@pytest.mark.long
def test_elements_have_creases_as_edges(orbiframe, tmp_path):
    ran = orbiframe("fit", CUBE, "-o", tmp_path / "cube.msh", *QUICK, "--order", 2)
    assert (ran.status, ran.err) == (0, "")
    assert "triangles of order 2" in ran.out


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--creases", 0), "data.creases = 0.0: input should be greater than 0"),
        (("--creases", "sharp"), "data.creases = 'sharp': input should be a valid number or 'marked'"),
        (("--creases", 181), "data.creases = 181.0: input should be less than or equal to 180"),
        (("--creases", 120), "no edge of the mesh bends by 120° or more (the sharpest by 90.0°)"),
        (("--creases", 30, "--basis", "gaussian"), "the functions 'gaussian' keep no creases"),
    ],
)
def test_what_cannot_be_done_is_said(orbiframe, tmp_path, options, words):
    ran = orbiframe("fit", CUBE, "-o", tmp_path / "cube.obj", *options)
    assert ran.status != 0
    assert words in ran.err
    assert "Traceback" not in ran.err
