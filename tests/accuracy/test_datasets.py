"""The datasets are what make.py makes, and what their index says."""

from __future__ import annotations

import importlib.util
import tomllib
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from orbiframe import surface_type
from orbiframe.meshes.defects import defects_of
from orbiframe.meshes.polyhedron import Polyhedron

FOLDER = Path(__file__).parents[2] / "datasets"
INDEX = tomllib.loads((FOLDER / "index.toml").read_text())
KEYS = {"vertices", "edges", "faces", "surface", "orientable", "source", "licence"}
PLATES = {"plate_genus2_coarse.off": 13, "plate_genus2.off": 13, "plate_genus3.off": 18, "plate_genus5.off": 28}


def polyhedron(name: str) -> Polyhedron:
    """The mesh of an OFF file without comments, read here word by word."""
    words = (FOLDER / name).read_text().split()
    v, f, first = int(words[1]), int(words[2]), 4
    vertices = np.array(words[first : first + 3 * v], dtype=float).reshape(v, 3)
    faces, at = [], first + 3 * v
    for _ in range(f):
        end = at + 1 + int(words[at])
        faces.append([int(word) for word in words[at + 1 : end]])
        at = end
    assert words[0] == "OFF"
    assert at == len(words)
    return Polyhedron.from_faces(vertices, faces)


def triangle_fans(mesh: Polyhedron) -> np.ndarray:
    """The corners (n, 3, 3) of the faces cut in fans."""
    faces = np.split(mesh.tail, mesh.offsets[1:-1])
    return np.array([mesh.vertices[[f[0], a, b]] for f in faces for a, b in pairwise(f[1:])])


def test_make_reproduces_every_file(tmp_path: Path) -> None:
    spec = importlib.util.spec_from_file_location("orbiframe_dataset_maker", FOLDER / "make.py")
    assert spec is not None
    assert spec.loader is not None
    make = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(make)
    make.main(tmp_path)
    made = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    kept = {path.name: path.read_bytes() for path in FOLDER.iterdir() if path.suffix in {".off", ".toml"}}
    assert made == kept


def test_index_lists_every_mesh() -> None:
    assert sorted(INDEX) == sorted(path.name for path in FOLDER.glob("*.off"))
    for entry in INDEX.values():
        assert set(entry) == KEYS | {"genus" if entry["orientable"] else "crosscaps"}


@pytest.mark.parametrize("name", INDEX)
def test_index_describes_the_mesh(name: str) -> None:
    mesh, entry = polyhedron(name), INDEX[name]
    found = surface_type(mesh)
    assert (len(mesh.vertices), mesh.edge_count, mesh.face_count) == (entry["vertices"], entry["edges"], entry["faces"])
    assert (found.closed, found.components, found.orientable) == (True, 1, entry["orientable"])
    assert found.genus == entry["genus" if entry["orientable"] else "crosscaps"]
    assert not defects_of(mesh)


@pytest.mark.parametrize("name", [name for name, entry in INDEX.items() if entry["orientable"]])
def test_faces_are_seen_counterclockwise_from_outside(name: str) -> None:
    volume = np.linalg.det(triangle_fans(polyhedron(name))).sum() / 6
    assert volume > 0
    if name in PLATES:
        assert volume == pytest.approx(PLATES[name])


def test_figure_11() -> None:
    """The polyhedron of the paper's figure 11, described there as genus 2 with square faces."""
    mesh = polyhedron("plate_genus2_coarse.off")
    assert (len(mesh.vertices), mesh.edge_count, mesh.face_count) == (48, 100, 50)
    edges = np.linalg.norm(mesh.vertices[mesh.head] - mesh.vertices[mesh.tail], axis=1)
    assert np.array_equal(mesh.face_sizes, np.full(50, 4))
    assert np.allclose(edges, 1)
