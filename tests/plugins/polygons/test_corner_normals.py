"""Normals of corners beside creases in glTF: a vertex for each side, and one surface again when read."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from creased import fitted_with_creases
from fitted import REGISTRY

from orbiframe.files import gate
from orbiframe.meshes.sizes import vector_areas


@pytest.fixture(scope="module")
def cube():
    return fitted_with_creases("cube.off", 30, 300, "basis.name=ps2").output


def test_vertices_are_written_once_for_each_side(cube, tmp_path: Path) -> None:
    """Read by the format's own rules: every corner has the normal of its side, and its place."""
    gate.write(tmp_path / "cube.gltf", cube, REGISTRY)
    import base64

    tree = json.loads((tmp_path / "cube.gltf").read_text())
    data = base64.b64decode(tree["buffers"][0]["uri"].split(",")[1])

    def table(number: int, width: int, kind: str) -> np.ndarray:
        accessor = tree["accessors"][number]
        view = tree["bufferViews"][accessor["bufferView"]]
        count = accessor["count"] * width
        return np.frombuffer(data, kind, count, view["byteOffset"]).reshape(-1, width)

    primitive = tree["meshes"][0]["primitives"][0]
    index = table(
        primitive["indices"], 1, "<u2" if len(cube.tail) < 2**16 and cube.vertices.shape[0] < 2**15 else "<u4"
    )
    x, normals = (table(primitive["attributes"][name], 3, "<f4") for name in ("POSITION", "NORMAL"))
    np.testing.assert_allclose(x[index.ravel()], cube.vertices[cube.tail], atol=1e-6)
    np.testing.assert_allclose(normals[index.ravel()], cube.corner_normals, atol=1e-6)
    assert len(x) > len(cube.vertices)
    vectors = vector_areas(cube)
    unit = vectors / np.linalg.norm(vectors, axis=1)[:, None]
    assert np.einsum("hi,hi->h", normals[index.ravel()], unit[cube.face]).min() > 1 - 1e-3


def test_the_surface_is_closed_again_when_it_is_read(cube, tmp_path: Path) -> None:
    gate.write(tmp_path / "cube.glb", cube, REGISTRY)
    found = gate.read(tmp_path / "cube.glb", REGISTRY)
    assert (found.twin >= 0).all()
    assert len(found.vertices) == len(cube.vertices)
