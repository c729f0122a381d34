"""orbiframe remesh."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from orbiframe import Registry, read, write
from orbiframe.cli.main import parsed
from orbiframe.meshes import disjoint_union, require_closed_surface

DATASETS = Path(__file__).parents[3] / "datasets"
PLATE = DATASETS / "plate_genus2_coarse.off"
CUBE = DATASETS / "cube.off"


def test_a_mesh_becomes_even_triangles_and_says_how_even(orbiframe, tmp_path):
    out = tmp_path / "plate.ply"
    ran = orbiframe("remesh", PLATE, "-o", out, "--vertices", 400, "--size", 80, "--json")
    assert (ran.status, ran.err) == (0, "")
    found = json.loads(ran.out)
    mesh = read(out, Registry.discover())
    assert (found["vertices"], found["faces"]) == (len(mesh.vertices), mesh.face_count) == (400, 804)
    assert require_closed_surface(mesh).euler_characteristic == -2
    assert found["angles"]["least"] > 25
    assert mesh.normals is not None


def test_a_saved_surface_is_meshed_without_a_fit(orbiframe, tmp_path):
    saved = tmp_path / "cube.npz"
    orbiframe("fit", CUBE, "-o", tmp_path / "cube.ply", "--save", saved, "--size", 60, "--refine", 1, "--quiet")
    for name in ("one.obj", "two.obj"):
        ran = orbiframe("remesh", saved, "-o", tmp_path / name, "--edge-length", 0.1, "--quads")
        assert ran.status == 0
        assert "quadrilaterals" in ran.out
        assert "3 to 5" in ran.out
    assert (tmp_path / "one.obj").read_bytes() == (tmp_path / "two.obj").read_bytes()
    ran = orbiframe("remesh", saved, "-o", tmp_path / "one.obj", "--vertices", 50, "--size", 60)
    assert ran.status == 2
    assert "finished surface" in ran.err


@pytest.mark.long
def test_every_component_has_its_share_of_the_vertices(orbiframe, tmp_path):
    registry = Registry.discover()
    cube = read(CUBE, registry)
    write(tmp_path / "two.off", disjoint_union([cube, cube.with_vertices(2 * cube.vertices + 9)]), registry)
    ran = orbiframe(
        "remesh",
        tmp_path / "two.off",
        "-o",
        tmp_path / "out.ply",
        "--vertices",
        500,
        "--set",
        "basis.size=120",
        "--quiet",
    )
    assert (ran.status, ran.out, ran.err) == (0, "", "")
    mesh = read(tmp_path / "out.ply", registry)
    assert require_closed_surface(mesh, several=True).components == 2
    assert (mesh.vertices[:, 0] > 5).mean() == pytest.approx(0.8, abs=0.03)  # four times the area


def test_small_angles_are_told_with_their_place(orbiframe, tmp_path, monkeypatch):
    """With another limit than that of users, so that some are below it whatever the mesh."""
    monkeypatch.setattr("orbiframe_remeshing.quality.SMALL", 50.0)
    ran = orbiframe("remesh", PLATE, "-o", tmp_path / "few.ply", "--vertices", 60, "--size", 80)
    assert ran.status == 0
    assert "below 25 degrees" in ran.err
    assert "near (" in ran.err


def test_stages_are_told(tmp_path, capsys):
    registry, told = Registry.discover(), []
    args = parsed(
        ["remesh", str(CUBE), "-o", str(tmp_path / "c.ply"), "--vertices", "50", "--size", "60", "--quiet"], registry
    )
    args.progress = lambda stage, seconds: told.append((stage, seconds is None))
    assert args.run(args, registry) == 0
    assert ("map", True) in told
    assert told[-2:] == [("remesh", True), ("remesh", False)]


@pytest.mark.parametrize(
    ("options", "status", "words"),
    [
        ((), 2, "one of the arguments"),
        (("--vertices", 50, "--edge-length", 1), 2, "not allowed"),
        (("--vertices", 3), 2, "give 4 to"),
        (("--edge-length", -1), 2, "positive length"),
        (("--edge-length", 1e-5, "--size", 60), 1, "about"),
        (("--vertices", 50, "--seed", -1), 2, "0 or more"),
        (("--vertices", 50, "-o", "none/out.ply"), 1, "no folder none"),
        (("--vertices", 50, "-o", "out.xyz"), 1, "not known"),
    ],
)
def test_what_cannot_be(orbiframe, tmp_path, monkeypatch, options, status, words):
    monkeypatch.chdir(tmp_path)
    ran = orbiframe("remesh", CUBE, "-o", "out.ply", *options)
    assert ran.status == status
    assert words in ran.err
    assert list(tmp_path.iterdir()) == []


def test_an_input_is_never_written_over(orbiframe, tmp_path):
    mesh = tmp_path / "cube.off"
    mesh.write_bytes(CUBE.read_bytes())
    ran = orbiframe("remesh", mesh, "-o", mesh, "--vertices", 50)
    assert ran.status == 2
    assert "the input itself" in ran.err
    assert mesh.read_bytes() == CUBE.read_bytes()
