"""orbiframe draw, and the pictures of orbiframe group."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

DATASETS = Path(__file__).parents[3] / "datasets"
PLATE = DATASETS / "plate_genus2_coarse.off"


def texts(path):
    return [text.text for text in ElementTree.parse(path).getroot().iter("{http://www.w3.org/2000/svg}text")]


def test_a_group_is_drawn_with_its_labels(orbiframe, tmp_path):
    ran = orbiframe("group", "aabbcc", "--draw", tmp_path / "tiles.svg", "--tiles", 7, "--json")
    assert (ran.status, ran.err) == (0, "")
    assert json.loads(ran.out)["picture"] == str(tmp_path / "tiles.svg")
    assert texts(tmp_path / "tiles.svg") == ["a", "a", "b", "b", "c", "c"]


def test_the_eigenvalue_of_a_drawn_function_is_said(orbiframe, tmp_path):
    """The square torus: 4 pi^2 is its first eigenvalue, four times."""
    ran = orbiframe("group", "abAB", "--draw", tmp_path / "wave.svg", "--function", 3, "--json")
    assert (ran.status, ran.err) == (0, "")
    found = json.loads(ran.out)["function"]
    assert found["number"] == 3
    assert found["eigenvalue"] == pytest.approx(39.47841760435743, rel=1e-6)
    assert "<image" in (tmp_path / "wave.svg").read_text()


@pytest.mark.parametrize(
    ("options", "status", "words"),
    [
        (("--draw", "tiles.gif"), 2, ".svg, .png"),
        (("--draw", "none/tiles.svg"), 1, "no folder none"),
        (("--model", "conformal"), 2, "--draw"),
        (("--function", 1), 2, "--draw"),
        (("--draw", "tiles.svg", "--radius", 40), 2, "at most 20000"),
        (("--draw", "tiles.svg", "--model", "sphere"), 2, "projective, conformal, hyperboloid"),
        (("--draw", "tiles.svg", "--function", -1), 1, "counted from 0"),
    ],
)
def test_pictures_of_groups_that_cannot_be(orbiframe, tmp_path, monkeypatch, options, status, words):
    monkeypatch.chdir(tmp_path)
    ran = orbiframe("group", "aabbcc", *options)
    assert ran.status == status
    assert words in ran.err
    assert list(tmp_path.iterdir()) == []


def test_a_mesh_is_drawn_as_a_tessellation(orbiframe, tmp_path):
    for name, options in (("one.svg", ()), ("two.svg", ()), ("other.svg", ("--centre", 7, "--radius", 3))):
        ran = orbiframe("draw", PLATE, "-o", tmp_path / name, "--set", "basis.size=60", *options)
        assert (ran.status, ran.out, ran.err) == (0, "", "")
        ElementTree.parse(tmp_path / name)
    one, two, other = ((tmp_path / name).read_bytes() for name in ("one.svg", "two.svg", "other.svg"))
    assert one == two != other


def test_a_saved_surface_is_drawn_beside_its_tessellation(orbiframe, tmp_path):
    saved = tmp_path / "plate.npz"
    orbiframe("fit", PLATE, "-o", tmp_path / "plate.ply", "--save", saved, "--size", 60, "--refine", 1, "--quiet")
    ran = orbiframe("draw", saved, "--surface", "-o", tmp_path / "both.svg")
    assert (ran.status, ran.err) == (0, "")
    assert (tmp_path / "both.svg").read_text().count("<image") == 1
    ran = orbiframe("draw", saved, "--set", "basis.size=10", "-o", tmp_path / "both.svg")
    assert ran.status == 2
    assert "finished surface" in ran.err


def test_the_loops_of_a_mesh_are_drawn_with_their_letters(orbiframe, tmp_path):
    ran = orbiframe("draw", PLATE, "--cut", "--view", 1, -2, 2, "-o", tmp_path / "cut.svg")
    assert (ran.status, ran.err) == (0, "")
    found = texts(tmp_path / "cut.svg")
    # One letter on each loop, and two on the sides of the octagon.
    assert sorted(found) == sorted("abcd" * 3)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("-o", "tiles.gif"), ".svg, .png"),
        (("-o", "tiles.svg", "--centre", 48), "0 to 47"),
        (("-o", "tiles.svg", "--view", 0, 0, 0), "no direction"),
        (("-o", "tiles.svg", "--radius", 60), "edges"),
        (("-o", "tiles.svg", "--model", "sphere"), "hyperboloid"),
        (("-o", "tiles.svg", "--cut", "--surface"), "not allowed"),
    ],
)
def test_pictures_of_meshes_that_cannot_be(orbiframe, tmp_path, monkeypatch, options, words):
    monkeypatch.chdir(tmp_path)
    ran = orbiframe("draw", PLATE, *options)
    assert ran.status == 2
    assert words in ran.err
    assert list(tmp_path.iterdir()) == []
