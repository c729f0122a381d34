"""Binary glTF of a fit holds positions, indices and the normals of the surface; parsed here by hand."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from exact_surfaces import surface_of

from orbiframe import Points, Registry
from orbiframe.files import gate

# glTF 2.0, section 3.6.2: component types and numbers of components.
_NUMBERS = {5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTH = {"SCALAR": 1, "VEC3": 3}


def parsed(path: Path) -> dict[str, np.ndarray]:
    """The arrays of the one primitive of a file .glb: a header, a chunk of JSON, a chunk of bytes."""
    data = path.read_bytes()
    assert data[:4] == b"glTF"
    length = int.from_bytes(data[12:16], "little")
    tree, blob = json.loads(data[20 : 20 + length]), data[28 + length :]
    (primitive,) = tree["meshes"][0]["primitives"]
    names = {**primitive["attributes"], "indices": primitive["indices"]}
    return {name: _array(tree, blob, tree["accessors"][number]) for name, number in names.items()}


def _array(tree: dict, blob: bytes, accessor: dict) -> np.ndarray:
    view = tree["bufferViews"][accessor["bufferView"]]
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    width = _WIDTH[accessor["type"]]
    found = np.frombuffer(blob, _NUMBERS[accessor["componentType"]], accessor["count"] * width, start)
    return found.reshape(-1, width)


@pytest.mark.parametrize("name", ["double torus", "Klein bottle"])
def test_normals_are_those_of_the_surface(name, tmp_path):
    """They are unit vectors, and orthogonal to the surface: equal to its unit normals, up to the side."""
    surface = surface_of(name, "ps2")
    mesh = surface.tessellate(1)
    gate.write(tmp_path / "shape.glb", mesh, Registry.discover())
    found = parsed(tmp_path / "shape.glb")
    assert np.array_equal(found["indices"].reshape(-1, 3), mesh.triangles)
    assert np.abs(found["POSITION"] - mesh.vertices).max() < 1e-6
    assert np.abs(np.linalg.norm(found["NORMAL"], axis=1) - 1).max() < 1e-6
    wanted = surface.normals(Points(surface.triangulation.patch, surface.triangulation.points))
    assert np.abs(np.abs((found["NORMAL"] * wanted).sum(axis=1)) - 1).max() < 1e-6
