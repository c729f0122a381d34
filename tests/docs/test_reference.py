"""The reference pages say what the program says."""

from __future__ import annotations

import argparse
import re
from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from documents import ROOT, section, table_rows

from orbiframe import FormatError, fit
from orbiframe.cli import plugin as commands
from orbiframe.components.options import options_of
from orbiframe.components.registry import Registry
from orbiframe.files import gate
from orbiframe.fitting import mapping
from orbiframe.fitting.config import OPEN_NAMES, STEPS, Config, Data, Output
from orbiframe.plugin import DEFAULT_MARKER

REFERENCE = ROOT / "docs" / "reference"


@pytest.fixture(scope="module")
def registry() -> Registry:
    found = Registry.discover()
    found.register("commands", commands)
    return found


def unquoted(cell: str) -> str:
    return cell.replace("`", "")


def column(page: Path, heading: str) -> list[str]:
    return [unquoted(row[0]) for row in table_rows(section(page, heading))]


def command_names() -> list[str]:
    found = Registry.discover()
    found.register("commands", commands)
    return [component.name for component in found.components("command")]


@pytest.mark.parametrize("command", command_names())
def test_every_option_of_a_command_is_in_its_table(command, registry):
    parser = argparse.ArgumentParser()
    registry.load("command", command)(parser)
    if command == "new":  # It has one thing to begin, with options of its own.
        parser = next(iter(parser._subparsers._group_actions[0].choices.values()))
    flags = [a.option_strings for a in parser._actions if a.option_strings and a.dest != "help"]
    known = [", ".join(sorted(names, key=len)) for names in flags]
    assert column(REFERENCE / "cli.md", f"orbiframe {command}") == known


def test_every_command_has_a_section(registry):
    for component in registry.components("command"):
        section(REFERENCE / "cli.md", f"orbiframe {component.name}")


@pytest.mark.parametrize("table", STEPS)
def test_every_option_of_a_table_is_in_its_section(table, registry):
    kind, key, default = STEPS[table]
    rows = {unquoted(row[0]): unquoted(row[1]) for row in table_rows(section(REFERENCE / "config.md", table))}
    assert rows.pop(key) == default
    assert rows.pop("boundary", None) == ("error" if table == "mesh" else None)
    assert rows.pop("like", None) == ("None" if table == "map" else None)
    assert rows == _defaults(kind, default, registry)


def _defaults(kind: str, name: str, registry: Registry) -> dict[str, str]:
    """The options of the default component of a step; of all that the pipeline may choose, where it is open."""
    choices = {"parametrizer": list(mapping.PARAMETRIZER.values()), "marker": [DEFAULT_MARKER]}
    chosen = choices.get(kind, []) if name in OPEN_NAMES else [name]
    return {o.name: str(o.default) for name in chosen for o in options_of(registry.load(kind, name))}


def test_every_option_of_every_basis_is_in_its_table(registry):
    rows = table_rows(section(REFERENCE / "config.md", "Options of the bases"))
    declared = [
        (component.name, option.name, str(option.default))
        for component in registry.components("basis")
        for option in options_of(registry.load("basis", component.name))
        if option.name != "size"
    ]
    assert sorted(tuple(map(unquoted, row[:3])) for row in rows) == sorted(declared)


@pytest.mark.parametrize("name", sorted(set(mapping.PARAMETRIZER.values())))
def test_every_choice_of_weights_is_named(name, registry):
    weights = next(o for o in options_of(registry.load("parametrizer", name)) if o.name == "weights")
    row = next(row for row in table_rows(section(REFERENCE / "config.md", "map")) if unquoted(row[0]) == "weights")
    told = next(part for part in row[2].split(";") if part.strip().startswith(f"{name}:"))
    assert set(get_args(weights.annotation)) <= set(re.findall(r"[\w-]+", told))


@pytest.mark.parametrize(("table", "options"), [("output", Output), ("data", Data)])
def test_every_option_of_the_output_and_of_the_data_is_in_its_section(table, options):
    rows = {unquoted(row[0]): unquoted(row[1]) for row in table_rows(section(REFERENCE / "config.md", table))}
    assert rows == {option.name: str(option.default).lower() for option in options_of(options)}


def test_every_suffix_is_in_the_table_of_formats(registry):
    """Format, suffixes, and which of reading and writing there is."""
    shown = {unquoted(row[0]): (set(unquoted(row[1]).split()), row[2]) for row in _formats()}
    for kind, verb in (("reader", "read"), ("writer", "write")):
        declared = {c.name: set(c.suffixes) for c in registry.components(kind)}
        assert {name for name, (_, verbs) in shown.items() if verb in verbs} == set(declared)
        for name, suffixes in declared.items():
            assert suffixes <= shown[name][0]
    for name, (suffixes, _) in shown.items():
        both = [c.suffixes for kind in ("reader", "writer") for c in registry.components(kind) if c.name == name]
        assert suffixes == {suffix for declared in both for suffix in declared}


def test_every_exporter_is_in_the_table_of_exact_formats(registry):
    rows = table_rows(section(REFERENCE / "formats.md", "Exact formats"))
    shown = [(unquoted(name), tuple(unquoted(suffixes).split()), unquoted(needs)) for name, suffixes, needs, _ in rows]
    declared = [(c.name, c.suffixes, c.extra or "–") for c in registry.components("exporter")]
    assert sorted(shown) == sorted(declared)


def test_every_format_of_elements_is_in_the_table(registry):
    rows = table_rows(section(REFERENCE / "formats.md", "Elements"))
    shown = [(unquoted(name), tuple(unquoted(suffixes).split())) for name, suffixes, _ in rows]
    assert sorted(shown) == sorted((c.name, c.suffixes) for c in registry.components("elements"))


COLUMNS = {"normals": 4, "colors": 5, "face_colors": 6}


@pytest.mark.filterwarnings("ignore:.*left out")
@pytest.mark.parametrize("name", ["off", "obj", "ply", "stl"])
def test_what_the_table_says_of_a_format_is_kept(name, registry, tmp_path):
    row = next(row for row in _formats() if unquoted(row[0]) == name)
    mesh = gate.read(ROOT / "datasets" / ("dodecahedron.off" if row[3] == "polygons" else "sphere.off"), registry)
    grey = np.full((mesh.face_count, 3), 0.2)
    full = replace(mesh, normals=mesh.vertices, colors=np.full_like(mesh.vertices, 0.6), face_colors=grey)
    gate.write(tmp_path / f"full.{name}", full, registry)
    found = gate.read(tmp_path / f"full.{name}", registry)
    assert sorted(found.face_sizes) == sorted(mesh.face_sizes)
    assert {key: "no" if getattr(found, key) is None else "yes" for key in COLUMNS} == {
        key: row[column] for key, column in COLUMNS.items()
    }


@pytest.mark.parametrize("name", ["stl"])
def test_a_format_of_triangles_refuses_polygons(name, registry, tmp_path):
    mesh = gate.read(ROOT / "datasets" / "dodecahedron.off", registry)
    with pytest.raises(FormatError):
        gate.write(tmp_path / f"mesh.{name}", mesh, registry)


def _formats() -> list[list[str]]:
    return table_rows(section(REFERENCE / "formats.md", "Formats"))


def test_every_key_of_the_report_is_in_its_table(registry):
    config = Config.load(overrides=["basis.size=50"])
    report = fit(ROOT / "datasets" / "cube.off", config, registry).report
    keys = [unquoted(row[0]) for row in table_rows((REFERENCE / "report.md").read_text())]
    assert keys == list(_keys(report))


def _keys(value: object, path: str = "") -> list[str]:
    """The paths of all leaves of a report; tables with free names are leaves."""
    if not isinstance(value, dict) or path in {"seconds", "versions"}:
        return [path]
    return [leaf for key, inner in value.items() for leaf in _keys(inner, f"{path}.{key}".lstrip("."))]
