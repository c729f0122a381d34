from __future__ import annotations

import importlib.util
import json
import struct
import subprocess
import sys

import numpy as np
import pytest
from orbiframe_open3d.links import require_own_files
from orbiframe_open3d.plugin import SUFFIXES
from orbiframe_open3d.reader import read
from orbiframe_open3d.writer import write

from orbiframe import FormatError, PluginError, Polyhedron

TETRAHEDRON = Polyhedron.from_faces(np.eye(4)[:, :3], [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])


@pytest.fixture(scope="module")
def obstacle() -> str | None:
    """Why Open3D cannot be used here: asked in a process of its own, since it may take the process with it."""
    if importlib.util.find_spec("open3d") is None:
        return "open3d is not installed"
    tried = subprocess.run([sys.executable, "-c", "import open3d"], capture_output=True, text=True, check=False)
    return None if tried.returncode == 0 else f"open3d does not load: {tried.stderr.strip().splitlines()[-1]}"


@pytest.fixture
def open3d(obstacle) -> None:
    """Skips where Open3D cannot be used."""
    if obstacle is not None:
        pytest.skip(obstacle)


needs_open3d = pytest.mark.usefixtures("open3d")


@needs_open3d
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_triangles_survive_in_every_declared_format(tmp_path, suffix):
    write(tmp_path / f"a{suffix}", TETRAHEDRON)
    found = read(tmp_path / f"a{suffix}")
    assert len(found.vertices) == 4
    assert np.array_equal(found.vertices[found.tail], TETRAHEDRON.vertices[TETRAHEDRON.tail])


@needs_open3d
def test_what_is_no_mesh_is_refused(tmp_path):
    (tmp_path / "a.glb").write_bytes(b"this is no mesh")
    with pytest.raises(FormatError, match=r"a\.glb"):
        read(tmp_path / "a.glb")


@needs_open3d
def test_a_ply_that_crashes_open3d_is_an_error(tmp_path):
    path = tmp_path / "a.ply"
    path.write_bytes(b"ply\nformat ascii 1.0\ncomment " + b"x" * 5_000_000 + b"\nend_header\n")
    with pytest.raises(FormatError, match=r"a\.ply"):
        read(path)


def test_where_open3d_is_missing_the_error_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "open3d", None)
    monkeypatch.delitem(sys.modules, "orbiframe_open3d.triangles", raising=False)
    triangles = importlib.import_module("orbiframe_open3d.triangles")
    monkeypatch.delitem(sys.modules, "orbiframe_open3d.triangles")
    (tmp_path / "a.fbx").write_bytes(b"")
    with pytest.raises(PluginError, match="install"):
        triangles.polyhedron_of(tmp_path / "a.fbx")


def test_larger_faces_are_refused(tmp_path):
    with pytest.raises(FormatError, match=r"face 0 has 4 corners.*triangulate"):
        write(tmp_path / "a.glb", Polyhedron.from_faces(np.eye(4)[:, :3], [[0, 1, 2, 3]]))


def glb(tree, *, version=2, size=None, length=None) -> bytes:
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    length = len(text) if length is None else length
    return struct.pack("<4sIIII", b"glTF", version, 20 + len(text) if size is None else size, length, 0x4E4F534A) + text


def raw_glb(text: bytes) -> bytes:
    """A binary glTF of this JSON, which may hold what no dictionary can."""
    return struct.pack("<4sIIII", b"glTF", 2, 20 + len(text), len(text), 0x4E4F534A) + text


OUTSIDE = {"asset": {"version": "2.0"}, "buffers": [{"uri": "../points.bin", "byteLength": 4}]}


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.glb", glb(OUTSIDE), "not opened"),
        ("a.glb", glb({"images": [{"uri": "/etc/passwd"}]}), "not opened"),
        ("a.glb", glb({"images": [{"uri": "beside.png"}]}), "not opened"),
        ("a.gltf", b'{"images": [{"uri": "beside.png"}]}', "leave the format away"),
        ("a.glb", raw_glb(b'{"buffers": [{"uri": "../a.bin", "uri": "data:,"}]}'), "stands twice"),
        ("a.glb", glb({}, size=2**32 - 1), "byte 8.*cut short"),
        ("a.glb", glb({}, length=2**32 - 16), "byte 12"),
        ("a.glb", glb({}, version=9), "byte 4"),
        ("a.glb", b"glTF", "starts with"),
        ("a.glb", b"this is no mesh at all", "starts with"),
        ("a.glb", raw_glb(b"[" * 100_000), "no glTF"),
        ("a.glb", raw_glb(b"[]"), "no glTF"),
        ("a.fbx", b"Kaydara FBX Binary  \0" + b"RelativeFilename" + b"../../secret.png", "names pictures"),
    ],
)
def test_files_that_name_others_or_lie_of_their_size_never_reach_open3d(tmp_path, name, content, said):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(FormatError, match=rf"{name}.*{said}"):
        require_own_files(path)
