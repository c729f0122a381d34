from __future__ import annotations

import io
import sys
from dataclasses import replace

import numpy as np
import pytest

from orbiframe.components.registry import Registry
from orbiframe.files import gate, places

REGISTRY = Registry.discover()


@pytest.fixture
def coloured(cube):
    """A cube with normals, colours of vertices and colours of faces."""
    mesh = gate.read(cube, REGISTRY)
    full = replace(
        mesh,
        normals=mesh.vertices - 0.5,
        colors=np.full((8, 4), 0.2),
        face_colors=np.full((6, 3), 0.4),
    )
    path = cube.with_name("coloured.ply")
    gate.write(path, full, REGISTRY)
    return path


@pytest.fixture
def piped(orbiframe, monkeypatch):
    """Run the command line with bytes as the standard input; returns what it ran to, and the bytes that come out."""

    def run(data, *arguments):
        with monkeypatch.context() as patch:
            patch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data)))
            out = io.BytesIO()
            patch.setattr(sys, "stdout", io.TextIOWrapper(out, write_through=True))
            status = orbiframe_status(*arguments)
            return status, out.getvalue()

    def orbiframe_status(*arguments):
        from orbiframe.cli.main import main

        return main([str(argument) for argument in arguments])

    return run


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_there_and_back(orbiframe, cube, tmp_path):
    assert orbiframe("convert", cube, tmp_path / "cube.obj") == (0, "", "")
    assert orbiframe("convert", tmp_path / "cube.obj", tmp_path / "again.off").status == 0
    assert orbiframe("info", tmp_path / "again.off").out == orbiframe("info", cube).out


def test_formats_may_be_named(orbiframe, cube, tmp_path):
    plain = cube.rename(tmp_path / "mesh.txt")
    assert orbiframe("convert", plain, tmp_path / "out.txt", "-i", "off", "-o", "obj").status == 0
    assert "v 0 0 0" in (tmp_path / "out.txt").read_text().replace(".0", "")
    assert names(tmp_path) == ["mesh.txt", "out.txt"]


def test_a_format_of_a_library_may_be_named_by_its_suffix(orbiframe, cube, tmp_path):
    out = tmp_path / "out.txt"
    assert orbiframe("convert", cube, out, "-o", "vtk").status == 0
    assert out.read_bytes().startswith(b"# vtk")
    assert orbiframe("info", out, "-i", ".vtk").out == orbiframe("info", cube).out
    out.write_text("# vtk nonsense\n")
    assert str(out) in orbiframe("info", out, "-i", "vtk").err
    assert names(tmp_path) == ["cube.off", "out.txt"]


def test_a_link_is_written_through(orbiframe, cube, tmp_path):
    link = tmp_path / "link.txt"
    link.symlink_to(tmp_path / "behind.txt")
    assert orbiframe("convert", cube, link, "-o", "ply").status == 0
    assert link.is_symlink()
    assert (tmp_path / "behind.txt").read_bytes().startswith(b"ply")


@pytest.mark.parametrize(
    ("output", "status", "said"),
    [
        ("out.offf", 1, "'.offf'"),
        ("absent/out.obj", 1, "there is no folder"),
        ("cube.off", 2, "the input itself"),
        ("", 1, "folder"),
    ],
)
def test_a_bad_destination_is_said_and_nothing_written(orbiframe, cube, tmp_path, output, status, said):
    before = cube.read_bytes()
    ran = orbiframe("convert", cube, tmp_path / output)
    assert ran.status == status
    assert said in ran.err
    assert names(tmp_path) == ["cube.off"]
    assert cube.read_bytes() == before


@pytest.mark.parametrize("arguments", [["a.off"], ["a.off", "b.off", "c.off"], ["a.off", "b.off", "--into", "d"]])
def test_a_wrong_number_of_files_is_a_wrong_use(orbiframe, arguments):
    ran = orbiframe("convert", *arguments)
    assert ran.status == 2
    assert "--to" in ran.err


# ---- losses ---------------------------------------------------------------------------------------------------------


def test_normals_and_colours_are_kept_as_far_as_the_format_has_them(orbiframe, coloured, tmp_path):
    full = gate.read(coloured, REGISTRY)
    ran = orbiframe("convert", coloured, tmp_path / "out.off", "--strict")
    assert (ran.status, ran.err) == (0, "")
    found = gate.read(tmp_path / "out.off", REGISTRY)
    for table in ("vertices", "tail", "normals", "colors", "face_colors"):
        np.testing.assert_array_equal(getattr(found, table), getattr(full, table))


def test_each_loss_is_a_warning(orbiframe, coloured, tmp_path):
    ran = orbiframe("convert", coloured, tmp_path / "out.stl", "--triangulate")
    assert ran.status == 0
    warned = [line for line in ran.err.splitlines() if line.startswith("orbiframe: warning: out.stl: ")]
    assert [word in line for word, line in zip(("colours", "normals"), warned, strict=True)] == [True, True]


@pytest.mark.parametrize("target", ["out.stl", "out.obj"])
def test_a_loss_is_an_error_for_the_strict(orbiframe, coloured, tmp_path, target):
    (tmp_path / target).write_text("before")
    ran = orbiframe("convert", coloured, tmp_path / target, "--triangulate", "--strict")
    assert ran.status == 1
    assert f"{target}: " in ran.err
    assert "--strict" in ran.err
    assert (tmp_path / target).read_text() == "before"


def test_a_loss_in_reading_is_an_error_for_the_strict(orbiframe, cube, tmp_path):
    cube.write_text(cube.read_text() + "4 0 1 3 2\n")
    assert orbiframe("convert", cube, tmp_path / "out.ply").err.startswith("orbiframe: warning: ")
    (tmp_path / "out.ply").unlink()
    ran = orbiframe("convert", cube, tmp_path / "out.ply", "--strict")
    assert (ran.status, names(tmp_path)) == (1, ["cube.off"])


# ---- options of readers and writers ---------------------------------------------------------------------------------


def test_text_or_binary_may_be_chosen(orbiframe, cube, tmp_path):
    for number, option in enumerate([[], ["--ascii"], ["--set", "writer.ascii=true"]]):
        assert orbiframe("convert", cube, tmp_path / f"{number}.ply", *option).status == 0
    starts = [(tmp_path / f"{number}.ply").read_bytes().split(b"\n")[1] for number in range(3)]
    assert starts == [b"format binary_little_endian 1.0", b"format ascii 1.0", b"format ascii 1.0"]


@pytest.mark.parametrize(
    ("option", "said"),
    [("writer.asci=true", "ascii"), ("writer.ascii=2", "writer.ascii"), ("fitter.x=1", "reader, writer"), ("x", "KEY")],
)
def test_a_wrong_option_is_said(orbiframe, cube, tmp_path, option, said):
    ran = orbiframe("convert", cube, tmp_path / "out.ply", "--set", option)
    assert ran.status == 2
    assert said in ran.err
    assert names(tmp_path) == ["cube.off"]


# ---- streams --------------------------------------------------------------------------------------------------------


def test_from_stream_to_stream(piped, cube):
    status, ply = piped(cube.read_bytes(), "convert", "-", "-", "-i", "off", "-o", "ply")
    assert (status, ply[:4]) == (0, b"ply\n")
    status, off = piped(ply, "convert", "-", "-", "-i", "ply", "-o", "off")
    assert status == 0
    numbers = [[float(word) for word in text.split()[4:]] for text in (off, cube.read_bytes())]
    assert numbers[0] == numbers[1]


def test_streams_need_a_format_and_one_file(piped, cube, tmp_path, capsys):
    data = cube.read_bytes()
    for arguments, status in (
        (["-", tmp_path / "out.ply"], 2),
        (["-", tmp_path / "out.ply", "-i", "meshio"], 2),
        ([cube, "-"], 2),
        (["-", "--to", "ply", "-i", "off"], 2),
        (["-", tmp_path / "out.ply", "-i", "ply"], 1),
    ):
        assert piped(data, "convert", *arguments) == (status, b"")
        assert capsys.readouterr().err.startswith("orbiframe: ")
    assert names(tmp_path) == ["cube.off"]


def test_what_cannot_be_written_sends_nothing(piped, cube, capsys):
    assert piped(cube.read_bytes(), "convert", "-", "-", "-i", "off", "-o", "stl") == (1, b"")
    assert capsys.readouterr().err.startswith("orbiframe: stdout")


def test_a_format_of_several_files_cannot_be_streamed(piped, cube, monkeypatch, capsys):
    def two_files(path, polyhedron):
        path.write_bytes(b"mesh")
        path.with_suffix(".bin").write_bytes(b"points")

    load = Registry.load
    monkeypatch.setattr(Registry, "load", lambda r, kind, name: two_files if kind == "writer" else load(r, kind, name))
    assert piped(b"", "convert", cube, "-", "-o", "off") == (1, b"")
    assert "stdout.bin" in capsys.readouterr().err


def test_a_stream_has_a_limit(piped, cube, monkeypatch, capsys):
    monkeypatch.setattr(places, "SIZE_LIMIT", 10)
    assert piped(cube.read_bytes(), "convert", "-", "-", "-i", "off", "-o", "off") == (1, b"")
    assert "stdin: there are more bytes than the limit of 10" in capsys.readouterr().err


# ---- many files -----------------------------------------------------------------------------------------------------


def test_many_files_go_on_after_a_bad_one(orbiframe, cube, tmp_path):
    (tmp_path / "bad.off").write_text("OFF\n1 1 1\n")
    (tmp_path / "second.off").write_bytes(cube.read_bytes())
    files = [tmp_path / name for name in ("cube.off", "bad.off", "absent.off", "second.off")]
    ran = orbiframe("convert", *files, "--to", "ply", "--into", tmp_path / "out")
    assert (ran.status, ran.out) == (1, "2 of 4 files converted\n")
    assert [word in line for word, line in zip(("bad.off", "absent.off"), ran.err.splitlines(), strict=True)] == [
        True
    ] * 2
    assert names(tmp_path / "out") == ["cube.ply", "second.ply"]


def test_many_files_into_their_own_folders(orbiframe, cube, tmp_path):
    inner = tmp_path / "inner"
    inner.mkdir()
    (inner / "cube.off").write_bytes(cube.read_bytes())
    ran = orbiframe("convert", cube, inner / "cube.off", "--to", ".PLY", "--orient")
    assert (ran.status, ran.out) == (0, "2 of 2 files converted\n")
    assert [line.split(": ")[1] for line in ran.err.splitlines()] == [str(cube), str(inner / "cube.off")]
    assert (names(tmp_path), names(inner)) == (["cube.PLY", "cube.off", "inner"], ["cube.PLY", "cube.off"])


def test_many_files_never_meet(orbiframe, cube, tmp_path):
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "cube.off").write_bytes(cube.read_bytes())
    (tmp_path / "cube.ply").write_bytes(b"ply")
    both = orbiframe("convert", cube, tmp_path / "inner" / "cube.off", "--to", "ply", "--into", tmp_path / "out")
    assert (both.status, both.out) == (2, "")
    assert "2 of the files would become" in both.err
    own = orbiframe("convert", cube, "--to", "off")
    assert (own.status, "the input itself" in own.err) == (2, True)
    other = orbiframe("convert", cube, tmp_path / "cube.ply", "--to", "ply")
    assert other.status == 2
    assert names(tmp_path) == ["cube.off", "cube.ply", "inner"]


def test_a_wrong_suffix_or_folder_is_said_before_the_work(orbiframe, cube, tmp_path):
    assert "'.plyy'" in orbiframe("convert", cube, "--to", "plyy").err
    ran = orbiframe("convert", cube, "--to", "ply", "--into", tmp_path / "absent" / "out")
    assert (ran.status, "cannot be made" in ran.err) == (1, True)
    assert names(tmp_path) == ["cube.off"]
