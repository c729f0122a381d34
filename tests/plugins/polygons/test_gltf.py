from __future__ import annotations

import base64
import json
import os
import struct
import warnings

import numpy as np
import pytest
from orbiframe_polygons.gltf.reader import read
from orbiframe_polygons.gltf.writer import write
from small_meshes import CUBE, QUADS, TRIANGLES, lists, volume

from orbiframe import FormatError, Polyhedron, surface_type
from orbiframe.testing import contract_tests

test_reader_laws = contract_tests("reader", read, suffix=".glb", counterpart=write)
test_writer_laws = contract_tests("writer", write, suffix=".gltf", counterpart=read)

POINTS = np.array(CUBE, dtype="<f4")
CORNERS = np.array(TRIANGLES, dtype="<u2").ravel()


class File:
    """A glTF that is built piece by piece."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.tree: dict = {"asset": {"version": "2.0"}, "bufferViews": [], "accessors": [], "scenes": [{"nodes": [0]}]}
        self.tree |= {"nodes": [{"mesh": 0}], "meshes": []}

    def view(self, values: np.ndarray, **more) -> int:
        self.data += bytes(-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes}
        self.data += values.tobytes()
        self.tree["bufferViews"].append(view | more)
        return len(self.tree["bufferViews"]) - 1

    def add(self, values: np.ndarray, **more) -> int:
        codes = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
        width = 1 if values.ndim == 1 else values.shape[1]
        accessor = {"bufferView": self.view(values), "componentType": codes[values.dtype.str[1:]], "count": len(values)}
        self.tree["accessors"].append(accessor | {"type": "SCALAR" if width == 1 else f"VEC{width}"} | more)
        return len(self.tree["accessors"]) - 1

    def mesh(self, *primitives: dict, **more) -> None:
        self.tree["meshes"].append({"primitives": list(primitives)} | more)

    def buffered(self) -> dict:
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return self.tree | {"buffers": [{"byteLength": len(self.data), "uri": uri}]}

    def text(self, path, tree=None):
        path = path / "a.gltf"
        path.write_text(json.dumps(self.buffered() if tree is None else tree))
        return path

    def binary(self, path, more: bytes = b""):
        path = path / "a.glb"
        text = json.dumps(self.tree | {"buffers": [{"byteLength": len(self.data)}]}).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self.data) + bytes(-len(self.data) % 4)
        body = (
            struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data + more
        )
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)
        return path


def cube(**primitive) -> File:
    made = File()
    attributes = {"POSITION": made.add(POINTS)}
    made.mesh({"attributes": attributes, "indices": made.add(CORNERS)} | primitive)
    return made


def test_text_and_binary(tmp_path):
    for path in (cube().text(tmp_path), cube().binary(tmp_path)):
        found = read(path)
        assert found.vertices.tolist() == CUBE
        assert lists(found) == TRIANGLES


def test_a_cube_whose_faces_are_split_for_normals_is_closed(tmp_path):
    made, order = File(), np.array(QUADS).ravel()
    normals = np.repeat(np.array([[0, 0, -1], [0, 0, 1], [0, -1, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0]]), 4, axis=0)
    corners = np.array([[4 * k + a, 4 * k + b, 4 * k + c] for k in range(6) for a, b, c in ((0, 1, 2), (0, 2, 3))])
    attributes = {"POSITION": made.add(POINTS[order]), "NORMAL": made.add(normals.astype("<f4"))}
    made.mesh({"attributes": attributes, "indices": made.add(corners.astype("<u4").ravel())})
    found = read(made.binary(tmp_path))
    assert len(found.vertices) == 8
    assert found.normals is None  # a vertex has three
    assert volume(found) == pytest.approx(1)


def test_what_is_closed_is_not_joined(tmp_path):
    """Two cubes that touch in a side stay two."""
    made = cube()
    made.tree["nodes"] = [{"children": [1, 2]}, {"mesh": 0}, {"mesh": 0, "translation": [1, 0, 0]}]
    found = read(made.text(tmp_path))
    assert len(found.vertices) == 16
    assert volume(found) == pytest.approx(2)


def test_without_indices_and_in_fans(tmp_path):
    made = File()
    made.mesh({"attributes": {"POSITION": made.add(POINTS[CORNERS])}})
    assert volume(read(made.text(tmp_path))) == pytest.approx(1)
    made = File()
    position = made.add(POINTS)
    fans = [
        {"attributes": {"POSITION": position}, "indices": made.add(np.array(q, dtype="<u1")), "mode": 6} for q in QUADS
    ]
    made.mesh(*fans)
    found = read(made.text(tmp_path))
    assert volume(found) == pytest.approx(1)
    assert surface_type(found).euler_characteristic == 2


def test_strips(tmp_path):
    made = File()
    position = made.add(POINTS)
    strips = [
        {"attributes": {"POSITION": position}, "indices": made.add(np.array([a, b, d, c], dtype="<u1")), "mode": 5}
        for a, b, c, d in QUADS
    ]
    made.mesh(*strips)
    assert volume(read(made.text(tmp_path))) == pytest.approx(1)


def test_strips_joined_by_triangles_that_are_none(tmp_path):
    whole = []
    for a, b, c, d in QUADS:
        whole += ([whole[-1], a] if whole else []) + [a, b, d, c]
    made = File()
    made.mesh(
        {"attributes": {"POSITION": made.add(POINTS)}, "indices": made.add(np.array(whole, dtype="<u1")), "mode": 5}
    )
    found = read(made.text(tmp_path))
    assert found.face_count == 12
    assert abs(volume(found)) == pytest.approx(1)


def test_lines_and_points_are_left_out_and_said(tmp_path):
    made = cube()
    primitives = made.tree["meshes"][0]["primitives"]
    primitives += [primitives[0] | {"mode": 1}, primitives[0] | {"mode": 0}]
    with pytest.warns(UserWarning, match=r"1 primitives of (lines|points)"):
        found = read(made.text(tmp_path))
    assert found.face_count == 12
    made.tree["meshes"][0]["primitives"] = primitives[1:]
    with pytest.warns(UserWarning, match="left out"), pytest.raises(FormatError, match="no triangles"):
        read(made.text(tmp_path))


# ---- placement ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("node", "factor"),
    [
        ({"scale": [-1, 1, 1]}, 1),
        ({"scale": [-1, -2, -1]}, 2),
        ({"matrix": [1, 0, 0, 0, 0, -3, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]}, 3),
        ({"matrix": [0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}, 1),
        ({"rotation": [0.5, 0.5, 0.5, 0.5], "scale": [1, 2, 1e-6], "translation": [1, 2, 3]}, 2e-6),
    ],
)
def test_a_mirroring_node_turns_the_faces(tmp_path, node, factor):
    made = cube()
    made.tree["nodes"] = [{"mesh": 0} | node]
    assert volume(read(made.text(tmp_path))) == pytest.approx(factor)


def test_nested_mirrors_and_normals(tmp_path):
    made = cube()
    normals = (POINTS - 0.5) / np.sqrt(0.75)
    made.tree["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = made.add(normals.astype("<f4"))
    made.tree["nodes"] = [{"scale": [-1, 1, 1], "children": [1]}, {"mesh": 0, "scale": [1, -2, 1]}]
    found = read(made.text(tmp_path))
    assert volume(found) == pytest.approx(2)
    centre = found.vertices.mean(axis=0)
    assert ((found.vertices - centre) * found.normals).sum(axis=1).min() > 0  # outwards still
    assert np.allclose(np.linalg.norm(found.normals, axis=1), 1)


def test_a_rotation_is_that_of_its_quaternion(tmp_path):
    made = cube()
    turn = [0, 0, np.sin(np.pi / 4), np.cos(np.pi / 4)]  # a quarter about z: x goes to y
    made.tree["nodes"] = [{"mesh": 0, "rotation": turn, "translation": [10, 0, 0]}]
    assert np.allclose(read(made.text(tmp_path)).vertices[1], [10, 1, 0])


def test_only_the_scene_is_read(tmp_path):
    made = cube()
    made.tree |= {"nodes": [{"mesh": 0}, {"mesh": 0}], "scenes": [{"nodes": [0]}, {"nodes": [0, 1]}], "scene": 1}
    assert read(made.text(tmp_path)).face_count == 24
    del made.tree["scene"]
    assert read(made.text(tmp_path)).face_count == 12


def test_morph_targets_are_obeyed(tmp_path):
    made = cube()
    moved = np.zeros_like(POINTS)
    moved[4:, 2] = 2
    made.tree["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": made.add(moved)}]
    for weights, height in (([0.5], 2), ([0], 1), (None, 1)):
        if weights is not None:
            made.tree["meshes"][0]["weights"] = weights
        else:
            del made.tree["meshes"][0]["weights"]
        assert volume(read(made.text(tmp_path))) == pytest.approx(height)
    made.tree["nodes"][0]["weights"] = [1]
    assert volume(read(made.text(tmp_path))) == pytest.approx(3)


# ---- numbers --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "one"), [("<i2", 32767), ("<u2", 65535), ("<i1", 127), ("<u1", 255)])
def test_quantized_positions(tmp_path, kind, one):
    made = File()
    values = np.zeros((8, 4), dtype=kind)
    values[:, :3] = np.array(CUBE) * one
    codes = {"<i2": 5122, "<u2": 5123, "<i1": 5120, "<u1": 5121}
    made.tree["accessors"].append(
        {"bufferView": made.view(values, byteStride=values.strides[0]), "componentType": codes[kind],
         "count": 8, "type": "VEC3", "normalized": True}
    )  # fmt: skip
    made.mesh({"attributes": {"POSITION": 0}, "indices": made.add(CORNERS)})
    with pytest.raises(FormatError, match=r"accessors\[0\].*not read here"):
        read(made.binary(tmp_path))
    made.tree["extensionsUsed"] = made.tree["extensionsRequired"] = ["KHR_mesh_quantization"]
    assert np.array_equal(read(made.binary(tmp_path)).vertices, CUBE)


def test_whole_numbers_that_are_not_normalised_count_as_they_are(tmp_path):
    made = File()
    values = np.zeros((8, 4), dtype="<i2")
    values[:, :3] = np.array(CUBE) * 10 - 5
    view = made.view(values, byteStride=8)
    made.tree["accessors"].append({"bufferView": view, "componentType": 5122, "count": 8, "type": "VEC3"})
    made.mesh({"attributes": {"POSITION": 0}, "indices": made.add(CORNERS)})
    made.tree["extensionsUsed"] = ["KHR_mesh_quantization"]
    made.tree["nodes"][0]["scale"] = [0.1] * 3
    assert np.allclose(read(made.binary(tmp_path)).vertices, np.array(CUBE) - 0.5)


def test_sparse_accessors(tmp_path):
    made = File()
    flat = POINTS.copy()
    flat[4:, 2] = 0
    position = made.add(flat)
    made.tree["accessors"][position]["sparse"] = {
        "count": 4,
        "indices": {"bufferView": made.view(np.array([4, 5, 6, 7], dtype="<u1")), "componentType": 5121},
        "values": {"bufferView": made.view(POINTS[4:])},
    }
    made.mesh({"attributes": {"POSITION": position}, "indices": made.add(CORNERS)})
    assert volume(read(made.text(tmp_path))) == pytest.approx(1)
    del made.tree["accessors"][position]["bufferView"]  # the rest is zero
    assert np.count_nonzero(read(made.text(tmp_path)).vertices[:4]) == 0


def test_interleaved_rows(tmp_path):
    made = File()
    rows = np.concatenate([POINTS, POINTS - 0.5], axis=1).astype("<f4")
    view = made.view(rows, byteStride=24)
    made.tree["accessors"] += [
        {"bufferView": view, "byteOffset": at, "componentType": 5126, "count": 8, "type": "VEC3"} for at in (0, 12)
    ]
    made.mesh({"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": made.add(CORNERS)})
    found = read(made.binary(tmp_path))
    assert found.vertices.tolist() == CUBE
    assert np.allclose(found.normals, (np.array(CUBE) - 0.5) / np.sqrt(0.75))


@pytest.mark.parametrize("colours", [np.eye(8, 3), np.eye(8, 4), np.full((8, 3), 0.3)])
def test_colours_come_back(tmp_path, colours):
    made = Polyhedron.from_corners(CUBE, np.arange(13) * 3, np.array(TRIANGLES).ravel(), colors=colours)
    for name in ("a.glb", "a.gltf"):
        write(tmp_path / name, made)
        assert np.allclose(read(tmp_path / name).colors, colours, atol=1e-7)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.glb", "a.gltf"]  # no further file


def test_writing_says_what_is_lost(tmp_path):
    made = Polyhedron.from_corners(CUBE, np.arange(13) * 3, np.array(TRIANGLES).ravel(), face_colors=np.ones((12, 3)))
    with pytest.warns(UserWarning, match="colours of faces"):
        write(tmp_path / "a.glb", made)
    with pytest.raises(FormatError, match=r"face 0 has 4 corners.*triangulate"):
        write(tmp_path / "a.glb", Polyhedron.from_faces(CUBE, QUADS))
    for scale in (1e39, -1e39):
        with pytest.raises(FormatError, match="a coordinate is larger"):
            write(tmp_path / "a.glb", made.with_vertices(made.vertices * scale))


# ---- what is refused ------------------------------------------------------------------------------------------------


def changed(path: list, value):
    def change(made: File) -> None:
        at = made.tree
        for key in path[:-1]:
            at = at[key]
        at[path[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (changed(["extensionsRequired"], ["EXT_made_up"]), "EXT_made_up"),
        (changed(["extensionsRequired"], ["KHR_draco_mesh_compression"]), "KHR_draco_mesh_compression"),
        (changed(["extensionsRequired"], ["EXT_meshopt_compression"]), "EXT_meshopt_compression"),
        (changed(["extensionsRequired"], 3), "list of strings"),
        (changed(["asset", "version"], "1.0"), "version"),
        (changed(["asset", "version"], 2), "version"),
        (changed(["nodes", 0, "skin"], 0), "skin"),
        (changed(["nodes", 0, "extensions"], {"EXT_mesh_gpu_instancing": {}}), "EXT_mesh_gpu_instancing"),
        (changed(["nodes", 0, "children"], [0]), "part of itself"),
        (changed(["nodes", 0, "matrix"], [1] * 16), "affine"),
        (changed(["nodes", 0, "scale"], [1e300, 1]), "3 finite"),
        (changed(["nodes", 0, "scale"], [1, True, 1]), "finite"),
        (changed(["nodes", 0, "rotation"], [0, 0, 0, 0]), "length 0"),
        (changed(["nodes", 0, "mesh"], 1), "mesh"),
        (changed(["nodes", 0, "mesh"], True), "mesh"),
        (changed(["nodes", 0, "mesh"], -1), "mesh"),
        (changed(["scene"], 1), "scene"),
        (changed(["scenes", 0, "nodes"], [7]), "nodes"),
        (changed(["meshes", 0, "weights"], [1]), "weights"),
        (changed(["meshes", 0, "primitives", 0, "mode"], 7), "mode"),
        (changed(["meshes", 0, "primitives", 0, "indices"], 9), "indices"),
        (changed(["meshes", 0, "primitives", 0, "attributes"], {}), "no POSITION"),
        (changed(["accessors", 0, "count"], 9), "do not fit"),
        (changed(["accessors", 0, "count"], 10**15), "from 0 to|too often"),
        (changed(["accessors", 0, "count"], 8.0), "whole number"),
        (changed(["accessors", 0, "type"], "VEC2"), "VEC2"),
        (changed(["accessors", 0, "componentType"], 5130), "5130"),
        (changed(["accessors", 1, "componentType"], 5122), "not read here"),
        (changed(["accessors", 1, "count"], 35), "no triangles"),
        (changed(["accessors", 0, "bufferView"], 2), "view"),
        (changed(["accessors", 0, "byteOffset"], 4), "do not fit"),
        (changed(["bufferViews", 0, "byteStride"], 4), "overlap"),
        (changed(["bufferViews", 0, "byteOffset"], 1000), "not in the buffer"),
        (changed(["bufferViews", 0, "buffer"], 1), "buffer"),
        (changed(["bufferViews", 0, "extensions"], {"EXT_meshopt_compression": {}}), "EXT_meshopt_compression"),
        (changed(["meshes"], {}), "list of objects"),
        (changed(["meshes"], []), "mesh"),
    ],
)  # fmt: skip
def test_what_is_not_so_is_refused_with_its_place(tmp_path, change, said):
    made = cube()
    change(made)
    with pytest.raises(FormatError, match=rf"a\.glb.*{said}"):
        read(made.binary(tmp_path))


def test_a_compressed_primitive_is_refused_by_name(tmp_path):
    made = cube()
    made.tree["meshes"][0]["primitives"][0]["extensions"] = {"KHR_draco_mesh_compression": {}}
    assert read(made.text(tmp_path)).face_count == 12  # the plain numbers are there too
    del made.tree["accessors"][0]["bufferView"]
    with pytest.raises(FormatError, match="KHR_draco_mesh_compression"):
        read(made.text(tmp_path))


def test_a_mesh_that_is_repeated_too_often_is_refused_before_it_is_made(tmp_path):
    made = cube()
    made.tree["nodes"] = [{"children": list(range(1, 20_000))}, *({"mesh": 0} for _ in range(1, 20_000))]
    assert read(made.text(tmp_path)).face_count == 12 * 19_999  # in a file that is as large
    many, made = 3000, File()
    points = np.zeros((20_000, 3), dtype="<f4")
    made.tree["accessors"] = [
        {
            "componentType": 5126,
            "count": 20_000,
            "type": "VEC3",
            "sparse": {"count": 0, "indices": {"bufferView": 0, "componentType": 5121}, "values": {"bufferView": 0}},
        }
    ]
    made.view(points[:1])
    made.mesh({"attributes": {"POSITION": 0}, "mode": 6})
    made.tree["nodes"] = [{"children": list(range(1, many))}, *({"mesh": 0} for _ in range(1, many))]
    with pytest.raises(FormatError, match="too often"):
        read(made.text(tmp_path))


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"[]", "an object is required"),
        (b"[" * 100_000, "nested too deeply"),
        (b'{"scene": NaN}', "NaN"),
        (b'{"a": ' + b"9" * 5000 + b"}", "no glTF"),
        (b"\xff\xfe{}", "no glTF"),
        (b'{"meshes": [], "meshes": []}', "'meshes' stands twice"),
        (b'{"m\\u0065shes": [], "meshes": []}', "'meshes' stands twice"),
    ],
)
def test_the_text_is_parsed_once_and_strictly(tmp_path, content, said):
    path = tmp_path / "a.gltf"
    path.write_bytes(content)
    with pytest.raises(FormatError, match=rf"a\.gltf.*{said}"):
        read(path)


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (lambda b: b[:50], "byte 8.*cut short"),
        (lambda b: b[:4] + struct.pack("<I", 1) + b[8:], "version 1"),
        (lambda b: b[:12] + struct.pack("<I", 2**31) + b[16:], "byte 12"),
        (lambda b: b[:16] + b"XXXX" + b[20:], "byte 12"),
        (lambda b: b"this is no mesh", "starts with"),
        (lambda b: b"glTF", "20 bytes"),
    ],
)
def test_a_container_whose_sizes_do_not_fit_is_refused(tmp_path, damage, said):
    path = cube().binary(tmp_path)
    path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(FormatError, match=rf"a\.glb.*{said}"):
        read(path)


# ---- files beside it ------------------------------------------------------------------------------------------------


def beside(tmp_path, uri: str, content: bytes | None = None):
    made = cube()
    if content is not None:
        (tmp_path / "points.bin").write_bytes(content)
    return made.text(tmp_path, made.tree | {"buffers": [{"byteLength": len(made.data), "uri": uri}]})


def test_a_buffer_beside_the_file_is_read(tmp_path):
    assert read(beside(tmp_path, "points.bin", bytes(cube().data))).face_count == 12
    (tmp_path / "points.bin").rename(tmp_path / "my points.bin")
    assert read(beside(tmp_path, "my%20points.bin")).face_count == 12
    with pytest.raises(FormatError, match="cut short"):
        read(beside(tmp_path, "points.bin", bytes(cube().data)[:-1]))


@pytest.mark.parametrize(
    "uri",
    [
        "../secret.bin", "/etc/passwd", "%2e%2e/secret.bin", "..%2fsecret.bin", "..\\secret.bin", "sub/secret.bin",
        "file:///etc/passwd", "http://localhost/a.bin", ".hidden", "~root", "", "secret.key", "points.bin.txt",
        "a\0b.bin", "C:a.bin",
        "data:application/octet-stream,abc", "data:;base64,####",
    ],
)  # fmt: skip
def test_no_other_file_is_opened(tmp_path, uri):
    folder = tmp_path / "sub"
    folder.mkdir()
    for place in (tmp_path / "secret.bin", folder / ".hidden"):
        place.write_bytes(bytes(cube().data))
    with pytest.raises(FormatError, match=r"buffers\[0\]"):
        read(beside(folder, uri))


def test_neither_links_nor_pipes_nor_folders_are_buffers(tmp_path):
    (tmp_path / "secret").write_bytes(bytes(cube().data))
    (tmp_path / "link.bin").symlink_to(tmp_path / "secret")
    os.mkfifo(tmp_path / "pipe.bin")
    (tmp_path / "folder.bin").mkdir()
    for name in ("link.bin", "pipe.bin", "folder.bin", "missing.bin"):
        with pytest.raises(FormatError, match=r"buffers\[0\]"):
            read(beside(tmp_path, name))


def test_pictures_are_skipped_and_never_opened(tmp_path):
    made = cube()
    made.tree["images"] = [{"uri": "../secret.png"}]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert read(made.text(tmp_path)).face_count == 12
