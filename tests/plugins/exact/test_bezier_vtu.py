"""VTU files with Bezier cells: VTK's own evaluation of them is the surface."""

from __future__ import annotations

import numpy as np
import pytest
from exact_surfaces import surface_of
from late import Late
from orbiframe_exact.bezier_vtu import quadrilateral_order, triangle_order, write_bezier_vtu

from orbiframe.surfaces import patches_of
from orbiframe.testing import contract_tests

vtk = Late("vtk")

test_contract = contract_tests("exporter", write_bezier_vtu, suffix=".vtu")

CASES = [
    ("tetrahedron", "ps2", {}),
    ("double torus", "bernstein", {"degree": 3}),
    ("projective plane", "bernstein", {"degree": 4}),
    ("double torus", "ps6", {}),
    ("torus", "tensor-bspline", {"degree": 3, "counts": (7, 6)}),
    ("Klein bottle", "tensor-bspline", {"degree": 2, "counts": (5, 4)}),
]


def cells_of(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def by_vtk(grid, number: int, place: np.ndarray) -> np.ndarray:
    """The point of a cell at parametric coordinates (r, s)."""
    cell, x = grid.GetCell(number), [0.0] * 3
    cell.EvaluateLocation(vtk.reference(0), (*place, 0.0), x, [0.0] * cell.GetNumberOfPoints())
    return np.array(x)


@pytest.mark.parametrize(("name", "family", "options"), CASES, ids=[f"{n} {f}" for n, f, _ in CASES])
def test_vtk_sees_the_surface(name, family, options, tmp_path):
    """The patches are the surface (see the tests of the kernel), and the cells are the patches."""
    surface = surface_of(name, family, **options)
    write_bezier_vtu(tmp_path / "surface.vtu", surface)
    grid, patches = cells_of(tmp_path / "surface.vtu"), patches_of(surface)
    place = np.random.default_rng(1).dirichlet([1, 1, 1], size=3)[:, 1:]
    if family == "tensor-bspline":
        wanted = patches.quadrilaterals().evaluate(*place.T)
    else:
        wanted = patches.evaluate(np.insert(place, 0, 1 - place.sum(axis=1), axis=1))
    found = np.array([[by_vtk(grid, k, at) for at in place] for k in range(grid.GetNumberOfCells())])
    assert found.shape == wanted.shape
    assert np.abs(found - wanted).max() < 1e-12


def test_adjacent_cells_meet(tmp_path):
    """The ends and the middle of every side lie on exactly two cells, by VTK's evaluation alone."""
    write_bezier_vtu(tmp_path / "surface.vtu", surface_of("double torus", "ps2"))
    grid = cells_of(tmp_path / "surface.vtu")
    middles = np.array([[0.5, 0.0], [0.5, 0.5], [0.0, 0.5]])
    points = np.array([[by_vtk(grid, k, at) for at in middles] for k in range(grid.GetNumberOfCells())]).reshape(-1, 3)
    distance = np.sort(np.linalg.norm(points[:, None] - points[None], axis=2), axis=1)
    assert distance[:, 1].max() < 1e-12
    assert distance[:, 2].min() > 1e-3


@pytest.mark.parametrize("degree", range(1, 8))
def test_orders_are_those_of_vtk(degree):
    """VTK's own numbering: point (i, j, k) of a triangle, (i, j) of a quadrilateral."""
    index = [0, 0, 0]
    for number, ours in enumerate(triangle_order(degree)):
        vtk.vtkHigherOrderTriangle.BarycentricIndex(number, index, degree)
        second, third = index[0], index[1]
        assert ours == (second + third) * (second + third + 1) // 2 + third
    order = quadrilateral_order(degree).tolist()
    for s in range(degree + 1):
        for t in range(degree + 1):
            place = vtk.vtkHigherOrderQuadrilateral.PointIndexFromIJK(s, t, [degree, degree])
            assert order[place] == (degree + 1) * s + t
