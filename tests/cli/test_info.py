from __future__ import annotations

import json

import pytest

from orbiframe.cli.info import description, text
from orbiframe.testing.polyhedra import reference_polyhedra


def test_a_cube(orbiframe, cube):
    ran = orbiframe("info", cube)
    assert ran.status == 0
    assert ran.out.splitlines() == [
        "closed, orientable, genus 0, 1 component",
        "8 vertices, 12 edges, 6 faces (6 of 4 corners)",
        "Euler characteristic 2",
    ]


def test_json_has_the_promised_keys(orbiframe, cube):
    ran = orbiframe("info", cube, "--json")
    assert json.loads(ran.out) == {
        "file": str(cube),
        "vertices": 8,
        "edges": 12,
        "faces": 6,
        "face_sizes": {"4": 6},
        "components": 1,
        "closed": True,
        "orientable": True,
        "euler_characteristic": 2,
        "genus": 0,
        "defects": [],
    }


@pytest.mark.parametrize(
    ("name", "first"),
    [
        ("torus", "closed, orientable, genus 1, 1 component"),
        ("projective plane", "closed, nonorientable, 1 crosscap, 1 component"),
        ("prism", "closed, orientable, genus 0, 1 component"),
    ],
)
def test_the_first_line_names_the_surface(name, first):
    assert text(description(reference_polyhedra()[name])).splitlines()[0] == first


def test_the_sizes_of_faces_are_counted():
    assert description(reference_polyhedra()["prism"])["face_sizes"] == {"4": 5, "5": 2}


def test_a_hole_is_a_defect_and_no_error(orbiframe, cube):
    lines = cube.read_text().splitlines()
    cube.write_text("\n".join([lines[0], "8 5 12", *lines[2:-1]]) + "\n")
    ran = orbiframe("info", cube)
    assert ran.status == 0
    assert ran.out.startswith("not closed, orientable, 1 component\n")
    assert "defect: 4 open edges: 1 boundary loop of 4 edges" in ran.out


def test_several_files_and_one_that_cannot_be_read(orbiframe, cube, tmp_path):
    bad = tmp_path / "bad.off"
    bad.write_text("OFF\n1 1 1\nnothing\n")
    ran = orbiframe("info", bad, cube, tmp_path / "absent.off")
    assert ran.status == 1
    assert ran.out.startswith(f"{cube}: closed, orientable, genus 0, 1 component\n")
    assert [line.startswith("orbiframe: ") for line in ran.err.splitlines()] == [True, True]
    assert "bad.off" in ran.err
    assert "absent.off" in ran.err


def test_the_format_may_be_named(orbiframe, cube):
    plain = cube.rename(cube.with_suffix(".txt"))
    assert orbiframe("info", plain).status == 1
    assert orbiframe("info", plain, "-i", "off").status == 0
    ran = orbiframe("info", plain, "-i", "ofv")
    assert ran.status == 2
    assert "Did you mean 'off'?" in ran.err
