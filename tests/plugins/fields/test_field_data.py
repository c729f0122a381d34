"""Data of fields: where the values of every kind of file lie, and what is said of files that are not sound."""

from __future__ import annotations

import meshio
import numpy as np
import pytest
from orbiframe_fields.field_data import FieldData, read_data
from orbiframe_fields.field_table import FieldTable, write_table

from orbiframe import FormatError, Notice, Polyhedron, UsageError

FACES = [[0, 1, 2, 3], [0, 4, 1], [1, 4, 2], [2, 4, 3], [3, 4, 0]]


@pytest.fixture
def mesh() -> Polyhedron:
    return Polyhedron.from_faces(np.random.default_rng(0).normal(size=(5, 3)), FACES)


def read(tmp_path, mesh, text: str, *names: str) -> FieldData:
    (tmp_path / "data.csv").write_text(text)
    return read_data(tmp_path / "data.csv", mesh, names)


def centroids(mesh: Polyhedron) -> np.ndarray:
    return np.array([mesh.vertices[face].mean(axis=0) for face in FACES])


def test_csv_with_places(tmp_path, mesh):
    data = read(tmp_path, mesh, "x; y; z; heat; depth\n1;2;3;4;5\n\n6;7;8;9;1e1\n")
    np.testing.assert_array_equal(data.places, [[1, 2, 3], [6, 7, 8]])
    np.testing.assert_array_equal(data.columns["heat"], [4, 9])
    np.testing.assert_array_equal(data.columns["depth"], [5, 10])
    assert list(read(tmp_path, mesh, "x,y,z,a,b\n1,2,3,4,5\n", "b").columns) == ["b"]


def test_csv_with_numbers_of_vertices_and_faces(tmp_path, mesh):
    data = read(tmp_path, mesh, "vertex,v\n4,1\n0,2\n")
    np.testing.assert_array_equal(data.places, mesh.vertices[[4, 0]])
    data = read(tmp_path, mesh, "face,v\n4,1\n0,2\n")
    np.testing.assert_allclose(data.places, centroids(mesh)[[4, 0]], atol=1e-15)


def test_csv_in_the_order_of_the_vertices(tmp_path, mesh):
    data = read(tmp_path, mesh, "v\n1\n2\n3\n4\n5\n")
    np.testing.assert_array_equal(data.places, mesh.vertices)


@pytest.mark.parametrize("suffix", [".ply", ".vtu", ".csv"])
def test_a_written_field_is_read_again(suffix, tmp_path, mesh):
    """Vertices with numbers and a vector, as `write_table` writes them; normals are no values."""
    rng = np.random.default_rng(1)
    columns = {"normal": rng.normal(size=(5, 3)), "heat": rng.normal(size=5), "flow": rng.normal(size=(5, 3))}
    write_table(tmp_path / f"data{suffix}", FieldTable(mesh, columns))
    data = read_data(tmp_path / f"data{suffix}", mesh)
    np.testing.assert_array_equal(data.places, mesh.vertices)
    np.testing.assert_array_equal(data.table, np.column_stack([columns["heat"], columns["flow"]]))
    back = FieldTable(mesh, data.unpacked(data.table)).scalars
    np.testing.assert_array_equal(back["flow_y"], columns["flow"][:, 1])


def test_data_of_cells_lie_at_their_centroids(tmp_path, mesh):
    cells = [("quad", [FACES[0]]), ("triangle", FACES[1:])]
    values = {"heat": [np.array([1.0]), np.array([2.0, 3.0, 4.0, 5.0])]}
    meshio.write(tmp_path / "data.vtu", meshio.Mesh(mesh.vertices, cells, cell_data=values))
    data = read_data(tmp_path / "data.vtu", mesh)
    np.testing.assert_allclose(data.places, centroids(mesh), atol=1e-15)
    np.testing.assert_array_equal(data.columns["heat"], [1, 2, 3, 4, 5])


def test_lines_without_a_number_are_left_out_and_that_is_said(tmp_path, mesh):
    with pytest.warns(Notice, match="2 of 3 lines"):
        data = read(tmp_path, mesh, "x,y,z,v\n1,2,3,\n1,2,3,nan\n4,5,6,7\n")
    np.testing.assert_array_equal(data.places, [[4, 5, 6]])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "0 lines are there"),
        ("x,y,z,v\n", "1 lines are there"),
        ("1,2,3,4\n5,6,7,8\n", "line 1: the first line must hold a different name"),
        ("v,v\n1,2\n", "line 1: the first line must hold a different name"),
        ("x,y,z,v\n1,2,3\n", "line 2: 3 columns, but the first line names 4"),
        ("x,y,z,v\n1,2,3,4\n1,2,3,hot\n", "line 3: v is 'hot'"),
        ("x,y,z\n1,2,3\n", "no numbers beside the places"),
        ("vertex,v\n5,1\n", "vertex 5 in row 1"),
        ("vertex,v\n0,1\n0.5,1\n", "vertex 0.5 in row 2"),
        ("v\n1\n2\n", "2 lines of numbers without places"),
        ("x,y,z,v\n1,2,3,\n", "no line has all its numbers"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(text, said, tmp_path, mesh):
    with pytest.raises(FormatError, match=said):
        read(tmp_path, mesh, text)


def test_a_name_that_is_not_there_and_files_without_numbers(tmp_path, mesh):
    with pytest.raises(UsageError, match="no values 'haet', but heat"):
        read(tmp_path, mesh, "x,y,z,heat\n1,2,3,4\n", "haet")
    meshio.write(tmp_path / "bare.ply", meshio.Mesh(mesh.vertices, [("triangle", FACES[1:])]))
    with pytest.raises(FormatError, match="no numbers at its points or cells"):
        read_data(tmp_path / "bare.ply", mesh)
    (tmp_path / "broken.vtu").write_text("<VTKFile")
    with pytest.raises(FormatError, match="the library for this format"):
        read_data(tmp_path / "broken.vtu", mesh)
    with pytest.raises(FormatError, match="no such file"):
        read_data(tmp_path / "none.ply", mesh)
