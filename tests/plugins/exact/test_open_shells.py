"""A few faces on surfaces with a boundary: shells that end there, as Open CASCADE reads them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from fitted import REGISTRY
from late import Late, require
from open_shapes import SHAPES
from orbiframe_exact.quad_domain import quad_domain

from orbiframe import FitError, OrbifoldSurface, fit, surface_type, write
from orbiframe.files import gate
from orbiframe.surfaces import SurfaceForms, border_curves
from orbiframe.surfaces.border import nearest_on_border

opened, open_cascade = Late("opened_shapes", needs="OCP.gp"), Late("orbiframe_exact.open_cascade", needs="OCP.gp")


@cache
def surface_of(name: str) -> OrbifoldSurface:
    return fit(SHAPES[name](), size=400, boundary="auto", progress=False).surface


def off_border(surface: OrbifoldSurface, places: np.ndarray) -> float:
    """How far places are from the boundary of the surface at most, in diagonals of a mesh of unit size."""
    return float(nearest_on_border(surface, (places - surface.origin) / surface.scale)[1].max())


@pytest.mark.parametrize(
    "name",
    [
        "square sheet",
        "Möbius band",
        "cylinder",
        pytest.param("mask with three holes", marks=pytest.mark.long),
        pytest.param("torus with a jagged hole", marks=pytest.mark.long),
    ],
)
def test_the_shell_is_valid_and_ends_at_the_boundary(name: str, tmp_path: Path) -> None:
    require("OCP.gp")
    surface, path = surface_of(name), tmp_path / "part.step"
    told = gate.export(path, surface, REGISTRY, options={"exact": False})
    assert told["reached"]
    assert told["valid"]
    shape = opened.read_back(path)
    assert opened.is_shell(shape)
    assert opened.is_valid(shape)
    assert opened.area(shape) == pytest.approx(SurfaceForms.of(surface).area, rel=1e-3)
    assert opened.euler_characteristic(shape) == surface_type(SHAPES[name]()).euler_characteristic
    rim = opened.free_points(shape)
    assert off_border(surface, rim) < 2e-3
    length = sum(curve.length for curve in border_curves(surface)) * surface.scale
    assert opened.free_length(shape) == pytest.approx(length, rel=5e-3)


def test_corners_are_vertices_of_the_shell(tmp_path: Path) -> None:
    path = tmp_path / "sheet.step"
    open_cascade.write_step(path, surface_of("square sheet"), exact=False)
    vertices = opened.vertices(opened.read_back(path))
    mesh = SHAPES["square sheet"]()
    corners = mesh.vertices[[0, 16, 16 * 17, 17 * 17 - 1]]
    assert np.linalg.norm(vertices[:, None] - corners, axis=2).min(axis=0).max() < 1e-3


def test_faces_with_geodesic_sides_alone_miss_the_boundary() -> None:
    """The mutant: quadrilaterals are not filled out to the boundary of a disc."""
    surface = surface_of("bumpy disc")
    domain = quad_domain(surface, 12)
    sides = domain.sides_of_edges()
    free = sides[sides[:, 1] < 0, 0]
    s, t = np.array([[0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5]])[free % 4].T
    for rims, limit in ((domain.points.rim, (0, 2e-3)), ((), (5e-3, 1))):
        places = replace(domain.points, rim=rims).jets(free // 4, s, t, 0)[0]
        assert limit[0] <= float(nearest_on_border(surface, places)[1].max()) < limit[1]


def test_exact_patches_of_an_open_surface_are_refused_and_a_few_faces_named(orbiframe, tmp_path: Path) -> None:
    require("OCP.gp")
    with pytest.raises(FitError, match=r"exact patches do not follow; write a few faces that end there"):
        gate.export(tmp_path / "part.step", surface_of("cylinder"), REGISTRY, options={"exact": True})
    write(tmp_path / "tube.off", SHAPES["cylinder"]())
    ran = orbiframe(
        "fit", tmp_path / "tube.off", "-o", tmp_path / "tube.step", "--boundary", "auto", "--size", 150, "--faces", 12
    )
    assert ran.status == 0
    assert "B-spline faces" in ran.out
    options = ("--boundary", "auto", "--size", 60, "--basis", "ps2", "--exact")
    refused = orbiframe("fit", tmp_path / "tube.off", "-o", tmp_path / "exact.step", *options)
    assert refused.status == 1
    assert "without --exact" in refused.err
