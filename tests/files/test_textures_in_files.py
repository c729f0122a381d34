"""Texture coordinates in files, as other libraries read them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from late import Late

from orbiframe import Notice, Polyhedron, fit
from orbiframe.files import read, write
from orbiframe.meshes import reversed_faces

trimesh = Late("trimesh")

# A cube opened into a cross, each face a square of the texture.
CORNERS = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
CELLS = [[0, 1], [1, 1], [2, 1], [3, 1], [1, 0], [1, 2]]
SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])


def cube() -> Polyhedron:
    uv = np.concatenate([(SQUARE + cell) / 4 for cell in CELLS])
    return replace(Polyhedron.from_faces(CORNERS, FACES), corner_uv=uv)


def triangles() -> Polyhedron:
    whole = cube()
    corner = np.concatenate([[4 * f + k for k in (0, 1, 2, 0, 2, 3)] for f in range(6)])
    return replace(Polyhedron.from_faces(CORNERS, whole.tail[corner].reshape(-1, 3)), corner_uv=whole.corner_uv[corner])


def told(points: np.ndarray, uv: np.ndarray) -> set[tuple[float, ...]]:
    return {tuple(row) for row in np.round(np.column_stack([points, uv]), 6).tolist()}


@pytest.mark.parametrize("suffix", [".obj", ".glb", ".gltf"])
@pytest.mark.parametrize("normals", [False, True])
def test_trimesh_reads_the_texture_of_every_corner(tmp_path, suffix, normals):
    mesh = triangles()
    if normals:
        away = mesh.vertices - 0.5
        mesh = replace(mesh, normals=away / np.linalg.norm(away, axis=1, keepdims=True))
    write(path := tmp_path / f"cube{suffix}", mesh)
    found = trimesh.load(path, force="mesh", process=False)
    corners = np.asarray(found.faces).ravel()
    assert told(np.asarray(found.vertices)[corners], np.asarray(found.visual.uv)[corners]) == told(
        mesh.vertices[mesh.tail], mesh.corner_uv
    )
    again = read(path)
    assert again.face_count == 12
    if normals:
        expected = again.vertices - 0.5
        assert np.abs(again.normals - expected / np.linalg.norm(expected, axis=1, keepdims=True)).max() < 1e-6


def test_polygons_keep_theirs_in_obj(tmp_path):
    write(path := tmp_path / "cube.obj", cube())
    lines = path.read_text().splitlines()
    texture = [tuple(map(float, line.split()[1:])) for line in lines if line.startswith("vt ")]
    faces = [[tuple(map(int, word.split("/"))) for word in line.split()[1:]] for line in lines if line[0] == "f"]
    assert [[vertex - 1 for vertex, _ in face] for face in faces] == FACES
    assert [texture[point - 1] for face in faces for _, point in face] == [tuple(row) for row in cube().corner_uv]
    assert len(texture) == 14  # corners of the cross


def test_creases_and_textures_go_together(tmp_path):
    mesh = triangles()
    flat = np.repeat(np.eye(3)[[2, 2, 1, 0, 1, 0]] * [[-1], [1], [-1], [1], [1], [-1]], 6, axis=0)
    write(path := tmp_path / "cube.obj", replace(mesh, normals=mesh.vertices, corner_normals=flat))
    words = [line.split()[1:] for line in path.read_text().splitlines()]
    assert sum(line.startswith("vn ") for line in path.read_text().splitlines()) == 6
    assert all(word.count("/") == 2 for line in words[-12:] for word in line)


@pytest.mark.parametrize("suffix", [".ply", ".off", ".stl", ".vtp"])
def test_other_formats_say_what_they_leave_out(tmp_path, suffix):
    with pytest.warns(UserWarning, match="no texture coordinates; left out"):
        write(tmp_path / f"cube{suffix}", triangles())


def test_mirrored_rows_of_gltf_are_seen_by_another_reader(tmp_path):
    """glTF counts from the upper left corner: what is high in the texture has a small second coordinate in the file."""
    import json

    write(path := tmp_path / "cube.gltf", triangles())
    tree = json.loads(Path(path).read_text())
    accessor = tree["accessors"][tree["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"]]
    assert (accessor["type"], accessor["componentType"]) == ("VEC2", 5126)
    assert tree["meshes"][0]["primitives"][0]["material"] == 0


@pytest.mark.parametrize("suffix", [".obj", ".glb", ".gltf"])
def test_texture_coordinates_are_read_again(tmp_path, suffix):
    mesh = triangles()
    write(path := tmp_path / f"cube{suffix}", mesh)
    again = read(path)
    assert told(again.vertices[again.tail], again.corner_uv) == told(mesh.vertices[mesh.tail], mesh.corner_uv)


def test_faces_that_are_turned_take_their_texture_along():
    mesh = cube()
    turned = reversed_faces(mesh, np.array([True, False, True, False, False, False]))
    assert told(turned.vertices[turned.tail], turned.corner_uv) == told(mesh.vertices[mesh.tail], mesh.corner_uv)


def test_an_obj_file_of_which_some_corners_have_no_texture_has_none(tmp_path):
    lines = ["v 0 0 0", "v 1 0 0", "v 0 1 0", "v 0 0 1", "vt 0.5", "f 1/1 3/1 2/1", "f 1 2 4", "f 2 3 4", "f 3 1 4"]
    (path := tmp_path / "a.obj").write_text("\n".join(lines))
    assert read(path).corner_uv is None
    path.write_text(
        "\n".join(lines)
        .replace("f 1 2 4", "f 1/-1 2/1 4/1")
        .replace("2 3 4", "2/1 3/1 4/1")
        .replace("3 1 4", "3/1 1/1 4/1")
    )
    assert np.array_equal(read(path).corner_uv, np.tile([0.5, 0.0], (12, 1)))


def test_a_fit_says_that_it_leaves_them_out():
    with pytest.warns(Notice, match="--uv makes new ones"):
        result = fit(triangles(), size=30, fast=True, refine=1)
    assert result.output.corner_uv is None
