"""orbiframe warm-up runs the commands that plugins name, and says how far it is."""

from __future__ import annotations

import warnings
from pathlib import Path
from types import SimpleNamespace

import pytest

from orbiframe.cli import plugin as commands, warm_up
from orbiframe.cli.main import parsed
from orbiframe.components.registry import Registry
from orbiframe.meshes.surface_type import surface_type
from orbiframe.plugin import hookimpl


class Stranger:
    """A plugin with commands to warm up."""

    def __init__(self, *lines: str) -> None:
        self.lines = lines

    @hookimpl
    def orbiframe_warm_up(self) -> list[str]:
        return list(self.lines)


@pytest.fixture
def warmed(monkeypatch, capsys):
    """Run the command with the commands of one plugin alone; returns status, output, errors."""

    def run(*lines: str, quiet: bool = False) -> tuple[int, str, str]:
        monkeypatch.setattr(warm_up, "_LARGE", 4)
        registry = Registry.discover(only=["polygons"])
        registry.register("commands", commands)
        monkeypatch.setattr(registry, "warm_up_commands", lambda: list(lines))
        args = parsed(["warm-up", *(["--quiet"] if quiet else [])], registry)
        capsys.readouterr()
        status = args.run(args, registry)
        return (status, *capsys.readouterr())

    return run


def test_commands_run_in_a_folder_that_goes(warmed, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ran = warmed("convert torus.off torus.obj", "info torus.obj")
    assert ran == (
        0,
        "nothing to compile: all is kept\n",
        "orbiframe: 1 of 2: convert torus.off torus.obj\norbiframe: 2 of 2: info torus.obj\n",
    )
    assert Path.cwd() == tmp_path
    assert list(tmp_path.iterdir()) == []


def test_quiet(warmed):
    assert warmed("info torus.off", quiet=True) == (0, "", "")


def test_what_commands_say_of_the_small_meshes_is_not_repeated(warmed, monkeypatch):
    def run(*_: object) -> int:
        warnings.warn("the mesh has sharp edges", stacklevel=2)
        return 0

    monkeypatch.setattr("orbiframe.cli.main.parsed", lambda *_: SimpleNamespace(run=run))
    assert warmed("curvature torus.off -o torus.csv", quiet=True) == (0, "", "")


def test_a_command_that_fails_is_named_and_the_others_run(warmed):
    status, _, error = warmed("info none.off", "convert torus.off none.nonsense", "info torus.off")
    assert status == 1
    assert "orbiframe: convert torus.off none.nonsense: " in error
    assert "3 of 3: info torus.off" in error


def test_the_promised_meshes_are_there(warmed, monkeypatch):
    promised = ["prism", "torus", "double_torus", "projective_plane", "klein_bottle", "large"]
    assert warmed(*(f"info {name}.off" for name in promised))[0] == 0


def test_the_large_mesh_is_a_torus():
    assert surface_type(warm_up._large_torus(5)).name == "closed, orientable, genus 1, 1 component"


def test_a_stranger_takes_part():
    registry = Registry.discover()
    registry.register("stranger", Stranger("info torus.off", "info prism.off"))
    assert registry.warm_up_commands()[-2:] == ["info torus.off", "info prism.off"]


def test_every_command_that_a_plugin_names_can_be_parsed():
    registry = Registry.discover()
    registry.register("commands", commands)
    lines = registry.warm_up_commands()
    assert len(lines) > 10
    for line in lines:
        assert callable(parsed(line.split(), registry).run)
