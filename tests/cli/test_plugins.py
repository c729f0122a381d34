from __future__ import annotations

import json

import pytest

from orbiframe.plugin import KINDS


def test_every_kind_is_listed_with_the_plugin(orbiframe):
    lines = orbiframe("plugins").out.splitlines()
    assert {line.split()[0] for line in lines} == set(KINDS)
    assert any(line.split()[:3] == ["geometry", "h2", "geometries"] for line in lines)
    assert not any("broken" in line for line in lines)


def test_one_kind(orbiframe):
    assert {line.split()[1] for line in orbiframe("plugins", "--kind", "geometry").out.splitlines()} == {
        "s2",
        "e2",
        "h2",
    }
    assert orbiframe("plugins", "--kind", "geometries").status == 2


def test_json(orbiframe):
    listed = json.loads(orbiframe("plugins", "--json", "--kind", "fitter", "--options").out)
    assert listed["broken"] == []
    (fitter,) = [c for c in listed["components"] if c["name"] == "least-squares"]
    assert fitter["plugin"] == "fitters"
    assert all({"name", "type", "default", "required"} == set(option) for option in fitter["options"])


def test_options_come_from_the_signature(orbiframe):
    out = orbiframe("plugins", "--kind", "basis", "--options").out
    assert "    size: int = " in out


def test_broken_plugins_are_named(orbiframe, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "cli_broken_plugin.py").write_text("1 / 0")
    info = tmp_path / "cli_broken_plugin-1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: cli-broken-plugin\nVersion: 1\n")
    (info / "entry_points.txt").write_text("[orbiframe]\nshattered = cli_broken_plugin\n")
    ran = orbiframe("plugins")
    assert ran.status == 0
    assert "broken plugin 'shattered': ZeroDivisionError: division by zero" in ran.out
    broken = json.loads(orbiframe("plugins", "--json").out)["broken"]
    assert {"plugin": "shattered", "error": "ZeroDivisionError: division by zero"} in broken


@pytest.mark.parametrize("name", ["h2", "geometry/h2"])
def test_check_counts_the_laws_that_hold(orbiframe, name):
    ran = orbiframe("plugins", "check", name)
    assert ran.status == 0
    *verdicts, last = ran.out.splitlines()
    assert last == f"geometry 'h2' of the plugin 'geometries': {len(verdicts)} of {len(verdicts)} laws held"
    assert len(verdicts) > 10


def test_a_reader_without_a_writer_is_tried_as_far_as_that_goes(orbiframe):
    ran = orbiframe("plugins", "check", "reader/collada")
    assert ran.status == 0
    assert "-----  faces_are_found .dae: no writer makes files of this format; name a function" in ran.out
    assert "holds  noise_is_refused .dae" in ran.out
    assert ran.out.splitlines()[-1].endswith("6 of 6 laws held, 3 could not be tried")


def test_check_fails_for_a_broken_component(orbiframe, monkeypatch):
    from orbiframe.testing import geometry_laws

    def impossible(component, lab):
        """Nothing can be right."""
        raise AssertionError("as foreseen")

    monkeypatch.setattr(geometry_laws, "LAWS", (impossible,))
    ran = orbiframe("plugins", "check", "h2")
    assert ran.status == 1
    assert "FAILS  impossible: AssertionError: as foreseen" in ran.out
    assert "5 of 6 laws held" in ran.out


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("nothing", "no component named 'nothing'"),
        ("geometry/hh2", "Did you mean 'h2'"),
        ("off", "reader/off or writer/off"),
    ],
)
def test_check_needs_one_component(orbiframe, name, said):
    ran = orbiframe("plugins", "check", name)
    assert ran.status == 2
    assert said in ran.err
