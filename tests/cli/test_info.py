from __future__ import annotations

import io
import json
import sys

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from orbiframe.cli.description import description, lines
from orbiframe.cli.report import plain
from orbiframe.meshes.orientation import reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.polyhedra import reference_polyhedra

CUBE_LINES = [
    "closed, orientable, genus 0, 1 component",
    "8 vertices, 12 edges, 6 faces (6 of 4 corners)",
    "Euler characteristic 2",
    "box 1 x 1 x 1, from (0, 0, 0) to (1, 1, 1)",
    "area 6, volume 1",
    "edge lengths 1 to 1, median 1; valences 3 to 3, median 3",
]


def with_line(path, number, text):
    """Replace one line of a file; None leaves it out."""
    rows = path.read_text().splitlines()
    rows[number : number + 1] = [] if text is None else [text]
    path.write_text("\n".join(rows) + "\n")


def test_a_cube(orbiframe, cube):
    ran = orbiframe("info", cube)
    assert ran.status == 0
    assert ran.out.splitlines() == CUBE_LINES


def test_json_has_the_promised_keys(orbiframe, cube):
    ran = orbiframe("info", cube, "--json")
    assert json.loads(ran.out) == {
        "file": str(cube),
        "surface": "closed, orientable, genus 0, 1 component",
        "vertices": 8,
        "edges": 12,
        "faces": 6,
        "face_sizes": {"4": 6},
        "components": 1,
        "closed": True,
        "orientable": True,
        "euler_characteristic": 2,
        "boundary": None,
        "genus": 0,
        "unit": None,
        "box": [[0, 0, 0], [1, 1, 1]],
        "area": 6,
        "volume": 1,
        "edge_lengths": {"min": 1, "median": 1, "max": 1},
        "valences": {"min": 3, "median": 3, "max": 3},
        "defects": [],
        "notes": [],
    }


@pytest.mark.parametrize(("suffix", "unit"), [(".3mf", "millimetre"), (".glb", "metre"), (".stl", None)])
def test_the_unit_of_a_format_is_a_line_and_a_key(orbiframe, cube, suffix, unit):
    made = cube.with_suffix(suffix)
    assert orbiframe("convert", cube, made, "--triangulate").status == 0
    told = [line for line in orbiframe("info", made).out.splitlines() if line.startswith("unit")]
    assert told == ([f"unit {unit}"] if unit else [])
    assert json.loads(orbiframe("info", made, "--json").out)["unit"] == unit


@pytest.mark.parametrize("options", [(), ("--orient",), ("--weld", "1e-9"), ("--drop-degenerate",)])
def test_a_length_stays_what_it_is_from_metres_to_millimetres_and_back(orbiframe, cube, options):
    metres, millimetres = cube.with_suffix(".glb"), cube.with_suffix(".3mf")
    assert orbiframe("convert", cube, metres, "--triangulate").status == 0
    ran = orbiframe("convert", metres, millimetres, "--strict", *options)
    assert ran.status == 0
    assert "converted from metres to millimetres (times 1000)" in ran.err
    assert "box 1000 x 1000 x 1000" in orbiframe("info", millimetres).out
    again = cube.with_name("again.glb")
    assert "(times 0.001)" in orbiframe("convert", millimetres, again, *options).err
    assert "box 1 x 1 x 1" in orbiframe("info", again).out


@pytest.mark.parametrize(
    ("name", "first"),
    [
        ("torus", "closed, orientable, genus 1, 1 component"),
        ("projective plane", "closed, nonorientable, 1 crosscap, 1 component"),
        ("prism", "closed, orientable, genus 0, 1 component"),
    ],
)
def test_the_first_line_names_the_surface(name, first):
    assert next(lines(description(reference_polyhedra()[name]))) == first


def test_the_sizes_of_faces_are_counted():
    assert description(reference_polyhedra()["prism"])["face_sizes"] == {"4": 5, "5": 2}


def test_no_volume_without_an_inside_and_a_hint_where_faces_look_inward():
    cube = reference_polyhedra()["cube"]
    inward = reversed_faces(cube, np.ones(6, dtype=bool))
    assert "area 6, volume -1 (faces look inward; --orient helps)" in list(lines(description(inward)))
    assert description(reference_polyhedra()["Klein bottle"])["volume"] is None
    assert "volume" not in "\n".join(lines(description(reference_polyhedra()["Klein bottle"])))


def test_a_hole_is_a_defect_and_no_error(orbiframe, cube):
    with_line(cube, 1, "8 5 12")
    with_line(cube, -1, None)
    ran = orbiframe("info", cube)
    assert ran.status == 0
    assert ran.out.startswith("not closed, orientable, 1 component\n")
    assert "defect: 4 open edges: 1 boundary loop of 4 edges" in ran.out


def test_degenerate_faces_are_described_with_the_option_that_helps(orbiframe, cube):
    with_line(cube, 1, "8 7 12")
    cube.write_text(cube.read_text() + "4 0 1 0 1\n")
    ran = orbiframe("info", cube)
    assert ran.status == 0
    assert "defect: 1 face with a repeated vertex: faces 6; --drop-degenerate helps" in ran.out


def test_an_unwelded_mesh_is_told_from_one_with_holes(orbiframe, cube, tmp_path):
    mesh = reference_polyhedra()["cube"]
    apart = Polyhedron.from_corners(mesh.vertices[mesh.tail], mesh.offsets, np.arange(len(mesh.tail)))
    said = "\n".join(lines(description(apart)))
    assert "defect: 24 open edges: 6 boundary loops" in said
    assert "a weld closes 24 open edges; --weld 0 helps" in said
    assert "--component" not in said


def test_several_files_make_a_table(orbiframe, cube, tmp_path):
    bad = tmp_path / "bad.off"
    bad.write_text("OFF\n1 1 1\nnothing\n")
    ran = orbiframe("info", bad, cube, tmp_path / "absent.off")
    assert (ran.status, ran.err) == (1, "")
    head, *rows = ran.out.splitlines()
    assert head.split() == ["file", "vertices", "edges", "faces", "surface", "defects"]
    assert rows[0].startswith(f"{bad}")
    assert "error: line 2" in rows[0]
    assert rows[1].split(maxsplit=4) == [
        str(cube),
        "8",
        "12",
        "6",
        "closed, orientable, genus 0, 1 component  none",
    ]
    assert "no such file" in rows[2]


def test_json_of_several_files_has_a_line_for_each(orbiframe, cube, tmp_path):
    ran = orbiframe("info", cube, tmp_path / "absent.off", cube, "--json")
    found = [json.loads(line) for line in ran.out.splitlines()]
    assert (ran.status, len(found)) == (1, 3)
    assert set(found[1]) == {"file", "error"}
    assert found[0] == found[2]


def test_one_bad_file_is_an_error(orbiframe, tmp_path):
    ran = orbiframe("info", tmp_path / "absent.off")
    assert (ran.status, ran.out) == (1, "")
    assert ran.err.startswith("orbiframe: ")


def test_the_format_may_be_named(orbiframe, cube):
    plain_name = cube.rename(cube.with_suffix(".txt"))
    assert orbiframe("info", plain_name).status == 1
    assert orbiframe("info", plain_name, "-i", "off").status == 0
    ran = orbiframe("info", plain_name, "-i", "ofv")
    assert ran.status == 2
    assert "Did you mean 'off'?" in ran.err


def test_a_mesh_from_the_standard_input(orbiframe, cube, monkeypatch):
    def piped(*arguments):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(cube.read_bytes())))
        return orbiframe("info", "-", *arguments)

    assert piped("-i", "off").out.splitlines() == CUBE_LINES
    unnamed = piped()
    assert (unnamed.status, "add -i" in unnamed.err) == (2, True)
    with_line(cube, 2, "0 0 x")
    assert "stdin, line 3" in piped("-i", "off").err


@settings(max_examples=60, deadline=None)
@given(st.lists(st.lists(st.integers(0, 5), min_size=3, max_size=5), min_size=1, max_size=6))
def test_any_mesh_that_is_read_is_described(faces):
    mesh = Polyhedron.from_faces(np.random.default_rng(0).integers(0, 3, (6, 3)) / 2, faces)
    found = description(mesh)
    assert json.loads(json.dumps(plain(found), allow_nan=False))["surface"] == next(lines(found))


@pytest.mark.parametrize("scale", [1e-300, 1e-150, 1e150, 1e300])
def test_extreme_sizes_are_described(scale):
    mesh = reference_polyhedra()["prism"]
    found = description(mesh.with_vertices(mesh.vertices * scale))
    assert [note["kind"] for note in found["notes"]] == ["extreme coordinates"]
    assert found["edge_lengths"]["median"] == pytest.approx(scale * description(mesh)["edge_lengths"]["median"])
    assert found["defects"] == []
    json.dumps(plain(found), allow_nan=False)


def test_what_welding_did_is_noted(orbiframe, cube, tmp_path):
    assert orbiframe("convert", cube, tmp_path / "cube.stl", "--triangulate").status == 0
    note = "note: welded: the 36 corners in the file became 8 vertices"
    assert note in orbiframe("info", tmp_path / "cube.stl").out.splitlines()
    (tmp_path / "cube.stl").rename(tmp_path / "cube.txt")
    assert note in orbiframe("info", tmp_path / "cube.txt", "-i", "stl").out.splitlines()
    ran = orbiframe("info", tmp_path / "cube.txt", "-i", "stl", "--json")
    assert json.loads(ran.out)["notes"][0]["count"] == 28


def test_a_link_that_leads_nowhere_is_called_one(orbiframe, tmp_path):
    (tmp_path / "link.off").symlink_to("gone.off")
    assert "this is a link to gone.off, which is not there" in orbiframe("info", tmp_path / "link.off").err
