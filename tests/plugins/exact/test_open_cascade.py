"""STEP and IGES: opened again by Open CASCADE, the files hold the surface with its area, closed and outward."""

from __future__ import annotations

import subprocess
import sys
import warnings
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from exact_surfaces import embedded, round_torus, surface_of
from fitted import config, mesh_of
from late import Late, require
from scipy.spatial import cKDTree
from spline_checks import quadrature

from orbiframe import Notice, Registry
from orbiframe.files import gate
from orbiframe.fitting import pipeline
from orbiframe.surfaces import patches_of
from orbiframe.testing import contract_tests

open_cascade, shapes = (Late(f"orbiframe_exact.{name}", needs="OCP.gp") for name in ("open_cascade", "shapes"))
opened = Late("opened_shapes", needs="OCP.gp")


def write_step(path, surface):
    open_cascade.write_step(path, surface)


def write_iges(path, surface):
    open_cascade.write_iges(path, surface)


test_step = contract_tests("exporter", write_step, suffix=".step")
test_iges = contract_tests("exporter", write_iges, suffix=".iges")

CASES = [
    ("tetrahedron", "ps2", {}),
    ("projective plane", "ps2", {}),
    ("torus", "bernstein", {"degree": 3}),
    ("Klein bottle", "ps2", {}),
    ("double torus", "ps2", {}),
    ("double torus", "ps3", {}),
    ("Klein bottle", "ps6", {}),
    ("torus", "tensor-bspline", {"degree": 3, "counts": (7, 6)}),
    ("torus", "tensor-bspline", {"degree": 2, "knots_u": (0.1, 0.1, 0.4, 0.7, 0.8), "knots_v": (0.2, 0.4, 0.6, 0.8)}),
    ("Klein bottle", "tensor-bspline", {"degree": 3, "counts": (6, 6)}),
]
each_case = pytest.mark.parametrize(("name", "family", "options"), CASES, ids=[f"{n} {f}" for n, f, _ in CASES])
each_format = pytest.mark.parametrize("suffix", [".step", ".iges"])


@each_case
@each_format
def test_an_opened_file_is_the_surface(name, family, options, suffix, tmp_path):
    """The same area, closed as it should be, and on every patch a point of the surface in space."""
    surface = surface_of(name, family, **{"size": 30, **options})
    surface = round_torus(surface) if name == "torus" else surface
    patches = patches_of(surface)
    made, shape = shapes.shape_of(patches), opened.reopened(surface, tmp_path / f"surface{suffix}")
    assert opened.is_valid(shape)
    assert opened.area(shape) == pytest.approx(opened.area(made), rel=1e-9)
    if surface.orbifold.orientable:
        assert opened.is_solid(shape)
        assert opened.volume(shape) == pytest.approx(patches.quadrilaterals().volume, rel=0.1)
        assert opened.volume(shape) > 0
    else:
        assert opened.is_shell(shape)
        assert shape.Closed() == (family != "tensor-bspline")
    found, wanted = opened.middles(shape, patches), opened.own_middles(patches.quadrilaterals())
    assert len(found) == len(wanted)
    distance, place = cKDTree(wanted).query(found)
    assert distance.max() < 1e-10
    assert len(np.unique(place)) == len(wanted)


def test_a_round_sphere_has_the_area_of_a_sphere(tmp_path):
    """That of the spline by its own derivatives, without patches; near to that of the sphere."""
    surface = surface_of("tetrahedron", "ps4", size=120)
    ball = embedded(surface, lambda points: 2 * points.x)
    found = opened.area(opened.reopened(ball, tmp_path / "ball.step"))
    points, weights = quadrature(ball.basis, 24)
    assert found == pytest.approx(weights @ ball.curvature(points).element, rel=1e-9)
    assert found == pytest.approx(16 * np.pi, rel=2e-4)


@cache
def genus(number: int):
    """A fit of a dataset of higher genus."""
    registry = Registry.discover()
    return pipeline.fit(mesh_of(f"plate_genus{number}.off"), config(60, "basis.name=ps2"), registry).surface


@pytest.mark.parametrize("number", [2, 5])
def test_plates_open_as_solids_of_the_same_area(number, tmp_path):
    surface = genus(number)
    shape = opened.reopened(surface, tmp_path / "plate.step")
    assert opened.is_solid(shape)
    assert opened.area(shape) == pytest.approx(opened.area(shapes.shape_of(patches_of(surface))), rel=1e-9)
    assert opened.volume(shape) > 0


@each_format
def test_metres_are_converted_to_millimetres_and_said(suffix, tmp_path):
    """The area in square millimetres, as Open CASCADE reads it: a million times that of the numbers in metres."""
    surface = surface_of("torus", "tensor-bspline", counts=(4, 4))
    areas = {}
    for unit in (None, "millimetre", "metre"):
        coarse = replace(surface.refinement.coarse, unit=unit)
        measured = replace(surface, refinement=replace(surface.refinement, coarse=coarse))
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            areas[unit] = opened.area(opened.reopened(measured, tmp_path / f"{unit}{suffix}"))
        assert [w.category for w in said] == ([Notice] if unit == "metre" else [])
    assert areas[None] == areas["millimetre"]
    assert areas["metre"] == pytest.approx(1e6 * areas["millimetre"], rel=1e-6)


@each_format
def test_files_name_the_program_and_nothing_of_the_place(suffix, tmp_path):
    path = tmp_path / f"shape{suffix}"
    opened.WRITERS[suffix](path, surface_of("torus", "tensor-bspline", counts=(4, 4)))
    text = path.read_text("ascii").replace("\n", "")
    assert "orbiframe" in text
    assert "1970" in text
    assert tmp_path.name not in text
    assert "shape." not in text


def test_a_missing_library_names_the_command(tmp_path):
    """In a process where Open CASCADE cannot be imported."""
    code = """
import sys
class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] == "OCP":
            raise ModuleNotFoundError(f"No module named '{name}'", name=name)
sys.meta_path.insert(0, Absent())
from orbiframe.cli.main import main
sys.exit(main(["fit", "datasets/torus.off", "-o", sys.argv[1], "--basis", "ps2"]))
"""
    folder = mesh_of("torus.off").parents[1]
    run = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "a.step")], cwd=folder, capture_output=True, text=True, check=False
    )
    assert run.returncode == 1
    assert 'pip install "orbiframe[cad]"' in run.stderr
    assert not list(tmp_path.iterdir())


def test_an_exporter_is_found_by_its_suffix(tmp_path):
    require("OCP.gp")
    registry = Registry.discover()
    surface = surface_of("torus", "tensor-bspline", counts=(4, 4))
    for name in ("a.stp", "a.STEP", "a.igs"):
        gate.export(tmp_path / name, surface, registry)
        assert (tmp_path / name).stat().st_size > 1000
    assert not gate.exports(tmp_path / "a.ply", registry)
