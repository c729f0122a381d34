"""Open meshes: surfaces that end where the mesh ends, near it inside and on the boundary, and what follows knows it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from fitted import DATASETS, REGISTRY
from open_shapes import SHAPES, cylinder, square_sheet

from orbiframe import Config, fit, load_surface
from orbiframe.errors import ConfigError, FitError, FormatError, TopologyError
from orbiframe.files import gate, surface_file
from orbiframe.fitting import accuracy
from orbiframe.fitting.parts import fit_parts
from orbiframe.fitting.pipeline import Result
from orbiframe.meshes.loops import boundary_loops
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.repair import split_nonmanifold_vertices
from orbiframe.meshes.sizes import area
from orbiframe.meshes.surface_type import surface_type
from orbiframe.meshes.unions import disjoint_union
from orbiframe.surfaces import (
    HarmonicForms,
    Hodge,
    curved_mesh,
    fit_field,
    input_faces,
    texture_coordinates,
    texture_distortion,
)
from orbiframe.surfaces.border import inside
from orbiframe.triangulations import unrolled

HOLES = Path(__file__).parents[3] / "shared" / "meshes" / "polygon_mesh.off"


@cache
def of(name: str, how: str = "auto", data: str = "facets", size: int = 500) -> Result:
    return fit(SHAPES[name](), size=size, boundary=how, data=data, progress=False)


@pytest.mark.long
@pytest.mark.parametrize("size", [400, 800])
@pytest.mark.parametrize("name", SHAPES)
def test_it_is_near_inside_and_on_the_boundary_and_does_not_fold_there(name: str, size: int) -> None:
    report = of(name, size=size).report
    assert report["fit"]["rms"] <= 6e-4
    assert report["boundary"]["rms"] <= 7e-4
    assert report["boundary"]["least_element"] >= 0.75
    assert report["shape"]["folded_share"] == 0
    assert report["map"]["not_positive"] == 0


@pytest.mark.parametrize(("name", "how"), [("square sheet", "auto"), ("Möbius band", "collar"), ("cylinder", "cap")])
def test_gauss_and_bonnet_hold_with_the_turning_of_the_boundary(name: str, how: str) -> None:
    surface = of(name, how).surface
    chi = surface_type(SHAPES[name]()).euler_characteristic
    assert surface.total_curvature() + surface.boundary_turning() == pytest.approx(2 * np.pi * chi, abs=2e-3)


def test_the_turning_of_a_flat_square_lies_in_its_corners() -> None:
    flat = square_sheet(8)
    flat = flat.with_vertices(flat.vertices * [1, 1, 0])
    surface = fit(flat, size=300, boundary="collar", progress=False).surface
    assert surface.boundary_turning() == pytest.approx(2 * np.pi, abs=1e-4)
    assert surface.total_curvature() == pytest.approx(0, abs=1e-6)


def test_the_rim_of_a_cylinder_is_a_geodesic_and_that_of_a_cap_is_not() -> None:
    tube = of("cylinder", "double", "smooth").surface
    assert tube.boundary_turning() == pytest.approx(0, abs=5e-3)
    # A cap of the unit sphere up to the angle a from its pole: area 2 pi (1 - cos a), turning 2 pi cos a.
    disc = SHAPES["bumpy disc"]()
    theta = np.hypot(*disc.vertices.T[:2])[:, None]
    way = disc.vertices * [1, 1, 0] / np.maximum(theta, 1e-300)
    cap = disc.with_vertices(np.sin(theta) * way + np.cos(theta) * np.array([0, 0, 1.0]))
    surface = fit(cap, size=400, boundary="auto", data="smooth", progress=False).surface
    assert surface.total_curvature() == pytest.approx(2 * np.pi * (1 - np.cos(1)), rel=0.04)
    assert surface.boundary_turning() == pytest.approx(2 * np.pi * np.cos(1), rel=0.04)


@pytest.mark.parametrize("name", ["square sheet", "Möbius band"])
def test_the_output_is_the_open_surface_alone(name: str) -> None:
    mesh, found = SHAPES[name](), of(name)
    for output in (found.output, found.surface.tessellate(2), found.surface.tessellate(1, bisected=True)):
        assert surface_type(output) == surface_type(mesh)
        assert len(boundary_loops(output)) == len(boundary_loops(mesh))
        assert area(output) == pytest.approx(area(mesh), rel=1e-2)
        assert output.normals is not None
        assert len(output.normals) == len(output.vertices)
    plain = found.surface.tessellate(1)
    assert np.abs(plain.vertices[: len(mesh.vertices)] - mesh.vertices).max() < 5e-3 * mesh.diagonal


def test_corners_stay_corners() -> None:
    mesh = square_sheet()
    corners = np.flatnonzero(np.bincount(mesh.tail) == 1)
    there = of("square sheet").surface.tessellate(1).vertices[corners]
    assert np.linalg.norm(there - mesh.vertices[corners], axis=1).max() < 1e-3 * mesh.diagonal


def test_a_cap_folds_at_the_corners_of_a_sheet_which_the_report_tells() -> None:
    assert of("square sheet", "cap").report["boundary"]["least_element"] < 0.3
    assert of("square sheet", "collar").report["boundary"]["least_element"] > 0.9


def test_a_saved_surface_knows_its_boundary(tmp_path) -> None:
    surface = of("Möbius band").surface
    surface_file.save_surface(surface, tmp_path / "band.npz")
    again = load_surface(tmp_path / "band.npz", REGISTRY)
    assert np.array_equal(again.triangulation.inside, surface.triangulation.inside)
    assert np.array_equal(again.tessellate(1).vertices, surface.tessellate(1).vertices)
    assert again.boundary_turning() == surface.boundary_turning()


@pytest.mark.parametrize("change", [lambda a: a[:-1], np.zeros_like, lambda a: a ^ (np.arange(len(a)) == 0)])
def test_a_file_with_another_boundary_is_refused(tmp_path, change) -> None:
    surface = of("Möbius band").surface
    path = tmp_path / "band.npz"
    surface_file.save_surface(surface, path)
    with np.load(path) as file:
        arrays = dict(file)
    arrays["inside"] = change(arrays["inside"])
    np.savez(path, **arrays)
    with pytest.raises(FormatError, match="inside"):
        load_surface(path, REGISTRY)


def test_nearest_points_stay_on_the_surface() -> None:
    surface = of("square sheet").surface
    targets = np.array([[1.3, 0.5, 0.0], [-0.2, -0.3, 0.1], [0.5, 0.5, 0.3]])
    points, distance = surface.nearest(targets)
    fine = surface.tessellate(24).vertices
    brute = np.linalg.norm(fine[None] - targets[:, None], axis=2).min(axis=1)
    assert distance == pytest.approx(brute, rel=1e-3)
    assert (distance <= brute + 1e-9).all()
    assert np.linalg.norm(surface.evaluate(points) - targets, axis=1) == pytest.approx(distance, rel=1e-9)
    triangulation = surface.triangulation
    middle = np.full((triangulation.polyhedron.face_count, 3), 1 / 3)
    seen = inside(surface, triangulation.locate(np.arange(len(middle)), middle))
    assert np.array_equal(seen, triangulation.inside)


def test_curved_elements_cover_the_mesh_alone() -> None:
    surface = of("cylinder").surface
    faces = input_faces(surface)
    assert faces.of_input
    made = curved_mesh(surface, faces, 2)
    corners = Polyhedron.from_faces(made.nodes, made.corners)
    assert area(corners) == pytest.approx(area(cylinder()), rel=1e-2)
    assert surface_type(Polyhedron.from_faces(made.nodes, made.corners)).euler_characteristic == 0


def test_fields_are_fitted_on_the_surface() -> None:
    surface = of("square sheet").surface
    mesh = square_sheet()
    values = np.sin(3 * mesh.vertices[:, 0]) + mesh.vertices[:, 1]
    field = fit_field(surface, mesh.vertices, values)
    assert field.evaluate(field.points).ravel() == pytest.approx(values, abs=1e-3)


def test_what_needs_a_closed_surface_says_so(tmp_path) -> None:
    surface = of("cylinder").surface
    with pytest.raises(FitError, match=r"has a boundary.*exact patches do not follow; write a few faces"):
        gate.export(tmp_path / "tube.vtu", surface, REGISTRY)
    for refused in (lambda: Hodge.of(surface), lambda: HarmonicForms.on_surface(surface)):
        with pytest.raises(FitError, match=r"has a boundary.*holes closed by faces, or ask for fields"):
            refused()


def test_auto_doubles_annuli_and_bands_and_gives_the_others_a_collar() -> None:
    found = {name: of(name).report["boundary"]["closed_by"] for name in ("square sheet", "cylinder", "Möbius band")}
    assert found == {"square sheet": "collar", "cylinder": "double", "Möbius band": "double"}


def test_an_open_mesh_is_refused_unless_asked_for() -> None:
    with pytest.raises(TopologyError, match=r"64 open edges.*try again with --boundary auto"):
        fit(cylinder(), size=100, progress=False)
    with pytest.raises(ConfigError, match=r"mesh.boundary = 'lid': input should be 'error', 'cap', 'collar'"):
        Config.load(overrides=["mesh.boundary=lid"], registry=REGISTRY)
    with pytest.raises(ConfigError, match=r"no option 'boundry'; allowed: .*boundary.* Did you mean 'boundary'"):
        Config.load(overrides=["mesh.boundry=auto"], registry=REGISTRY)
    with pytest.raises(ConfigError, match=r"creases .* are kept on closed meshes only so far"):
        fit(cylinder(), boundary="auto", data={"creases": 30}, basis="ps2", progress=False)


@pytest.mark.parametrize("name", SHAPES)
def test_textures_are_laid_out_without_a_fold(name: str) -> None:
    """Parts of the sphere need no cut; a band is cut across once, which is a part of its length."""
    surface = of(name).surface
    mesh = replace(surface.tessellate(bisected=True), corner_uv=texture_coordinates(surface, bisected=True))
    found = texture_distortion(mesh)
    assert found.folded == 0
    assert np.median(found.angle) < 1.5
    assert (mesh.corner_uv.min(), mesh.corner_uv.max()) == pytest.approx((0, 1), abs=1e-12)
    whole_sphere = surface.orbifold.euler_characteristic == 2
    assert (found.cut == 0) == whole_sphere
    assert found.cut < 0.05 * mesh.edge_count
    map = surface.triangulation
    joined, face = unrolled(map).joined, map.polyhedron.face
    assert map.inside[face[joined]].all()
    assert map.inside[face[map.polyhedron.twin[joined]]].all()


def test_a_boundary_that_goes_far_away_is_an_error(monkeypatch) -> None:
    """More functions than the mesh determines beside holes: what is seen inside is sound, and the boundary is not."""
    found = of("bumpy disc")
    assert accuracy.accuracy_of(found.surface).border is not None
    border = accuracy.border_of(found.surface)._replace(surface_to_mesh=(3.0, 70.0))
    monkeypatch.setattr(accuracy, "border_of", lambda _: border)
    with pytest.raises(FitError, match=r"goes 70 diagonals away .* take fewer, such as --size 62, or fill"):
        accuracy.accuracy_of(found.surface)


@pytest.mark.long
@pytest.mark.skipif(not HOLES.exists(), reason="the folder shared with meshes to try things on is not here")
def test_few_functions_follow_small_holes() -> None:
    mesh = split_nonmanifold_vertices(gate.read(HOLES, REGISTRY)).polyhedron
    found = fit(mesh, size=353, boundary="auto", progress=False)
    assert found.report["boundary"]["rms"] < 2e-3


def test_a_closed_mesh_takes_no_notice() -> None:
    plain, asked = (
        fit(DATASETS / "cube.off", size=100, fast=True, progress=False, **settings)
        for settings in ({}, {"boundary": "auto"})
    )
    assert np.array_equal(plain.output.vertices, asked.output.vertices)
    assert asked.report["boundary"] is None


def test_a_single_triangle_becomes_a_flat_one() -> None:
    triangle = Polyhedron.from_faces(np.eye(3), [[0, 1, 2]])
    found = fit(triangle, size=400, boundary="auto", progress=False)
    assert found.report["data"]["reason"] == "it is flat"
    assert found.report["boundary"]["rms"] < 1e-3
    assert np.abs(found.output.vertices.sum(axis=1) - 1).max() < 1e-6


def test_several_open_and_closed_parts_are_fitted_each() -> None:
    tube = cylinder(16, 6)
    moved = square_sheet(6)
    moved = moved.with_vertices(moved.vertices + np.array([5.0, 0, 0]))
    found = fit_parts(disjoint_union([tube, moved]), size=400, boundary="auto", fast=True, progress=False)
    assert [part["surface"]["euler_characteristic"] for part in found.report["parts"]] == [0, 1]
    assert surface_type(found.output).components == 2
