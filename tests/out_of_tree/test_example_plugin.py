"""The example plugin, installed as a stranger would install it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "orbiframe_example_npz"


@pytest.fixture(scope="module")
def example(tmp_path_factory):
    """The folder where pip has put the example, built from a copy of its sources."""
    source = tmp_path_factory.mktemp("source") / "example"
    shutil.copytree(EXAMPLE, source, ignore=shutil.ignore_patterns("__pycache__"))
    target = tmp_path_factory.mktemp("site")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-deps", "--no-index"]
    subprocess.run([*pip, "--target", target, source], check=True)
    return target


def run(*arguments: object, example: Path, cwd: Path | None = None) -> str:
    environment = {**os.environ, "PYTHONPATH": str(example)}
    command = [sys.executable, "-m", *map(str, arguments)]
    done = subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_it_is_found_by_its_entry_point(example):
    listed = json.loads(run("orbiframe", "plugins", "--json", example=example))
    ours = [(c["kind"], c["name"]) for c in listed["components"] if c["plugin"] == "example_npz"]
    assert ours == [("reader", "npz"), ("writer", "npz")]


def test_the_commands_know_its_suffix(example, tmp_path):
    cube = tmp_path / "cube.off"
    faces = ["4 0 1 3 2", "4 4 6 7 5", "4 0 4 5 1", "4 2 3 7 6", "4 0 2 6 4", "4 1 5 7 3"]
    corners = [f"{x} {y} {z / 3!r}" for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    cube.write_text("\n".join(["OFF", "8 6 12", *corners, *faces]) + "\n")
    run("orbiframe", "convert", cube, tmp_path / "cube.npz", example=example)
    run("orbiframe", "convert", tmp_path / "cube.npz", tmp_path / "again.off", example=example)
    assert run("orbiframe", "info", tmp_path / "again.off", example=example).startswith("closed, orientable, genus 0,")
    assert repr(1 / 3) in (tmp_path / "again.off").read_text()


@pytest.mark.parametrize("name", ["reader/npz", "writer/npz"])
def test_it_keeps_the_laws_without_pytest(example, name):
    assert "FAILS" not in run("orbiframe", "plugins", "check", name, example=example)


def test_its_own_tests_pass(example, tmp_path):
    shutil.copy(EXAMPLE / "tests" / "test_npz.py", tmp_path)
    assert "passed" in run("pytest", "-p", "no:cacheprovider", "test_npz.py", example=example, cwd=tmp_path)


def test_it_is_not_there_when_it_is_not_installed():
    listed = subprocess.run([sys.executable, "-m", "orbiframe", "plugins"], capture_output=True, text=True, check=True)
    assert "npz" not in listed.stdout
