"""orbiframe group with Conway's symbols, with words that have a name, and with words that are reduced."""

from __future__ import annotations

import json
from fractions import Fraction

import numpy as np
import pytest


@pytest.mark.parametrize(
    ("symbol", "geometry", "chi", "order", "area"),
    [
        ("*237", "h2", "-1/84", None, np.pi / 42),
        ("237", "h2", "-1/42", None, np.pi / 21),
        ("*532", "s2", "1/60", 120, np.pi / 30),
        ("2222", "e2", "0", None, 1.0),
        ("o", "e2", "0", None, 1.0),
        ("xx", "e2", "0", None, 1.0),
        ("oo", "h2", "-2", None, 4 * np.pi),
        ("1", "s2", "2", 1, 4 * np.pi),
    ],
)
def test_a_symbol_is_described_in_json(orbiframe, symbol, geometry, chi, order, area):
    ran = orbiframe("group", symbol, "--json")
    assert (ran.status, ran.err) == (0, "")
    found = json.loads(ran.out)
    assert found["orbifold"]["geometry"] == geometry
    assert Fraction(found["orbifold"]["euler_characteristic"]) == Fraction(chi)
    assert (found["symbol"], found["order"]) == (symbol, order)
    assert found["area"] == pytest.approx(area, rel=1e-11)


def test_generators_and_relations_are_printed(orbiframe):
    ran = orbiframe("group", "*2 3 12")
    assert ran.status == 0
    assert "symbol    *23(12)" in ran.out
    assert "letters   a (reflection), b (reflection), c (reflection)" in ran.out
    assert "(bc)^12 = 1" in ran.out


@pytest.mark.parametrize("symbol", ["*237", "4*2", "22x"])
def test_an_orbifold_is_drawn(orbiframe, tmp_path, symbol):
    picture = tmp_path / "tiles.svg"
    ran = orbiframe("group", symbol, "--draw", picture, "--json")
    assert (ran.status, ran.err) == (0, "")
    assert json.loads(ran.out)["picture"] == str(picture)
    assert picture.read_text().startswith("<")


def test_relations_are_proved(orbiframe):
    ran = orbiframe("group", "abABcdCD", "--prove")
    assert (ran.status, ran.err) == (0, "")
    assert "proof     exact, in Z[zeta, t], zeta of order 32" in ran.out


def test_a_finite_group_is_drawn_on_the_sphere(orbiframe, tmp_path):
    ran = orbiframe("group", "*532", "--draw", tmp_path / "ball.svg")
    assert (ran.status, ran.err) == (0, "")


def test_the_systole_of_a_rotation_group_is_twice_the_glide_of_its_mirrors(orbiframe):
    """The shortest translation of (2, 3, 7) has the trace 1 + 2 cos(2 pi / 7), a quarter of Klein's quartic."""
    lengths = []
    for symbol in ("*237", "237"):
        ran = orbiframe("group", symbol, "--systole", "--json")
        assert (ran.status, ran.err) == (0, "")
        lengths.append(json.loads(ran.out)["systole"]["length"])
    assert lengths[1] == pytest.approx(2 * lengths[0], rel=1e-9)
    assert 2 * np.cosh(lengths[1] / 2) == pytest.approx(1 + 2 * np.cos(2 * np.pi / 7), rel=1e-9)


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["23"], "bad orbifold"),
        (["*203"], "order 0"),
        (["*237", "--prove"], "gluing words"),
        (["abAB", "--prove"], "hyperbolic"),
        (["*532", "--systole"], "*532' has 120 elements"),
        (["532", "--draw", "a.svg", "--function", "1"], "for infinite groups"),
        (["532", "--spectrum", "0"], "at least 1"),
        (["bolzas"], "Did you mean 'bolza'"),
    ],
)
def test_what_cannot_be_is_refused_in_words(orbiframe, tmp_path, monkeypatch, arguments, problem):
    monkeypatch.chdir(tmp_path)
    ran = orbiframe("group", *arguments)
    assert ran.status != 0
    assert problem in ran.err


@pytest.mark.parametrize(
    ("symbol", "expected"),
    [
        # cos(pi m x) cos(pi n y) on the unit square with free boundary.
        ("*2222", [(0, 1), (np.pi**2, 2), (2 * np.pi**2, 1)]),
        # Half of it with the area 1 along the diagonal, and the square again as its double.
        ("*442", [(0, 1), (np.pi**2 / 2, 1), (np.pi**2, 1)]),
        ("2222", [(0, 1), (2 * np.pi**2, 2), (4 * np.pi**2, 2)]),
        # The same for the triangle and its double: the least function of 237 is symmetric.
        ("*237", [(0, 1), (44.88835360397, 1)]),
        ("237", [(0, 1), (44.88835360397, 1)]),
    ],
)
def test_the_spectrum_of_an_orbifold(orbiframe, symbol, expected):
    """With derivative zero across mirrors."""
    ran = orbiframe("group", symbol, "--spectrum", len(expected), "--json")
    assert (ran.status, ran.err) == (0, "")
    found = json.loads(ran.out)["spectrum"]
    for line, (value, multiplicity) in zip(found, expected, strict=True):
        assert line["value"] == pytest.approx(value, abs=1e-9)
        assert line["multiplicity"] == multiplicity


def test_an_eigenfunction_of_a_triangle_is_drawn(orbiframe, tmp_path):
    ran = orbiframe("group", "*442", "--draw", tmp_path / "function.svg", "--function", 1, "--json")
    assert (ran.status, ran.err) == (0, "")
    assert json.loads(ran.out)["function"]["eigenvalue"] == pytest.approx(np.pi**2 / 2, rel=1e-6)


def test_a_word_is_reduced_with_the_change_of_its_letters(orbiframe):
    found = json.loads(orbiframe("group", "abcdABCD", "--json").out)["standard"]
    assert found["word"] == "abABcdCD"
    assert sorted(found["letters"]) == sorted(found["given"]) == list("abcd")
    assert "standard" not in json.loads(orbiframe("group", "abABcdCD", "--json").out)


def test_the_klein_quartic_is_built_in(orbiframe):
    found = json.loads(orbiframe("group", "klein-quartic", "--json").out)
    assert found["surface"]["name"] == "genus 3"
    assert found["vertices"] == 2


def test_errors_stand_in_the_text_as_in_the_numbers(orbiframe):
    lines = orbiframe("group", "*2222", "--spectrum", 2, "--degree", 6).out.splitlines()
    told = json.loads(orbiframe("group", "*2222", "--spectrum", 2, "--degree", 6, "--json").out)["spectrum"][1]
    assert lines[-1].split()[-2:] == ["error", f"{told['error']:.1e}"]
    assert abs(float(lines[-1].split()[0]) - np.pi**2) < 10 * told["error"]
    fine = json.loads(orbiframe("group", "*2222", "--spectrum", 2, "--tolerance", 1e-11, "--json").out)["spectrum"][1]
    assert fine["error"] <= 1e-11 * np.pi**2 < told["error"]
    assert abs(fine["value"] - np.pi**2) <= fine["error"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--degree", "6"], "belongs to a spectrum"),
        (["--spectrum", "2", "--degree", "7"], "even degree from 4 to 14"),
        (["--spectrum", "2", "--tolerance", "0"], "between 0 and 1"),
    ],
)
def test_options_of_spectra_that_cannot_be_are_refused(orbiframe, arguments, said):
    ran = orbiframe("group", "*2222", *arguments)
    assert ran.status == 2
    assert said in ran.err
