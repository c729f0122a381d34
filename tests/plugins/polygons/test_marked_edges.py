"""Edges marked as sharp: from files and back, through all that changes the numbers of vertices, and as creases."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fitted import DATASETS, REGISTRY
from hypothesis import given, settings, strategies as st

from orbiframe.errors import ConfigError, FormatError
from orbiframe.files import gate
from orbiframe.fitting import pipeline
from orbiframe.fitting.config import Config
from orbiframe.meshes.bending import sharp_edges
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.marked_edges import MarkedEdges
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.submesh import submesh
from orbiframe.meshes.surface_type import without_unused_vertices

FORMATS = [("mesh.obj", {}), ("mesh.ply", {}), ("mesh.ply", {"ascii": True}), ("mesh.ply", {"big_endian": True})]


def marked_cube() -> Polyhedron:
    """A cube with all its edges marked."""
    cube = gate.read(DATASETS / "cube.off", REGISTRY)
    edges = np.flatnonzero(cube.representative)
    ends = np.stack([cube.tail[edges], cube.head[edges]], axis=1)
    return replace(cube, marked=MarkedEdges(ends, np.linspace(0.1, 10, len(ends))))


@pytest.mark.parametrize(("name", "options"), FORMATS, ids=lambda value: str(value))
@settings(max_examples=10, deadline=None)
@given(sharpness=st.lists(st.floats(1e-300, 1e300), min_size=1, max_size=12), data=st.data())
def test_marks_come_back_to_the_last_bit(tmp_path_factory, name: str, options, sharpness, data) -> None:  # type: ignore[no-untyped-def]
    cube, path = marked_cube(), tmp_path_factory.mktemp("marks") / name
    chosen = data.draw(st.permutations(range(12)))[: len(sharpness)]
    given_marks = MarkedEdges(cube.marked.ends[chosen], np.array(sharpness))
    gate.write(path, replace(cube, marked=given_marks), REGISTRY, options=options)
    found = gate.read(path, REGISTRY).marked
    np.testing.assert_array_equal(found.ends, given_marks.ends)
    np.testing.assert_array_equal(found.sharpness, given_marks.sharpness)


def test_a_file_of_opensubdiv(tmp_path: Path) -> None:
    """As in its regression shapes: tags after the faces, of creases with sharpness and of others."""
    path = tmp_path / "tetrahedron.obj"
    faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    path.write_text(faces + "t interpolateboundary 1/0/0 1\nt crease 2/1/0 0 1 2.5\nt crease 2/1/0 2 3 0\n")
    found = gate.read(path, REGISTRY).marked
    assert found.ends.tolist() == [[0, 1]]
    assert found.sharpness.tolist() == [2.5]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("t crease 2/1/0 0 4 1", "line 9: found vertex 4 of a crease; they are 0 to 3"),
        ("t crease 2/1/0 0 -1 1", "found vertex -1 of a crease"),
        ("t crease 2/1/0 0 1", "a crease is written t crease 2/1/0 v w sharpness"),
        ("t crease 2/1/0 0 1 nan", "a crease is written"),
        ("t crease 3/1/0 0 1 1", "a crease is written"),
    ],
)
def test_tags_that_are_none(tmp_path: Path, line: str, words: str) -> None:
    path = tmp_path / "mesh.obj"
    path.write_text(f"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n{line}\n")
    with pytest.raises(FormatError, match=words):
        gate.read(path, REGISTRY)


def test_edges_of_a_ply_without_sharpness_mark_nothing(tmp_path: Path) -> None:
    gate.write(tmp_path / "cube.ply", marked_cube(), REGISTRY, options={"ascii": True})
    text = (tmp_path / "cube.ply").read_text()
    (tmp_path / "other.ply").write_text(text.replace("double crease", "double length"))
    assert gate.read(tmp_path / "cube.ply", REGISTRY).marked is not None
    assert gate.read(tmp_path / "other.ply", REGISTRY).marked is None


def test_marks_follow_vertices_with_other_numbers() -> None:
    """Against the places of the ends, which stay."""
    cube = marked_cube()
    more = replace(cube, vertices=np.concatenate([np.zeros((2, 3)), cube.vertices]), tail=cube.tail + 2)
    more = replace(more, marked=MarkedEdges(cube.marked.ends + 2, cube.marked.sharpness))
    less = without_unused_vertices(more)
    np.testing.assert_array_equal(less.vertices[less.marked.ends], cube.vertices[cube.marked.ends])
    part = submesh(cube, np.arange(cube.face_count) == 0).mesh
    assert len(part.marked.ends) == 4
    assert triangulated(cube).marked is cube.marked


def test_formats_without_marks_say_so(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="holds no edges marked as sharp; left out"):
        gate.write(tmp_path / "cube.off", marked_cube(), REGISTRY)


def test_marked_edges_are_the_creases() -> None:
    """All edges of a cube marked make the surface that an angle makes."""
    words = ["basis.size=300", "basis.name=ps2", "output.refine=1"]
    by_angle, by_marks = (
        pipeline.fit(marked_cube(), Config.load(overrides=[f"data.creases={value}", *words]), REGISTRY)
        for value in ("30", "marked")
    )
    np.testing.assert_array_equal(by_marks.surface.coefficients, by_angle.surface.coefficients)
    assert by_marks.report["creases"]["angle_from"] == "marked"
    crease = by_marks.surface.triangulation.crease
    np.testing.assert_array_equal(crease, sharp_edges(by_marks.surface.triangulation.polyhedron, 30))


def test_a_mesh_without_marks_has_no_marked_creases() -> None:
    config = Config.load(overrides=["data.creases=marked", "basis.size=300"])
    with pytest.raises(ConfigError, match=r"no edge of the mesh is marked as sharp \(none is\); .*or give an angle"):
        pipeline.fit(replace(marked_cube(), marked=None), config, REGISTRY)
    elsewhere = replace(marked_cube(), marked=MarkedEdges(np.array([[0, 0]]), np.ones(1)))
    with pytest.raises(ConfigError, match=r"of 1 marks none belongs to an edge"):
        pipeline.fit(elsewhere, config, REGISTRY)
