from __future__ import annotations

import pytest


def test_there_and_back(orbiframe, cube, tmp_path):
    assert orbiframe("convert", cube, tmp_path / "cube.obj") == (0, "", "")
    assert orbiframe("convert", tmp_path / "cube.obj", tmp_path / "again.off").status == 0
    assert orbiframe("info", tmp_path / "again.off").out == orbiframe("info", cube).out


def test_formats_may_be_named(orbiframe, cube, tmp_path):
    plain = cube.rename(tmp_path / "mesh.txt")
    assert orbiframe("convert", plain, tmp_path / "out.txt", "-i", "off", "-o", "obj").status == 0
    assert "v 0 0 0" in (tmp_path / "out.txt").read_text().replace(".0", "")


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
    assert [path.name for path in tmp_path.iterdir()] == ["cube.off"]
    assert cube.read_bytes() == before


def test_what_the_format_cannot_hold_is_a_warning(orbiframe, cube, tmp_path):
    ran = orbiframe("convert", cube, tmp_path / "cube.stl")
    assert ran.status in (0, 1)
    assert ran.err.startswith("orbiframe: ")
