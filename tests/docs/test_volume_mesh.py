"""The script that makes tetrahedra: inside, on the surface, none turned over, judged without Gmsh."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from documents import ROOT, module_of
from fitted import fitted
from installed_gmsh import require_gmsh
from orbiframe_remeshing.remeshing import remeshed

from orbiframe import OrbifoldSurface, Polyhedron

require_gmsh()
pytestmark = pytest.mark.usefixtures("signals_kept")

# As meshio orders them: corners, then the middles of the edges 01, 12, 20, 03, 13, 23.
EDGES = np.array([[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]])


@cache
def made(name: str, vertices: int) -> tuple[Any, OrbifoldSurface, Polyhedron]:
    surface = fitted(name).surface
    return module_of(ROOT / "docs" / "examples" / "volume_mesh.py"), surface, remeshed(surface, vertices)


def least_jacobian(points: np.ndarray, cells: np.ndarray) -> float:
    """The least over all elements and a grid of places of det dx / dxi over that of the straight element."""
    grid = np.array([(i, j, k, 6 - i - j - k) for i in range(7) for j in range(7 - i) for k in range(7 - i - j)]) / 6
    slopes = np.zeros((len(grid), 10, 4))
    slopes[:, np.arange(4), np.arange(4)] = 4 * grid - 1
    for m, (a, b) in enumerate(EDGES):
        slopes[:, 4 + m, a], slopes[:, 4 + m, b] = 4 * grid[:, b], 4 * grid[:, a]
    matrices = np.einsum("pkc,eki->epci", slopes[:, :, 1:] - slopes[:, :, :1], points[cells])
    straight = np.linalg.det(points[cells[:, 1:4]] - points[cells[:, :1]])
    return float((np.linalg.det(matrices) / straight[:, None]).min())


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "vertices", "share"), [("torus.off", 200, 5e-3), ("plate_genus2_coarse.off", 350, 3e-2)]
)
def test_no_element_is_turned_over_and_the_boundary_is_on_the_surface(name, vertices, share, tmp_path):
    script, surface, triangles = made(name, vertices)
    found = script.volume_mesh(surface, triangles, tmp_path / "volume.msh", 2)
    mesh = meshio.read(tmp_path / "volume.msh")
    cells, faces = mesh.cells_dict["tetra10"], mesh.cells_dict["triangle6"]
    assert (len(cells), len(mesh.points), len(faces)) == (found.elements, found.nodes, found.triangles)
    assert least_jacobian(mesh.points, cells) > 0
    assert surface.distance(mesh.points[np.unique(faces)]).max() < 1e-9
    fine = surface.tessellate(12)
    volume = np.linalg.det(fine.vertices[fine.triangles]).sum() / 6
    assert found.volume == pytest.approx(volume, rel=share)
    sides, count = np.unique(
        np.sort(cells[:, [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]], axis=2).reshape(-1, 3),
        axis=0,
        return_counts=True,
    )
    assert len(np.unique(np.sort(faces[:, :3], axis=1), axis=0)) == (count == 1).sum()
    assert count.max() == 2
    assert len(sides) == (count == 1).sum() + (count == 2).sum()


@pytest.mark.long
def test_elements_that_are_turned_over_are_refused(tmp_path, monkeypatch):
    """The mutant that moves no node."""
    script, surface, triangles = made("plate_genus2_coarse.off", 350)
    monkeypatch.setattr(script, "_turned", lambda boundary: np.zeros(0, dtype=np.int64))
    with pytest.raises(ValueError, match="turned over; remesh with a smaller"):
        script.volume_mesh(surface, triangles, tmp_path / "volume.msh", 2)
    assert list(tmp_path.iterdir()) == []


def test_a_surface_without_an_inside_is_refused(tmp_path):
    script = module_of(ROOT / "docs" / "examples" / "volume_mesh.py")
    surface = fitted("klein_bottle.off").surface
    with pytest.raises(ValueError, match="no inside"):
        script.volume_mesh(surface, surface.tessellate(1), Path(tmp_path / "volume.msh"))


def test_halving_keeps_a_closed_surface_and_adds_vertices_on_it():
    script, surface, triangles = made("torus.off", 200)
    rng = np.random.default_rng(4)
    wanted = rng.random(triangles.edge_count) < 0.1
    found = script.halved(surface, triangles, wanted)
    assert (found.twin >= 0).all()
    assert not found.same.any()
    assert len(found.vertices) - found.edge_count + found.face_count == 0
    assert len(found.vertices) >= len(triangles.vertices) + wanted.sum()
    assert surface.distance(found.vertices).max() < 1e-9
