"""Plugins as distributions of their own, installed by pip beside the built wheel of orbiframe, as strangers do it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "docs" / "examples").glob("orbiframe_example_*"))
# Every component of every example, and a component of a basis, a reader, ... by the name of the plugin.
COMPONENTS = {
    "example_area": ["command/area"],
    "example_bezier": ["exporter/bezier-json"],
    "example_hats": ["basis/hats"],
    "example_huber": ["fitter/huber"],
    "example_npz": ["reader/npz", "writer/npz"],
    "example_plane": ["geometry/complex-plane", "group/rhombus"],
}

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The folder where pip has put the wheel of orbiframe and all examples, built from copies of their sources."""
    folder = tmp_path_factory.mktemp("distributions")
    wheel = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", str(folder)]
    subprocess.run(wheel, cwd=ROOT, check=True, capture_output=True)
    sources = [folder / example.name for example in EXAMPLES]
    for example, source in zip(EXAMPLES, sources, strict=True):
        shutil.copytree(example, source, ignore=shutil.ignore_patterns("__pycache__", "tests"))
    target = folder / "site"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-deps", "--no-index"]
    subprocess.run([*pip, "--target", target, *folder.glob("*.whl"), *sources], check=True)
    return target


@pytest.fixture
def run(site, tmp_path):
    """Run a module of Python with what is installed, in an empty folder."""

    def ran(*arguments: object, status: int = 0) -> str:
        environment = {**os.environ, "PYTHONPATH": str(site)}
        command = [sys.executable, "-m", *map(str, arguments)]
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == status, done.stdout + done.stderr
        return done.stdout

    return ran


def test_they_run_with_the_wheel(site):
    code = "import orbiframe, orbiframe_bases; print(orbiframe.__file__); print(orbiframe_bases.__file__)"
    environment = {**os.environ, "PYTHONPATH": str(site)}
    found = subprocess.run(
        [sys.executable, "-c", code], cwd=site.parent, env=environment, capture_output=True, text=True
    )
    assert [Path(line).parents[1] for line in found.stdout.splitlines()] == [site, site]


def test_all_are_found_by_their_entry_points(run):
    listed = json.loads(run("orbiframe", "plugins", "--json"))
    assert listed["broken"] == []
    ours: dict[str, list[str]] = {}
    for c in listed["components"]:
        if c["plugin"].startswith("example_"):
            ours.setdefault(c["plugin"], []).append(f"{c['kind']}/{c['name']}")
    assert {plugin: sorted(names) for plugin, names in ours.items()} == COMPONENTS


@pytest.mark.parametrize("name", [name for names in COMPONENTS.values() for name in names])
def test_each_keeps_the_laws_of_its_kind(run, name):
    assert "FAILS" not in run("orbiframe", "plugins", "check", name)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_the_tests_of_each_pass(run, example, tmp_path):
    for test in (example / "tests").glob("*.py"):
        shutil.copy(test, tmp_path)
    assert "passed" in run("pytest", "-p", "no:cacheprovider", "-p", "no:dash", tmp_path)


def test_the_commands_know_them(run, tmp_path):
    cube = tmp_path / "cube.off"
    faces = ["4 0 1 3 2", "4 4 6 7 5", "4 0 4 5 1", "4 2 3 7 6", "4 0 2 6 4", "4 1 5 7 3"]
    corners = [f"{x} {y} {z / 3!r}" for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    cube.write_text("\n".join(["OFF", "8 6 12", *corners, *faces]) + "\n")
    run("orbiframe", "convert", cube, "cube.npz")
    run("orbiframe", "convert", "cube.npz", "again.off")
    assert run("orbiframe", "info", "again.off").startswith("closed, orientable, genus 0,")
    assert repr(1 / 3) in (tmp_path / "again.off").read_text()
    run("orbiframe", "fit", cube, "-o", "cube.bezier", "--basis", "ps2", "--size", 60, "--quiet")
    assert json.loads((tmp_path / "cube.bezier").read_text())["shape"] == "triangle"


def test_a_fit_takes_all_of_them(run, tmp_path):
    torus = ROOT / "datasets" / "torus.off"
    steps = [
        "geometry.name=complex-plane",
        "group.angle=75",
        "fitter.name=huber",
        "data.lift=false",
        "basis.reach=14.0",
    ]
    named = ["--group", "rhombus", "--basis", "hats", "--size", "100", "--save", "torus.npz"]
    options = [word for step in steps for word in ("--set", step)]
    report = json.loads(run("orbiframe", "fit", torus, "-o", "smooth.ply", *named, *options, "--json"))
    assert report["geometry"] == "complex-plane"
    assert report["fit"]["basis"] == "hats"
    assert report["fit"]["rms"] < 0.02
    code = tmp_path / "loaded.py"
    code.write_text("from orbiframe import load_surface\nprint(load_surface('torus.npz').orbifold.geometry.name)\n")
    assert run("loaded") == "complex-plane\n"


def test_they_are_not_there_when_they_are_not_installed():
    listed = subprocess.run([sys.executable, "-m", "orbiframe", "plugins"], capture_output=True, text=True, check=True)
    assert "example_" not in listed.stdout
