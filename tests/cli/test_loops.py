from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

DATASETS = Path(__file__).parents[2] / "datasets"


def polylines(path: Path) -> list[np.ndarray]:
    """The points of every polyline of an OBJ file."""
    points, lines = [], []
    for line in path.read_text().splitlines():
        kind, *words = line.split()
        if kind == "v":
            points.append([float(word) for word in words])
        if kind == "l":
            lines.append([int(word) - 1 for word in words])
    return [np.array(points)[line] for line in lines]


@pytest.mark.parametrize(
    ("name", "letters", "homology"),
    [
        ("plate_genus2", "abcd", "Z^4"),
        ("klein_bottle", "ab", "Z + Z/2"),
        ("three_crosscaps", "abc", "Z^2 + Z/2"),
        ("projective_plane", "a", "Z/2"),
        ("cube", "", "0"),
    ],
)
def test_loops_are_written_and_the_groups_are_said(orbiframe, tmp_path, name, letters, homology):
    mesh = DATASETS / f"{name}.off"
    ran = orbiframe("info", mesh, "--loops", tmp_path / "loops.json")
    assert ran.status == 0
    assert f"first homology {homology}" in ran.out
    found = json.loads((tmp_path / "loops.json").read_text())
    assert [loop["letter"] for loop in found["loops"]] == list(letters)
    assert f"word {found['word']}\nfundamental group {found['fundamental_group']}" in ran.out
    words = [line.split() for line in mesh.read_text().splitlines()[2:]]
    vertices = np.array([row for row in words if len(row) == 3], dtype=float)
    orbiframe("info", mesh, "--loops", tmp_path / "loops.obj", "--json")
    for loop, line in zip(found["loops"], polylines(tmp_path / "loops.obj"), strict=True):
        np.testing.assert_array_equal(loop["points"], vertices[loop["vertices"]])
        np.testing.assert_array_equal(loop["points"], line)
        assert loop["vertices"][0] == loop["vertices"][-1] == found["loops"][0]["vertices"][0]
        length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
        np.testing.assert_allclose(length, loop["length"])
        assert f"loop {loop['letter']}: {len(line) - 1} edges, length {length:.6g}" in ran.out


def test_loops_of_a_mesh_with_vertices_in_no_face(orbiframe, tmp_path):
    lines = (DATASETS / "torus.off").read_text().splitlines()
    shifted = [" ".join([w[0], *(str(int(i) + 1) for i in w[1:])]) for w in map(str.split, lines[290:])]
    mesh = tmp_path / "torus.off"
    mesh.write_text("\n".join(["OFF", "289 288 576", "9 9 9", *lines[2:290], *shifted]))
    assert orbiframe("info", mesh, "--loops", tmp_path / "a.json").status == 0
    orbiframe("info", DATASETS / "torus.off", "--loops", tmp_path / "b.json")
    a, b = (json.loads((tmp_path / f"{name}.json").read_text())["loops"] for name in "ab")
    assert [loop["points"] for loop in a] == [loop["points"] for loop in b]
    assert [[i - 1 for i in loop["vertices"]] for loop in a] == [loop["vertices"] for loop in b]


def test_json_has_the_groups_beside_the_description(orbiframe, tmp_path):
    ran = orbiframe("info", DATASETS / "torus.off", "--loops", tmp_path / "l.json", "--json")
    found = json.loads(ran.out)
    assert (found["word"], found["first_homology"], found["genus"]) == ("abAB", "Z^2", 1)
    assert [set(loop) for loop in found["loops"]] == [{"letter", "length"}] * 2


@pytest.mark.parametrize(
    ("arguments", "said", "status"),
    [
        (["torus.off", "--loops", "loops.vtk"], ".json or .obj", 2),
        (["torus.off", "cube.off", "--loops", "loops.obj"], "takes one mesh, and 2 are given", 2),
        (["torus.off", "--loops", "nowhere/loops.obj"], "there is no folder", 1),
        (["open.off", "--loops", "loops.obj"], "not one closed connected surface", 1),
    ],
)
def test_what_cannot_be_is_refused(orbiframe, tmp_path, arguments, said, status):
    (tmp_path / "open.off").write_text("OFF\n3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    out = tmp_path / arguments[-1]
    meshes = [tmp_path / a if a == "open.off" else DATASETS / a for a in arguments if a.endswith(".off")]
    ran = orbiframe("info", *meshes, "--loops", out)
    assert (ran.status, said in ran.err) == (status, True), ran.err
    assert not out.exists()
