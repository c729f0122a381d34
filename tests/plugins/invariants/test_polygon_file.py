"""Polygons of one's own from a TOML file: the same surfaces as by name, other shapes, and what is wrong in a file."""

from __future__ import annotations

import json

import numpy as np
import pytest

from orbiframe.components.registry import Registry
from orbiframe.errors import GeometryError
from orbiframe.groups import FundamentalPolygon, PolygonGroup
from orbiframe.words.word import Word

OCTAGON = "\n".join(f"  [2.448452447678076, {45 * k}]," for k in range(8))
BOLZA = f'word = "bolza"\nmodel = "polar"\nvertices = [\n{OCTAGON}\n]\n'


def test_the_octagon_of_bolza_from_a_file(orbiframe, tmp_path):
    (tmp_path / "bolza.toml").write_text(BOLZA)
    ran = orbiframe("group", tmp_path / "bolza.toml", "--systole", "--matrices", "--json")
    assert (ran.status, ran.err) == (0, "")
    found, named = json.loads(ran.out), json.loads(orbiframe("group", "bolza", "--matrices", "--json").out)
    assert found["systole"]["length"] == pytest.approx(3.05714183896200, rel=1e-11)
    np.testing.assert_allclose(found["matrices"]["pairings"]["a"], named["matrices"]["pairings"]["a"], atol=1e-9)


def test_a_torus_of_any_lattice(orbiframe, tmp_path):
    """A rectangle of 2 by 1: eigenvalues pi^2 (m^2 + 4 n^2)."""
    (tmp_path / "a.toml").write_text('word = "abAB"\nvertices = [[-1, -0.5], [1, -0.5], [1, 0.5], [-1, 0.5]]\n')
    ran = orbiframe("group", tmp_path / "a.toml", "--spectrum", 3, "--draw", tmp_path / "a.svg", "--json")
    assert (ran.status, ran.err) == (0, "")
    found = json.loads(ran.out)
    values = [(e["value"] / np.pi**2, e["multiplicity"]) for e in found["spectrum"]]
    assert values == [(pytest.approx(0, abs=1e-9), 1), (pytest.approx(1), 2), (pytest.approx(4), 4)]
    assert (tmp_path / "a.svg").exists()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("word = ", "is no TOML"),
        ('word = "abAB"', "vertices is missing"),
        ("vertices = []", "word is missing"),
        ('word = "abAB"\nvertices = []\nangle = 3', "key 'angle' is not known"),
        ('word = "abAB"\nmodel = "klein"\nvertices = [[0, 1]]', "model is 'klein'"),
        ('word = "abAB"\nvertices = [[0, 1], [2, "x"]]', "vertex 1 is"),
        ('word = "abAB"\nvertices = [[0, 1], [2, nan]]', "vertex 1 is"),
        ('word = "abAB"\nvertices = [[1, 0], [0, 1], [-1, 0]]', "3 vertices for the 4 letters"),
        ('word = "abAB"\nvertices = [[1, 0], [0, 1], [-1, 0], [0, -2]]', "sides 0 and 2"),
        ('word = "abA"\nvertices = []', "letter 'b' occurs 1 time"),
    ],
)
def test_what_is_wrong_in_a_file_is_said(orbiframe, tmp_path, text, said):
    (tmp_path / "own.toml").write_text(text)
    ran = orbiframe("group", tmp_path / "own.toml")
    assert ran.status == 1
    assert said in ran.err


def test_named_polygons_are_for_words(orbiframe, tmp_path):
    (tmp_path / "bolza.toml").write_text(BOLZA)
    assert orbiframe("group", tmp_path / "bolza.toml", "--prove").status == 2
    assert "cannot be read" in orbiframe("group", tmp_path / "none.toml").err


def test_a_list_is_as_good_as_an_array():
    plane = Registry.discover().geometry(0)
    square = [[1, -0.5, -0.5], [1, 0.5, -0.5], [1, 0.5, 0.5], [1, -0.5, 0.5]]
    group = PolygonGroup(FundamentalPolygon(plane, square, Word.parse("abAB")))
    assert group.area == pytest.approx(1)
    for wrong in ([1, 2, 3], [["a", 1, 2]] * 4, [[1, np.nan, 0]] * 4, [[1, 2], [3]]):
        with pytest.raises(GeometryError, match="vertices"):
            FundamentalPolygon(plane, wrong, Word.parse("abAB"))
