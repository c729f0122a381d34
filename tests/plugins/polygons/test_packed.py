from __future__ import annotations

import gzip
import io
import zipfile

import numpy as np
import pytest
from orbiframe_polygons.packed_reader import read_gz, read_zip
from small_meshes import CUBE, QUADS, lists

from orbiframe import FormatError, Polyhedron, Registry
from orbiframe.files import gate

REGISTRY = Registry.discover()
MADE = Polyhedron.from_faces(np.array(CUBE, float), QUADS)
SUFFIXES = [
    ".off",
    ".obj",
    ".ply",
    ".vtk",
    ".vtp",
    ".vtu",
    ".msh",
    ".mesh",
    ".inp",
    ".nas",
    ".dat",
    ".xdmf",
    ".avs",
    ".vol",
]


def content(tmp_path, suffix: str = ".off") -> bytes:
    gate.write(tmp_path / f"mesh{suffix}", MADE, REGISTRY)
    return (tmp_path / f"mesh{suffix}").read_bytes()


def zipped(tmp_path, files: dict[str, bytes]):
    path = tmp_path / "a.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return path


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_text_format_is_read_from_gz_and_zip(tmp_path, suffix):
    data = content(tmp_path, suffix)
    (tmp_path / f"packed{suffix}.gz").write_bytes(gzip.compress(data))
    assert lists(gate.read(tmp_path / f"packed{suffix}.gz", REGISTRY)) == QUADS
    assert lists(gate.read(zipped(tmp_path, {f"folder/mesh{suffix.upper()}": data}), REGISTRY)) == QUADS


def test_streams_one_after_the_other_are_one_file(tmp_path):
    data = content(tmp_path)
    path = tmp_path / "a.off.gz"
    path.write_bytes(gzip.compress(data[:40]) + gzip.compress(data[40:]))
    assert lists(read_gz(path)) == QUADS


def test_what_is_no_mesh_is_passed_over(tmp_path):
    files = {"readme.txt": b"hello", "folder/": b"", "__MACOSX/mesh.off": b"x", "a/b/mesh.off": content(tmp_path)}
    assert lists(read_zip(zipped(tmp_path, files))) == QUADS


def test_paths_in_an_archive_lead_nowhere(tmp_path):
    folder = tmp_path / "inner"
    folder.mkdir()
    before = sorted(p.name for p in tmp_path.iterdir())
    assert lists(read_zip(zipped(folder, {"../../mesh.off": content(folder)}))) == QUADS
    assert sorted(p.name for p in tmp_path.iterdir()) == before


def test_degenerate_faces_are_left_to_the_gate(tmp_path):
    path = tmp_path / "a.off.gz"
    path.write_bytes(gzip.compress(b"OFF 3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 1\n"))
    assert gate.read(path, REGISTRY, degenerate=True).face_count == 2
    with pytest.raises(FormatError, match=r"a\.off\.gz: face 1"):
        gate.read(path, REGISTRY)


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("a.off.gz", lambda: b"this is no gzip", "no sound gzip"),
        ("a.off.gz", lambda: gzip.compress(b"OFF 0 0 0\n" * 99)[:-20], "no sound gzip|cut short"),
        ("a.off.gz", lambda: gzip.compress(b"OFF")[:-4] + b"xxxx", "no sound gzip"),
        ("a.off.gz", lambda: gzip.compress(bytes(200_000_000)), "swells"),
        ("a.off.gz", lambda: gzip.compress(b"OFF 1 1 1\n"), "a.off.gz, line 1"),
        ("a.tar.gz", lambda: gzip.compress(b"OFF 1 1 1\n"), "suffix '.tar'"),
        ("a.off.gz.gz", lambda: gzip.compress(gzip.compress(b"OFF")), "inside another"),
        ("a.gz", lambda: gzip.compress(b"OFF"), "no suffix"),
        ("a.zip", lambda: b"this is no archive", "no sound archive"),
        ("a.zip", lambda: b"PK\x03\x04" + bytes(99), "no sound archive"),
    ],
)
def test_what_is_not_so_is_refused(tmp_path, name, data, said):
    path = tmp_path / name
    path.write_bytes(data())
    with pytest.raises(FormatError, match=rf"{name}.*({said})|{said}"):
        gate.read(path, REGISTRY)


def test_several_meshes_or_none_are_refused(tmp_path):
    data = content(tmp_path)
    with pytest.raises(FormatError, match=r"a\.zip: the archive holds 2 meshes.*a\.off, b\.ply"):
        read_zip(zipped(tmp_path, {"a.off": data, "b.ply": data}))
    with pytest.raises(FormatError, match=r"holds 0 meshes.*inner\.zip"):
        read_zip(zipped(tmp_path, {"inner.zip": data}))


def test_a_bomb_in_an_archive_is_refused(tmp_path):
    with pytest.raises(FormatError, match="swells"):
        read_zip(zipped(tmp_path, {"a.off": bytes(100_000_000)}))


def test_an_archive_with_a_password_is_refused(tmp_path):
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w") as archive:
        archive.writestr("a.off", content(tmp_path))
    data = bytearray(memory.getvalue())
    for mark, at in ((b"PK\3\4", 6), (b"PK\1\2", 8)):
        data[data.index(mark) + at] |= 1
    (tmp_path / "a.zip").write_bytes(data)
    with pytest.raises(FormatError, match=r"a\.zip: this is no sound archive"):
        read_zip(tmp_path / "a.zip")
