"""Fits whose output is the surface itself."""

from __future__ import annotations

import json

import numpy as np
import pytest
from fitted import REGISTRY

from orbiframe.files.gate import write
from orbiframe.meshes.unions import disjoint_union
from orbiframe.testing.polyhedra import reference_polyhedra


@pytest.fixture
def _no_fit(monkeypatch):
    def refuse(*_):
        raise AssertionError("a fit was begun")

    monkeypatch.setattr("orbiframe.fitting.pipeline.fit", refuse)


@pytest.mark.parametrize("suffix", [".vtu", ".step", ".igs"])
def test_the_surface_itself_is_written(orbiframe, cube, tmp_path, suffix):
    if suffix != ".vtu":
        pytest.importorskip("OCP", reason='Open CASCADE is the extra "orbiframe[cad]"')
    path = tmp_path / f"shape{suffix}"
    ran = orbiframe("fit", cube, "-o", path, "--basis", "ps2", "--size", 40, "--exact")
    assert (ran.status, ran.err) == (0, "")
    assert "exact rational patches" in ran.out
    assert path.stat().st_size > 10_000
    assert list(tmp_path.glob("shape*")) == [path]


def test_the_seconds_of_the_export_are_reported(orbiframe, cube, tmp_path):
    arguments = ("fit", cube, "-o", tmp_path / "a.vtu", "--basis", "ps2", "--size", 40, "--json")
    assert json.loads(orbiframe(*arguments).out)["seconds"]["export"] >= 0


def test_bumps_become_a_mesh_where_the_format_has_one(orbiframe, cube, tmp_path):
    ran = orbiframe("fit", cube, "-o", tmp_path / "a.vtu", "--basis", "gaussian", "--size", 40, "--refine", 2)
    assert ran.status == 0
    assert "vertices" in ran.out.splitlines()[-2]


@pytest.mark.usefixtures("_no_fit")
def test_bumps_have_no_exact_form(orbiframe, cube, tmp_path):
    """It is said before the fit, with what to do."""
    pytest.importorskip("OCP", reason='Open CASCADE is the extra "orbiframe[cad]"')
    ran = orbiframe("fit", cube, "-o", tmp_path / "a.step", "--basis", "gaussian", "--exact")
    assert ran.status == 1
    assert "--basis ps2" in ran.err
    assert not (tmp_path / "a.step").exists()


def test_several_parts_are_no_exact_surface(orbiframe, tmp_path):
    both = disjoint_union([reference_polyhedra()["cube"], moved(reference_polyhedra()["cube"])])
    write(tmp_path / "two.off", both, REGISTRY)
    ran = orbiframe("fit", tmp_path / "two.off", "-o", tmp_path / "a.vtu", "--basis", "ps2", "--size", 40)
    assert ran.status == 2
    assert "2 components" in ran.err
    assert "--component" in ran.err
    assert not (tmp_path / "a.vtu").exists()
    wanted = ("--component", 2, "--basis", "ps2", "--size", 40)
    assert orbiframe("fit", tmp_path / "two.off", "-o", tmp_path / "a.vtu", *wanted).status == 0


def moved(mesh):
    return mesh.with_vertices(mesh.vertices + np.array([5.0, 0, 0]))
