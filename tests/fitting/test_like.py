"""Maps that are taken over: the same where only vertices move, near where the mesh is cut finer, refused where not."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from open_shapes import cylinder

from orbiframe import Config, ConfigError, MapError, Polyhedron, Registry, UsageError, fit, read, save_surface
from orbiframe.fitting import fit_parts
from orbiframe.fitting.approximation import Approximations
from orbiframe.fitting.mapping import Mapped, Mapping
from orbiframe.fitting.pipeline import _normalised
from orbiframe.fitting.same_triangles import cut_like, glued_alike
from orbiframe.fitting.stages import Stages
from orbiframe.meshes import refine, triangulated
from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.meshes.surface_type import surface_type
from orbiframe.meshes.unions import disjoint_union

DATASETS = Path(__file__).parents[2] / "datasets"
REGISTRY = Registry.discover()
NAMES = ["plate_genus2", "torus", "projective_plane", "klein_bottle"]


def mesh_of(name: str) -> Polyhedron:
    return read(DATASETS / f"{name}.off", REGISTRY)


def fitted(mesh, **settings):
    return fit(mesh, registry=REGISTRY, progress=False, refine=1, **{"size": 80} | settings)


def bent(mesh: Polyhedron, amount: float = 0.4) -> Polyhedron:
    """A mesh twisted about the first axis and moved elsewhere."""
    x = (mesh.vertices - mesh.vertices.mean(axis=0)) / mesh.diagonal
    turn = amount * np.pi * x[:, 0]
    y = np.cos(turn) * x[:, 1] - np.sin(turn) * x[:, 2]
    z = np.sin(turn) * x[:, 1] + np.cos(turn) * x[:, 2]
    return mesh.with_vertices(7 * np.stack([x[:, 0], y, z], axis=1) + [3, 1, 2])


@pytest.mark.parametrize("name", NAMES)
def test_a_deformed_mesh_is_fitted_as_with_that_very_map(name):
    """Against the pipeline with the map put in by hand, on the refinement of the moved triangles."""
    mesh = mesh_of(name)
    old = fitted(mesh).surface
    moved = bent(mesh)
    found = fitted(moved, like=old, data={"lift": False})
    assert found.report["map"]["like"] == {
        "file": "the surface",
        "same_triangles": True,
        "distance": None,
        "angle_distortion_before": found.report["map"]["like"]["angle_distortion_before"],
    }
    flat = found.surface.triangulation
    assert flat.points is old.triangulation.points
    assert flat.orbifold is old.orbifold
    # By hand: the fine vertices on the moved triangles, by their coordinates in them.
    unit, _, _ = _normalised(moved if moved.is_triangular else found.input)
    triangles = triangulated(unit)
    face, barycentric = old.refinement.origins()
    fine = np.einsum("nc,nci->ni", barycentric, triangles.vertices[triangles.triangles[face]])
    assert np.abs(fine - found.surface.refinement.polyhedron.vertices).max() < 1e-14
    # These are the same but for rounding, which badly conditioned equations would multiply: from here on to the bit.
    by_hand = replace(old.triangulation, polyhedron=found.surface.refinement.polyhedron)
    config = Config.load(None, {"basis.size": 80, "data.lift": False}, REGISTRY)
    stages = Stages(REGISTRY, lambda *_: None)
    refinement = replace(found.surface.refinement, polyhedron=by_hand.polyhedron)

    class Given(Mapping):
        def for_size(self, size):
            return Mapped(refinement, by_hand, by_hand)

    given = Given(unit, triangles, surface_type(unit), config, stages)
    wanted = Approximations(given, config, stages).of_size(80).surface
    points = old.vertex_points
    apart = wanted.evaluate(points) * found.surface.scale + found.surface.origin - found.surface.evaluate(points)
    assert np.abs(apart).max() <= 1e-12 * found.surface.scale


def test_the_same_mesh_gives_the_same_surface_to_the_bit():
    mesh = mesh_of("plate_genus2")
    old = fitted(mesh)
    again = fitted(mesh, like=old.surface)
    assert np.array_equal(again.surface.coefficients, old.surface.coefficients)
    assert again.report["fit"] == old.report["fit"]


@pytest.mark.parametrize("name", ["plate_genus2", "sphere", "three_crosscaps"])
def test_a_mesh_that_is_cut_finer_lies_where_the_old_one_lay(name):
    """The images in X/H: the new map at a vertex is the old map at the point of the old mesh where the vertex is."""
    old = fitted(mesh_of(name)).surface
    coarse = old.refinement.coarse
    finer = refine(coarse, 2).polyhedron
    finer = finer.with_vertices(old.origin + old.scale * finer.vertices)
    found = fitted(finer, like=old)
    told = found.report["map"]["like"]
    assert not told["same_triangles"]
    assert told["distance"] < 1e-12
    assert found.report["map"]["not_positive"] == 0
    assert found.report["map"]["area_defect"] < 1e-12
    # Points of the finer mesh and of the old one that are the same point in space are the same point of X/H.
    new = found.surface
    own = new.triangulation
    flat = new.refinement.polyhedron.vertices
    place, barycentric = NearestPoints(old.refinement.polyhedron).places(flat)
    there = old.triangulation.locate(place, barycentric)
    values = old.basis.values(there, old.coefficients)
    from orbiframe import Points

    # The functions of the old surface are functions on the same X/H, up to the names of patches.
    used = np.unique(there.patch)
    here = Points(used[own.patch], own.points)
    assert np.abs(old.basis.values(here, old.coefficients) - values).max() < 1e-9
    # And the fit is as near as with a map of its own.
    assert found.report["fit"]["rms"] < 1.2 * fitted(finer).report["fit"]["rms"] + 1e-5


def test_more_functions_than_the_old_map_is_fine_for_refine_it():
    mesh = mesh_of("plate_genus2_coarse")
    old = fitted(mesh).surface
    found = fitted(mesh, like=old, size=1500, fast=True)
    assert not found.report["map"]["like"]["same_triangles"]
    assert found.report["map"]["like"]["distance"] is None
    assert len(found.surface.triangulation.points) >= 6000
    assert found.report["fit"]["rms"] < 1.1 * fitted(mesh, size=1500, fast=True).report["fit"]["rms"]


def test_it_is_said_when_a_map_hardly_serves_or_serves_no_more():
    mesh = mesh_of("torus")
    old = fitted(mesh, fast=True).surface
    stretched = mesh.with_vertices(mesh.vertices * [1, 1, 6])
    (note,) = [each for each in fitted(stretched, like=old, fast=True).report["notes"] if "stretches" in each]
    assert "leave out --like" in note
    for wrong, words in (
        (
            mesh.with_vertices(mesh.vertices * [1, 1, 30]),
            r"distorted by a ratio of [0-9.]+ or more on 5 % of the area, 20",
        ),
        (mesh_of("plate_genus2"), r"Euler characteristic 0 \(closed, orientable, genus 1.*has Euler characteristic -2"),
        (
            bent(refine(triangulated(mesh), 2).polyhedron),
            r"a vertex is [0-9.]+ of the diagonal away from it, at most 0.05",
        ),
    ):
        with pytest.raises(MapError, match=words) as caught:
            fitted(wrong, like=old, fast=True)
        assert "does not serve this mesh" in str(caught.value)
        assert "leave out --like (map.like)" in str(caught.value)


def test_a_mesh_beside_two_sheets_that_folds_is_refused():
    """A thin plate cut anew with noise larger than its thickness: vertices come down on the other side."""
    mesh = mesh_of("plate_genus2_coarse")
    thin = mesh.with_vertices(mesh.vertices * [1, 1, 0.02])
    old = fitted(thin, fast=True).surface
    finer = refine(old.refinement.coarse, 2).polyhedron
    noise = 0.01 * np.random.default_rng(0).standard_normal(finer.vertices.shape)
    noisy = finer.with_vertices(old.origin + old.scale * (finer.vertices + noise))
    with pytest.raises(MapError, match=r"fold over in X/H|do not cover X/H once|no short way"):
        fitted(noisy, like=old, fast=True)


def test_a_mesh_with_a_boundary_takes_the_map_of_its_own_triangles():
    mesh = cylinder()
    old = fitted(mesh, boundary="auto", fast=True)
    again = fitted(mesh, boundary="auto", fast=True, like=old.surface)
    assert np.abs(again.surface.coefficients - old.surface.coefficients).max() < 1e-6
    found = fitted(bent(mesh, 0.2), boundary="auto", fast=True, like=old.surface)
    assert found.surface.triangulation.points is old.surface.triangulation.points
    assert found.report["boundary"]["rms"] < 0.01
    with pytest.raises(MapError, match="a mesh with a boundary needs the"):
        fitted(refine(triangulated(mesh), 2).polyhedron, boundary="auto", fast=True, like=old.surface)


def test_polygons_are_cut_as_they_were(tmp_path):
    """A quadrilateral that would be cut along its other diagonal once a corner has moved."""
    mesh = mesh_of("plate_genus2_coarse")
    old = fitted(mesh, fast=True).surface
    vertices = mesh.vertices.copy()
    vertices[3] += [0.3, 0.2, 0.1]
    moved = mesh.with_vertices(vertices)
    own, given = triangulated(moved), old.refinement.coarse
    assert not glued_alike(own, given)
    found = cut_like(moved, given)
    assert glued_alike(found, given)
    assert np.array_equal(found.vertices, vertices)
    assert fitted(moved, like=old, fast=True).report["map"]["like"]["same_triangles"]
    # What is no cut of these faces stays as it is.
    assert cut_like(moved, triangulated(mesh_of("plate_genus2"))) is moved
    turned = replace(given, tail=given.tail[::-1].copy())
    assert cut_like(moved, turned) is moved


def test_the_file_is_named_on_the_command_line_and_in_configurations(orbiframe, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mesh = DATASETS / "torus.off"
    options = ("--size", "60", "--fast", "--refine", "1")
    assert orbiframe("fit", mesh, "-o", "a.ply", "--save", "a.npz", *options).status == 0
    ran = orbiframe("fit", mesh, "-o", "b.ply", "--like", "a.npz", "--json", *options)
    assert ran.status == 0, ran.err
    assert json.loads(ran.out)["map"]["like"]["file"] == "a.npz"
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "fit.toml").write_text('[map]\nlike = "../a.npz"\n')
    config = Config.load(tmp_path / "folder" / "fit.toml")
    assert config.like is not None
    assert config.like.resolve() == tmp_path / "a.npz"
    ran = orbiframe("fit", mesh, "-o", "c.ply", "--config", "folder/fit.toml", "--json", *options)
    assert json.loads(ran.out)["map"]["like"]["file"] == "a.npz"
    assert orbiframe("fit", mesh, "-o", "a.npz.ply", "--save", "a.npz", "--like", "a.npz", *options).status == 2
    ran = orbiframe("fit", mesh, "-o", "d.ply", "--like", "absent.npz")
    assert ran.status == 1
    assert "absent.npz" in ran.err
    ran = orbiframe("fit", mesh, "-o", "d.ply", "--like", "a.npz", "--map", "equivariant")
    assert ran.status == 2
    assert "is taken over (map.like), so that [map] has no say" in ran.err


def test_a_map_of_one_surface_is_none_of_two(tmp_path):
    mesh = mesh_of("torus")
    old = fitted(mesh, fast=True).surface
    save_surface(old, tmp_path / "old.npz")
    two = disjoint_union([mesh, mesh.with_vertices(mesh.vertices + 10)])
    for settings in ({"like": old}, {"like": tmp_path / "old.npz"}, {"output": {"moved": [[0, 0.1, 0.0, 0.0]]}}):
        with pytest.raises(UsageError, match="the mesh has 2 components"):
            fit_parts(two, registry=REGISTRY, progress=False, size=60, **settings)


def test_coefficients_are_moved_by_hand():
    mesh = mesh_of("torus")
    plain = fitted(mesh, fast=True).surface
    moved = fitted(mesh, fast=True, output={"moved": [[3, 0.5, 0, -0.25]]}).surface
    way = (moved.coefficients - plain.coefficients) * plain.scale
    assert np.allclose(way[3], [0.5, 0, -0.25], atol=1e-12)
    assert np.abs(np.delete(way, 3, axis=0)).max() == 0
    with pytest.raises(ConfigError, match="function 99 is moved, and there are 80"):
        fitted(mesh, fast=True, output={"moved": [[99, 0, 0, 0]]})
    with pytest.raises(ConfigError, match="moved"):
        Config.load(overrides={"output.moved": [[-1, 0, 0, 0]]})


def test_nearest_places_are_the_nearest_points():
    """Against the distances, and with the points put back from their coordinates."""
    mesh = triangulated(mesh_of("plate_genus2_coarse"))
    nearest = NearestPoints(mesh)
    points = np.random.default_rng(1).uniform(mesh.vertices.min(axis=0) - 1, mesh.vertices.max(axis=0) + 1, (500, 3))
    face, barycentric = nearest.places(points)
    assert barycentric.min() >= 0
    assert np.abs(barycentric.sum(axis=1) - 1).max() < 1e-12
    there = np.einsum("nc,nci->ni", barycentric, mesh.vertices[mesh.triangles[face]])
    assert np.abs(np.linalg.norm(there - points, axis=1) - nearest.distance(points)).max() < 1e-9
