"""The plane X is the one that the configuration names, if it has the curvature of the surface."""

from __future__ import annotations

import sys

import pytest

from orbiframe import Config, ConfigError, MapError, Registry, fit, load_surface, save_surface
from orbiframe.testing.polyhedra import reference_polyhedra

PLUGIN = """
from orbiframe import Registry
from orbiframe.plugin import Component, hookimpl

E2 = Registry.discover().load("geometry", "e2")


class Drawn(E2):
    "The Euclidean plane under another name."

    name = "drawn"


@hookimpl
def orbiframe_components():
    return [Component("geometry", "drawn", "drawn_plane:Drawn", "the Euclidean plane under another name")]
"""
TORUS = reference_polyhedra()["torus"]
FEW = {"size": 40, "fast": True, "refine": 1}


@pytest.fixture
def registry(tmp_path):
    (tmp_path / "drawn_plane.py").write_text(PLUGIN)
    yield Registry.discover(files=[tmp_path / "drawn_plane.py"])
    sys.modules.pop("drawn_plane", None)


def test_a_geometry_of_a_plugin_is_chosen_and_saved_by_its_name(registry, tmp_path):
    result = fit(TORUS, registry=registry, geometry="drawn", **FEW)
    assert result.report["geometry"] == "drawn"
    save_surface(result.surface, tmp_path / "torus.npz")
    assert load_surface(tmp_path / "torus.npz", registry).orbifold.geometry.name == "drawn"


def test_it_is_taken_where_nothing_is_said():
    assert fit(TORUS, **FEW).report["geometry"] == "e2"


def test_another_curvature_is_refused():
    with pytest.raises(MapError, match="characteristic 0 is made of e2, and 'h2' has the curvature -1"):
        fit(TORUS, geometry="h2", **FEW)


def test_an_unknown_geometry_is_refused_with_those_that_there_are():
    with pytest.raises(ConfigError, match=r"no geometry named 'h3'; installed: e2, h2, s2"):
        fit(TORUS, Config.from_tables({"geometry": {"name": "h3"}}), **FEW)
