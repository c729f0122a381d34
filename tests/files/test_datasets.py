"""Meshes that come with orbiframe are read by their names, from a checkout and from an installed package."""

from __future__ import annotations

from pathlib import Path

import pytest

import orbiframe as package
from orbiframe import FormatError, Registry, read
from orbiframe.files import datasets, located

REGISTRY = Registry.discover()


@pytest.mark.parametrize("name", ["dataset:torus", Path("dataset:torus"), "dataset:torus.off"])
def test_a_dataset_is_read_by_its_name(name):
    assert read(name, REGISTRY).face_count == 288


def test_any_other_path_is_left_alone():
    assert located("some/mesh.off") == Path("some/mesh.off")


def test_in_an_installed_package_they_lie_within_it(monkeypatch, tmp_path):
    (tmp_path / "datasets").mkdir()
    (tmp_path / "datasets" / "ball.off").write_text("OFF")
    monkeypatch.setattr(datasets, "files", lambda _: tmp_path)
    assert located("dataset:ball") == tmp_path / "datasets" / "ball.off"
    with pytest.raises(FormatError, match="no dataset 'torus'; there are ball"):
        located("dataset:torus")


def test_a_name_that_is_not_there_gets_the_nearest_one():
    with pytest.raises(FormatError, match=r"there is no dataset 'tors'; there are cube, .* Did you mean 'torus'"):
        read("dataset:tors", REGISTRY)
    with pytest.raises(FormatError, match="no dataset"):
        read("dataset:../pyproject", REGISTRY)


def test_the_reference_names_them_all():
    page = (Path(__file__).parents[2] / "docs" / "reference" / "cli.md").read_text()
    told = (
        page.partition("one that comes with orbiframe: ")[2].partition(".")[0].replace(" or ", ", ").replace("\n", " ")
    )
    folder = Path(__file__).parents[2] / "datasets"
    assert [name.strip() for name in told.split(",")] == sorted(file.stem for file in folder.glob("*.off"))


def test_commands_take_them(orbiframe, tmp_path):
    assert orbiframe("info", "dataset:torus").out.startswith("closed, orientable, genus 1")
    assert orbiframe("convert", "dataset:torus", tmp_path / "torus.ply").status == 0
    assert package.surface_type(read(tmp_path / "torus.ply", REGISTRY)).genus == 1
    assert orbiframe("info", "dataset:tors").status == 1
