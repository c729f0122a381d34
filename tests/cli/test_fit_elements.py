"""orbiframe fit --order, and remesh --order: curved triangles for finite elements."""

from __future__ import annotations

import json

import meshio
import numpy as np
import pytest
from fitted import DATASETS

CUBE = DATASETS / "cube.off"


@pytest.mark.parametrize("name", ["cube.msh", "cube.msh2", "cube.vtu", "cube.mesh"])
def test_every_suffix_is_written_and_told(orbiframe, tmp_path, name):
    ran = orbiframe("fit", CUBE, "-o", tmp_path / name, "--order", 3, "--size", 60)
    assert (ran.status, ran.err) == (0, "")
    assert "triangles of order 3" in ran.out
    assert (tmp_path / name).stat().st_size > 1000


@pytest.mark.long
def test_each_triangle_is_cut_as_refine_says(orbiframe, tmp_path):
    for refine in (1, 2):
        ran = orbiframe(
            "fit", CUBE, "-o", tmp_path / f"{refine}.msh", "--order", 2, "--size", 60, "--refine", refine, "--quiet"
        )
        assert (ran.status, ran.out, ran.err) == (0, "", "")
    one, two = (meshio.read(tmp_path / f"{n}.msh").cells[0].data for n in (1, 2))
    assert len(two) == 4 * len(one)


@pytest.mark.long
def test_another_format_by_its_name(orbiframe, tmp_path):
    for command, options in (("fit", ()), ("remesh", ("--vertices", 60))):
        out = tmp_path / "cube.msh"
        ran = orbiframe(command, CUBE, "-o", out, "--order", 2, "--format", "gmsh-2.2", "--size", 60, *options)
        assert ran.status == 0
        assert out.read_text().startswith("$MeshFormat\n2.2 ")


def test_remeshed_elements_are_as_many_as_the_triangles(orbiframe, tmp_path):
    ran = orbiframe("remesh", CUBE, "-o", tmp_path / "c.vtu", "--order", 4, "--vertices", 80, "--size", 60, "--json")
    assert ran.status == 0
    found = json.loads(ran.out)
    assert (found["order"], found["faces"], found["nodes"]) == (4, 156, 2 + 156 * 8)


@pytest.mark.long
def test_several_surfaces_in_one_file(orbiframe, tmp_path):
    from orbiframe import Registry, read, write
    from orbiframe.meshes import disjoint_union

    registry = Registry.discover()
    cube = read(CUBE, registry)
    write(tmp_path / "two.off", disjoint_union([cube, cube.with_vertices(cube.vertices + 9)]), registry)
    ran = orbiframe("fit", tmp_path / "two.off", "-o", tmp_path / "two.msh", "--order", 2, "--size", 200)
    assert ran.status == 0
    found = meshio.read(tmp_path / "two.msh")
    assert np.array_equal(np.unique(found.cells[0].data), np.arange(len(found.points)))
    assert (found.points[:, 0] > 4).mean() == pytest.approx(0.5)
    assert "triangles of order 2" in ran.out


@pytest.mark.parametrize(
    ("options", "status", "words"),
    [
        (("--order", 7), 2, "1 to 6"),
        (("--format", "gmsh-2.2"), 2, "add --order"),
        (("--order", 2, "-o", "cube.ply"), 1, "the formats of elements know .mesh .msh"),
        (("--order", 2, "--format", "gnash"), 2, "gnash"),
    ],
)
@pytest.mark.parametrize("command", ["fit", "remesh"])
def test_what_cannot_be(orbiframe, tmp_path, monkeypatch, command, options, status, words):
    monkeypatch.chdir(tmp_path)
    more = () if command == "fit" else ("--vertices", 50)
    ran = orbiframe(command, CUBE, "-o", "cube.msh", *options, *more)
    assert ran.status == status
    assert words in ran.err
    assert list(tmp_path.iterdir()) == []


def test_quadrilaterals_have_no_order(orbiframe, tmp_path):
    ran = orbiframe("remesh", CUBE, "-o", tmp_path / "c.msh", "--order", 2, "--quads", "--vertices", 50)
    assert ran.status == 2
    assert "--quads" in ran.err
