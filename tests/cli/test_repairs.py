from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

from orbiframe.components.registry import Registry
from orbiframe.files import gate
from orbiframe.meshes.orientation import reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.polyhedra import reference_polyhedra

REGISTRY = Registry.discover()
MESHES = reference_polyhedra()


def taken_apart(mesh):
    return Polyhedron.from_corners(mesh.vertices[mesh.tail], mesh.offsets, np.arange(len(mesh.tail)))


def with_faces(mesh, *extra):
    faces = [mesh.face_corners(face).tolist() for face in range(mesh.face_count)]
    return Polyhedron.from_faces(mesh.vertices, [*faces, *extra])


def two_solids():
    """A cube and a tetrahedron that share a corner."""
    cube, tetrahedron = MESHES["cube"], MESHES["tetrahedron"]
    faces = [cube.face_corners(f).tolist() for f in range(6)]
    faces += [[(c + 8 if c else 7) for c in tetrahedron.face_corners(f)[::-1].tolist()] for f in range(4)]
    return Polyhedron.from_faces(np.vstack([cube.vertices, 3 + tetrahedron.vertices]), faces)


def inward():
    return reversed_faces(MESHES["cube"], np.ones(6, dtype=bool))


DAMAGE = {
    "weld": (lambda: taken_apart(MESHES["cube"]), ["--weld", "0"], "24 vertices became 8"),
    "drop": (lambda: with_faces(MESHES["cube"], [0, 1, 3, 2]), ["--drop-degenerate"], "1 duplicate face dropped"),
    "two corners": (lambda: with_faces(MESHES["cube"], [0, 1, 0, 1]), ["--drop-degenerate"], "0 simple faces"),
    "split": (two_solids, ["--split-nonmanifold-vertices", "--component", "2"], "1 vertex of several fans split"),
    "component": (two_solids, ["--component", "largest"], "component 1 of 2 kept"),
    "orient": (inward, ["--orient"], "6 of 6 faces reversed"),
    "triangulate": (lambda: MESHES["cube"], ["--triangulate"], "6 faces of more than 3 corners cut into 12"),
}


def off_of(mesh):
    points = "\n".join(" ".join(map(str, point)) for point in mesh.vertices.tolist())
    rows = (mesh.face_corners(face).tolist() for face in range(mesh.face_count))
    faces = "\n".join(" ".join(map(str, [len(row), *row])) for row in rows)
    return f"OFF\n{len(mesh.vertices)} {mesh.face_count} 0\n{points}\n{faces}\n"


@pytest.fixture
def damaged(tmp_path):
    def make(name):
        path = tmp_path / "damaged.off"
        path.write_text(off_of(DAMAGE[name][0]()))
        return path

    return make


@pytest.mark.parametrize("name", DAMAGE)
def test_each_repair_mends_and_says_so(orbiframe, damaged, tmp_path, name):
    path, (_, options, said) = damaged(name), DAMAGE[name]
    ran = orbiframe("convert", path, tmp_path / "mended.off", *options)
    assert ran.status == 0
    assert ran.err.startswith(f"orbiframe: {options[0].removeprefix('--')}: ")
    assert said in ran.err
    found = json.loads(orbiframe("info", tmp_path / "mended.off", "--json").out)
    assert (found["closed"], found["components"], found["genus"]) == (True, 1, 0)
    assert found["volume"] > 0
    assert not {defect["kind"] for defect in found["defects"]} - {"vertices in no face"}


@pytest.mark.parametrize("name", [name for name in DAMAGE if name not in ("orient", "triangulate", "split")])
def test_info_and_fit_name_the_option_that_helps(orbiframe, damaged, tmp_path, name):
    path, option = damaged(name), " ".join(DAMAGE[name][1])
    assert f"; {option} helps" in orbiframe("info", path).out
    refused = orbiframe("fit", path, "-o", tmp_path / "out.ply", "--size", 40, "--refine", 1)
    assert refused.status == 1
    assert DAMAGE[name][1][0] in refused.err
    mended = orbiframe("fit", path, "-o", tmp_path / "out.ply", "--size", 40, "--refine", 1, *DAMAGE[name][1])
    assert (mended.status, DAMAGE[name][2] in mended.err) == (0, True)


def test_repairs_have_one_order(orbiframe, damaged, tmp_path):
    path = damaged("weld")
    options = ["--triangulate", "--orient", "--component", "1", "--split-nonmanifold-vertices", "--drop-degenerate"]
    ran = orbiframe("convert", path, tmp_path / "out.stl", *options, "--weld", "1e-9")
    assert ran.status == 0
    assert [line.split(": ")[1] for line in ran.err.splitlines()] == [
        "weld",
        "drop-degenerate",
        "split-nonmanifold-vertices",
        "component",
        "orient",
        "triangulate",
    ]
    assert ran.err.count("nothing to change") == 4
    assert gate.read(tmp_path / "out.stl", REGISTRY).face_count == 12


def test_nothing_is_repaired_unasked(orbiframe, damaged, tmp_path):
    ran = orbiframe("convert", damaged("weld"), tmp_path / "out.off")
    assert (ran.status, ran.err) == (0, "")
    assert len(gate.read(tmp_path / "out.off", REGISTRY).vertices) == 24
    refused = orbiframe("convert", damaged("two corners"), tmp_path / "out.off")
    assert refused.status == 1
    assert "face 6 has the vertices 0 1 0 1" in refused.err


def test_a_quiet_fit_says_nothing(orbiframe, damaged, tmp_path):
    options = ["--size", 40, "--refine", 1, "--quiet", "--weld", 0]
    assert orbiframe("fit", damaged("weld"), "-o", tmp_path / "out.ply", *options) == (0, "", "")


@pytest.mark.parametrize(("tolerance", "vertices"), [("0", 24), ("1e-4", 24), ("0.01", 8)])
def test_points_are_joined_that_are_as_near_as_the_tolerance(orbiframe, damaged, tmp_path, tolerance, vertices):
    """The corners of six squares, moved apart by some thousandths."""
    path, apart = tmp_path / "apart.off", taken_apart(MESHES["cube"])
    gate.write(path, apart.with_vertices(apart.vertices + 1e-3 * np.random.default_rng(0).random((24, 3))), REGISTRY)
    ran = orbiframe("convert", path, tmp_path / "out.off", "--weld", tolerance)
    assert ran.status == 0
    assert len(gate.read(tmp_path / "out.off", REGISTRY).vertices) == vertices


@pytest.mark.parametrize(
    "option", [["--weld", "-1"], ["--weld", "inf"], ["--weld", "x"], ["--component", "0"], ["--component", "some"]]
)
def test_wrong_values_are_wrong_use(orbiframe, damaged, tmp_path, option):
    ran = orbiframe("convert", damaged("weld"), tmp_path / "out.off", *option)
    assert ran.status == 2
    assert option[0] in ran.err
    assert not (tmp_path / "out.off").exists()


def test_a_component_that_is_not_there_is_said(orbiframe, damaged, tmp_path):
    ran = orbiframe("convert", damaged("component"), tmp_path / "out.off", "--component", "3")
    assert (ran.status, "there are 1 to 2, of 6, 4 faces" in ran.err) == (2, True)


def test_a_pipe_of_two_processes(damaged):
    """A real standard input and output, as a shell joins them."""
    convert = [sys.executable, "-m", "orbiframe", "convert", "-", "-", "-i", "off", "-o", "stl", "--weld", "0"]
    made = subprocess.run(
        [*convert, "--triangulate"], input=damaged("weld").read_bytes(), capture_output=True, check=True
    )
    info = [sys.executable, "-m", "orbiframe", "info", "-", "-i", "stl"]
    found = subprocess.run(info, input=made.stdout, capture_output=True, check=True)
    assert found.stdout.startswith(b"closed, orientable, genus 0, 1 component")
