"""Tables of numbers at vertices: every format read again by meshio, to the last digit."""

from __future__ import annotations

import meshio
import numpy as np
import pytest
from orbiframe_fields.field_table import FieldTable, require_field_file, write_table

from orbiframe import FormatError, Polyhedron

FACES = [[0, 1, 2, 3], [0, 4, 1], [1, 4, 2], [2, 4, 3], [3, 4, 0]]


@pytest.fixture
def pyramid() -> FieldTable:
    rng = np.random.default_rng(0)
    mesh = Polyhedron.from_faces(rng.normal(size=(5, 3)), FACES)
    return FieldTable(mesh, {"normal": rng.normal(size=(5, 3)), "k1": rng.normal(size=5), "d": rng.normal(size=(5, 3))})


@pytest.mark.parametrize("suffix", [".ply", ".vtu"])
def test_meshio_reads_the_same_numbers(suffix, pyramid, tmp_path) -> None:
    write_table(tmp_path / f"out{suffix}", pyramid)
    read = meshio.read(tmp_path / f"out{suffix}")
    np.testing.assert_array_equal(read.points, pyramid.mesh.vertices)
    assert [face.tolist() for block in read.cells for face in block.data] == FACES
    columns = pyramid.columns
    if suffix == ".vtu":
        for name, values in columns.items():
            np.testing.assert_array_equal(read.point_data[name], values)
    else:
        np.testing.assert_array_equal(read.point_data["k1"], columns["k1"])
        for axis, values in zip("xyz", columns["normal"].T, strict=True):
            np.testing.assert_array_equal(read.point_data[f"n{axis}"], values)
        np.testing.assert_array_equal(read.point_data["d_z"], columns["d"][:, 2])


def test_csv_has_all_digits(pyramid, tmp_path) -> None:
    write_table(tmp_path / "out.csv", pyramid)
    read = np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(read["vertex"], np.arange(5))
    np.testing.assert_array_equal(read["y"], pyramid.mesh.vertices[:, 1])
    np.testing.assert_array_equal(read["normal_y"], pyramid.columns["normal"][:, 1])
    np.testing.assert_array_equal(read["k1"], pyramid.columns["k1"])


def test_other_files_are_refused(tmp_path) -> None:
    with pytest.raises(FormatError, match=r"written to \.ply \.vtu \.csv"):
        require_field_file(tmp_path / "out.stl")
    with pytest.raises(FormatError, match="no folder"):
        require_field_file(tmp_path / "none" / "out.csv")
