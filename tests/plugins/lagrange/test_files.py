"""Files of curved elements, read back by VTK, meshio, Gmsh and MFEM, and by hand where these are absent."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest
from fitted import fitted
from installed_gmsh import require_gmsh
from orbiframe_lagrange import gmsh, mfem, vtu

from orbiframe import FitError
from orbiframe.surfaces import CurvedMesh, curved_mesh, input_faces, node_exponents
from orbiframe.testing import contract_tests

ORDERS = range(1, 7)
GMSH_TYPES = {1: "triangle", 2: "triangle6", 3: "triangle10", 4: "triangle15", 5: "triangle21", 6: "triangle28"}

test_gmsh_contract = contract_tests("elements", gmsh.write, suffix=".msh")
test_gmsh_2_2_contract = contract_tests("elements", gmsh.write_2_2, suffix=".msh2")
test_vtu_contract = contract_tests("elements", vtu.write, suffix=".vtu")
test_mfem_contract = contract_tests("elements", mfem.write, suffix=".mesh")


def elements(order: int, name: str = "klein_bottle.off") -> CurvedMesh:
    surface = fitted(name).surface
    return curved_mesh(surface, input_faces(surface), order)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("write", [gmsh.write, gmsh.write_2_2])
def test_meshio_reads_the_same_nodes_and_elements(order, write, tmp_path):
    mesh = elements(order)
    write(tmp_path / "mesh.msh", mesh)
    found = meshio.read(tmp_path / "mesh.msh")
    assert np.array_equal(found.points, mesh.nodes)
    (block,) = found.cells
    assert block.type == GMSH_TYPES[order]
    assert np.array_equal(block.data, mesh.elements)


@pytest.mark.parametrize("order", ORDERS)
def test_vtk_reads_the_same_cells_and_puts_the_nodes_where_we_do(order, tmp_path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    mesh = elements(order)
    vtu.write(tmp_path / "mesh.vtu", mesh)
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / "mesh.vtu"))
    reader.Update()
    grid = reader.GetOutput()
    assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), mesh.nodes)
    assert grid.GetNumberOfCells() == len(mesh.elements)
    assert {grid.GetCellType(n) for n in range(len(mesh.elements))} == {5 if order == 1 else 69}
    cell = grid.GetCell(7)
    assert [cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())] == mesh.elements[7].tolist()
    # VTK places its nodes by coordinates (r, s): the weights of corners 1 and 2.
    inside = np.array([cell.GetParametricCoords()[k] for k in range(3 * cell.GetNumberOfPoints())]).reshape(-1, 3)
    assert np.abs(inside[:, :2] - node_exponents(order)[:, 1:] / order).max() < 1e-12


@pytest.mark.usefixtures("signals_kept")
@pytest.mark.parametrize("order", ORDERS)
def test_gmsh_reads_the_same_nodes_and_puts_them_where_we_do(order, tmp_path):
    reader = require_gmsh()
    mesh = elements(order, "plate_genus2_coarse.off")
    for write in (gmsh.write, gmsh.write_2_2):
        write(tmp_path / "mesh.msh", mesh)
        reader.initialize()
        try:
            reader.option.setNumber("General.Terminal", 0)
            reader.open(str(tmp_path / "mesh.msh"))
            tags, places, _ = reader.model.mesh.getNodes()
            kinds, _, nodes = reader.model.mesh.getElements(2)
            local = reader.model.mesh.getElementProperties(kinds[0])[4]
        finally:
            reader.finalize()
        assert np.abs(places.reshape(-1, 3)[np.argsort(tags)] - mesh.nodes).max() < 1e-12
        assert np.array_equal(nodes[0].reshape(mesh.elements.shape).astype(int) - 1, mesh.elements)
        assert np.abs(local.reshape(-1, 2) - node_exponents(order)[:, 1:] / order).max() < 1e-12


# ---- MFEM -----------------------------------------------------------------------------------------------------------


def read_mfem(path: Path) -> tuple[np.ndarray, list[list[int]], int]:
    """The unknowns, the corners of the triangles and the order, by the words of the page on formats."""
    lines = path.read_text().split("\n")
    count = int(lines[lines.index("elements") + 1])
    start = lines.index("elements") + 2
    corners = [list(map(int, line.split()[2:])) for line in lines[start : start + count]]
    assert all(line.split()[:2] == ["1", "2"] for line in lines[start : start + count])
    (space,) = (line for line in lines if line.startswith("FiniteElementCollection"))
    begin = lines.index("Ordering: 1") + 2
    unknowns = np.array([list(map(float, line.split())) for line in lines[begin:] if line])
    return unknowns, corners, int(space.rsplit("P", 1)[1])


def places_of_unknowns(corners: list[list[int]], order: int) -> list[list[tuple[int, tuple[int, int, int]]]]:
    """For every triangle the unknowns that it has, with their barycentric coordinates times the order.

    As in MFEM: vertices first; edges, numbered as they first appear, each from its lesser end; then triangles.
    """
    vertices = 1 + max(map(max, corners))
    edges: dict[tuple[int, int], int] = {}
    for face in corners:
        for k in range(3):
            edges.setdefault((min(face[k], face[k - 2]), max(face[k], face[k - 2])), len(edges))
    within = [(i, j) for j in range(1, order) for i in range(1, order - j)]
    found = []
    for number, face in enumerate(corners):
        own = [(face[k], tuple(order * (k == c) for c in range(3))) for k in range(3)]
        for k in range(3):
            a, b = sorted((k, (k + 1) % 3), key=lambda c: face[c])
            first = vertices + edges[face[a], face[b]] * (order - 1)
            for step in range(1, order):
                place = [0, 0, 0]
                place[a], place[b] = order - step, step
                own.append((first + step - 1, tuple(place)))
        first = vertices + len(edges) * (order - 1) + number * len(within)
        own += [(first + n, (order - i - j, i, j)) for n, (i, j) in enumerate(within)]
        found.append(own)
    return found


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", ["plate_genus2_coarse.off", "klein_bottle.off"])
def test_unknowns_of_mfem_lie_where_mfem_looks_for_them(order, name, tmp_path):
    mesh = elements(order, name)
    mfem.write(tmp_path / "mesh.mesh", mesh)
    unknowns, corners, found = read_mfem(tmp_path / "mesh.mesh")
    assert found == order
    assert unknowns.shape == mesh.nodes.shape
    number = {tuple(place): n for n, place in enumerate(node_exponents(order).tolist())}
    for element, own in zip(mesh.elements, places_of_unknowns(corners, order), strict=True):
        assert len(own) == len(element)
        for unknown, place in own:
            assert np.array_equal(unknowns[unknown], mesh.nodes[element[number[place]]])


@pytest.mark.parametrize("order", ORDERS)
def test_mfem_finds_the_same_area_in_all_files(order, tmp_path):
    reader = pytest.importorskip("mfem.ser", reason="mfem is not installed")
    mesh = elements(order, "plate_genus2_coarse.off")
    areas = []
    for write, name in ((mfem.write, "a.mesh"), (gmsh.write_2_2, "b.msh")):
        write(tmp_path / name, mesh)
        read = reader.Mesh(str(tmp_path / name))
        assert (read.GetNE(), read.SpaceDimension()) == (len(mesh.elements), 3)
        rule, area = reader.IntRules.Get(2, 2 * order), 0.0
        for element in range(read.GetNE()):
            chart = read.GetElementTransformation(element)
            for k in range(rule.GetNPoints()):
                chart.SetIntPoint(rule.IntPoint(k))
                area += rule.IntPoint(k).weight * chart.Weight()
        areas.append(area)
    assert areas[0] == pytest.approx(areas[1], rel=1e-12)


def test_edges_that_mfem_cannot_tell_apart_are_refused(tmp_path):
    """Two triangles with the same three corners and different sides: a sphere."""
    nodes = np.random.default_rng(1).normal(size=(9, 3))
    mesh = CurvedMesh(2, nodes, np.array([[0, 1, 2, 3, 4, 5], [0, 2, 1, 6, 7, 8]]))
    with pytest.raises(FitError, match="--refine 2"):
        mfem.write(tmp_path / "two.mesh", mesh)
