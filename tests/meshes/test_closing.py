"""Closing: boundary loops in order, and meshes closed by caps, collars and doubles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from open_shapes import SHAPES, cylinder, grid, moebius_band, square_sheet
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.errors import TopologyError
from orbiframe.meshes.closing import closed_by
from orbiframe.meshes.defects import require_closed_surface
from orbiframe.meshes.loops import boundary_loops
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.meshes.submesh import submesh
from orbiframe.meshes.surface_type import surface_type

# The Euler characteristic, the loops and whether it is orientable, of each shape.
TOPOLOGY = {
    "bumpy disc": (1, 1, True),
    "square sheet": (1, 1, True),
    "cylinder": (0, 2, True),
    "Möbius band": (0, 1, False),
    "torus with a jagged hole": (-1, 1, True),
    "mask with three holes": (-2, 4, True),
}


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("how", ["cap", "collar", "double"])
def test_the_closed_surface_is_the_one_that_topology_says(name: str, how: str) -> None:
    mesh, (chi, loops, orientable) = SHAPES[name](), TOPOLOGY[name]
    assert surface_type(mesh).euler_characteristic == chi
    assert len(boundary_loops(mesh)) == loops
    closed = closed_by(mesh, how, 0.1)
    found = require_closed_surface(closed)
    # A disc is glued to each loop; the double has twice the characteristic, for loops have none.
    assert found.euler_characteristic == (2 * chi if how == "double" else chi + loops)
    assert found.orientable == orientable
    assert not (orientable and closed.same.any())


@pytest.mark.parametrize("how", ["cap", "collar", "double"])
def test_the_mesh_comes_first_and_keeps_its_gluing(how: str) -> None:
    mesh = moebius_band(20, 3)
    closed = closed_by(mesh, how, 0.2)
    own, corners = len(mesh.vertices), len(mesh.tail)
    assert np.array_equal(closed.vertices[:own], mesh.vertices)
    assert np.array_equal(closed.tail[:corners], mesh.tail)
    inner = mesh.twin >= 0
    assert np.array_equal(closed.twin[:corners][inner], mesh.twin[inner])
    part = submesh(closed, np.arange(closed.face_count) < mesh.face_count)
    assert np.array_equal(part.vertices, np.arange(own))
    for table in ("offsets", "tail", "twin", "same"):
        assert np.array_equal(getattr(part.mesh, table), getattr(mesh, table))


@given(st.integers(3, 40), st.integers(1, 4), st.floats(0, 2))
def test_rings_of_any_number_are_closed(n: int, m: int, width: float) -> None:
    mesh = cylinder(n, m)
    for how in ("cap", "collar", "double"):
        closed = closed_by(mesh, how, width)
        assert (closed.twin >= 0).all()
        assert np.array_equal(closed.twin[closed.twin], np.arange(len(closed.twin)))
        assert surface_type(closed).closed


def test_loops_are_the_cycles_of_the_graph_of_open_edges() -> None:
    mesh = SHAPES["mask with three holes"]()
    open_ = np.flatnonzero(mesh.twin < 0)
    count = len(mesh.vertices)
    links = coo_array((np.ones(len(open_)), (mesh.tail[open_], mesh.head[open_])), shape=(count, count))
    label = connected_components(links, directed=False)[1]
    loops = boundary_loops(mesh)
    on_boundary = np.unique(mesh.tail[open_])
    cycles = {frozenset(on_boundary[label[on_boundary] == k].tolist()) for k in np.unique(label[on_boundary])}
    assert {frozenset(loop.vertices.tolist()) for loop in loops} == cycles
    for loop in loops:
        ends = set(map(frozenset, zip(loop.vertices.tolist(), np.roll(loop.vertices, -1).tolist(), strict=True)))
        assert ends == set(map(frozenset, zip(mesh.tail[loop.halfedges], mesh.head[loop.halfedges], strict=True)))


def test_a_loop_is_as_long_as_its_circle() -> None:
    mesh = cylinder(256, 2)
    lengths = [loop.length(mesh) for loop in boundary_loops(mesh)]
    assert lengths == pytest.approx([2 * np.pi] * 2, rel=1e-4)


def test_the_collar_of_a_flat_sheet_goes_on_in_its_plane_and_outward() -> None:
    sheet = grid(12, 12, lambda u, v: np.stack([u, v, 0 * u], axis=1))
    closed = closed_by(sheet, "collar", 0.2)
    beyond = closed.vertices[len(sheet.vertices) :]
    assert np.abs(beyond[:, 2]).max() < 1e-12
    rings = beyond[: 2 * 48]
    assert ((np.abs(rings[:, :2] - 0.5) > 0.5).any(axis=1)).all()
    assert np.abs(rings[:, :2] - 0.5).max() == pytest.approx(0.7, abs=0.01)
    # The strips are not folded: their areas look the way of the sheet, and add up to about that of the frame.
    first = sheet.face_count
    strips = vector_areas(closed)[first : first + 4 * 48]
    assert (strips[:, 2] > 0).all()
    assert strips[:, 2].sum() == pytest.approx(1.4**2 - 1, rel=0.25)


def test_a_collar_in_a_hole_stops_before_the_middle() -> None:
    mesh = SHAPES["torus with a jagged hole"]()
    (loop,) = boundary_loops(mesh)
    closed = closed_by(mesh, "collar", 10.0)
    rings = closed.vertices[len(mesh.vertices) :][: 2 * len(loop.vertices)]
    middle = loop.points(mesh).mean(axis=0)
    radius = np.linalg.norm(loop.points(mesh) - middle, axis=1).max()
    assert np.linalg.norm(rings - middle, axis=1).max() < radius


def test_a_triangle_is_closed() -> None:
    mesh = Polyhedron.from_faces(np.eye(3), [[0, 1, 2]])
    for how in ("cap", "collar", "double"):
        assert surface_type(closed_by(mesh, how, 0.3)).euler_characteristic == 2
    # Three long edges are corners, not teeth: the collar is outside of the triangle.
    ring = closed_by(mesh, "collar", 0.3).vertices[3:6]
    assert (ring.min(axis=1) < 0).all()


def test_touching_loops_are_named() -> None:
    quads = [[0, 1, 4, 3], [4, 5, 8, 7]]
    corners = np.array([[x, y, 0.0] for y in range(3) for x in range(3)])
    with pytest.raises(TopologyError, match="touch at vertex 4; try again with --split-nonmanifold-vertices"):
        boundary_loops(Polyhedron.from_faces(corners, quads))


def test_a_hole_of_two_edges_is_refused() -> None:
    # Two triangles on the same three corners, glued along one edge only through twins of their own, and two open pairs.
    sheet = square_sheet(2)
    twin = sheet.twin.copy()
    inner = np.flatnonzero(twin >= 0)[0]
    twin[twin[inner]], twin[inner] = -1, -1
    slit = Polyhedron(sheet.vertices, sheet.offsets, sheet.tail, twin, sheet.same)
    closed = closed_by(sheet, "cap", 0.0)
    opened = closed.twin.copy()
    opened[[inner, closed.twin[inner]]] = -1
    whole = Polyhedron(closed.vertices, closed.offsets, closed.tail, opened, closed.same)
    with pytest.raises(TopologyError, match="has 2 edges; a hole has three at least"):
        closed_by(whole, "cap", 0.0)
    with pytest.raises(TopologyError, match="touch"):
        boundary_loops(slit)
