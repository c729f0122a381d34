"""Plane faces and seams, arcs over facets, against shapes that are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from creased import cylinder, mesh_of, rounded_bar
from documents import ROOT
from fitted import REGISTRY

from orbiframe.files import gate
from orbiframe.functions.arcs import Arcs
from orbiframe.meshes import seams as module
from orbiframe.meshes.bending import sharp_edges
from orbiframe.meshes.bisection import bisected
from orbiframe.meshes.curving import Curving
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.fine_marks import fine_largest, fine_marks
from orbiframe.meshes.flat_flips import flat_flips
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.seams import plane_faces, seams

PLATE = ROOT.parent / "shared" / "meshes" / "trimesh_plate_holes.STL"


def test_planes_end_in_seams_where_a_round_begins() -> None:
    """Two rounds with two ends each, as long as the bar: four seams, with z from 0 to 3 at x or y of the tangent."""
    mesh = triangulated(rounded_bar())
    crease = sharp_edges(mesh, 30)
    found = np.flatnonzero(seams(mesh, crease) & mesh.representative)
    ends = np.sort(np.round(mesh.vertices[np.stack([mesh.tail[found], mesh.head[found]], axis=1)][:, :, :2], 9), axis=1)
    assert (ends[:, 0] == ends[:, 1]).all()
    assert sorted(map(tuple, ends[:, 0].tolist())) == [(0.0, 3.5), (0.5, 4.0), (3.5, 4.0), (4.0, 3.5)]


@pytest.mark.parametrize("name", ["cylinder", "cube.off", "sphere.off", "torus.off", "plate_genus2_coarse.off"])
def test_shapes_without_a_tangent_plane_have_no_seam(name: str) -> None:
    mesh = mesh_of(name)
    assert not seams(mesh, sharp_edges(mesh, 30)).any()


def test_a_wide_strip_of_a_round_is_no_plane() -> None:
    """A cylinder with one strip of 40 degrees among those of 4: it bends to them by 22, and they by 4 to each other."""
    angle = np.radians(np.append(0, np.linspace(40, 356, 80)))
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    count = len(ring)
    vertices = np.concatenate([np.column_stack([ring, np.full(count, z)]) for z in (0.0, 1.0)])
    walls = [[i, (i + 1) % count, count + (i + 1) % count, count + i] for i in range(count)]
    mesh = triangulated(
        Polyhedron.from_faces(vertices, [*walls, list(range(count))[::-1], list(range(count, 2 * count))])
    )
    assert not seams(mesh, sharp_edges(mesh, 30)).any()


def test_a_plane_is_told_by_what_lies_beyond(monkeypatch: pytest.MonkeyPatch) -> None:
    """The mutant: by widths alone the wide strip is a plane."""
    monkeypatch.setattr(module, "_AS_MUCH", 1e6)
    with pytest.raises(AssertionError):
        test_a_wide_strip_of_a_round_is_no_plane()


def test_the_plate_has_its_five_plane_faces_and_its_floor() -> None:
    """Bottom, four walls: 2 loops of the round, 8 ends of the walls; its top and floor have creases all about."""
    if not PLATE.exists():
        pytest.skip(f"{PLATE} is not there")
    mesh = triangulated(gate.read(PLATE, REGISTRY))
    flips = flat_flips(mesh, None)
    mesh = mesh if flips is None else flips.after
    crease = sharp_edges(mesh, 30)
    plane = plane_faces(mesh, crease)[1]
    assert plane.sum() == 5
    found = seams(mesh, crease)
    length = mesh.edge_lengths[found & mesh.representative].sum()
    straight = 2 * (203.2 + 304.8) - 8 * 25.4
    round_corners = 4 * 12 * 2 * (25.4 - 6.35) * np.sin(np.pi / 24) / 2
    assert length == pytest.approx(2 * straight + round_corners + 8 * 6.35, rel=1e-5)
    assert Path(PLATE).suffix == ".STL"


# ---- arcs -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("sides", [12, 24, 48])
def test_arcs_over_a_cylinder_are_on_it(sides: int) -> None:
    """At the middles of the walls: what is left is a share of the height of the facets that falls with its square."""
    mesh = triangulated(cylinder(sides))
    curving = Curving.of(mesh, sharp_edges(mesh, 35))
    wall = np.flatnonzero(np.abs(curving.normals[:, 2]) < 0.5)
    np.testing.assert_allclose(curving.curvatures[wall], 2.0, rtol=(2 / sides) ** 1)
    assert (curving.curvatures[np.abs(curving.normals[:, 2]) > 0.5] == 0).all()
    rng = np.random.default_rng(0)
    face, barycentric = np.repeat(wall, 5), rng.dirichlet(np.ones(3), 5 * len(wall))
    flat = np.einsum("nc,nci->ni", barycentric, mesh.vertices[mesh.triangles[face]])
    lifted = flat + curving.lifts(face, barycentric)
    away = np.abs(np.hypot(lifted[:, 0], lifted[:, 1]) - 0.5)
    facets = 0.5 * (1 - np.cos(np.pi / sides))
    assert away.max() < 4 / sides**2 * facets * np.pi**2 / 4


def test_arcs_turn_inward_where_the_mesh_is_hollow() -> None:
    """The same cylinder seen as a hole: its faces turned round."""
    mesh = triangulated(cylinder(24))
    turned = Polyhedron.from_faces(mesh.vertices, mesh.triangles[:, ::-1])
    curving = Curving.of(turned, sharp_edges(turned, 30))
    wall = np.flatnonzero(np.abs(curving.normals[:, 2]) < 0.5)
    lifts = curving.lifts(wall, np.full((len(wall), 3), 1 / 3))
    middle = turned.vertices[turned.triangles[wall]].mean(axis=1)
    assert (np.einsum("ni,ni->n", lifts[:, :2], middle[:, :2]) > 0).all()


def test_marks_and_numbers_of_facets_on_the_refined_mesh() -> None:
    mesh = mesh_of("plate_genus2_coarse.off")
    refinement = bisected(mesh, 0.05 * mesh.diagonal, True)
    np.testing.assert_array_equal(fine_marks(refinement, sharp_edges(mesh, 30)), sharp_edges(refinement.polyhedron, 30))
    assert not fine_marks(refinement, np.zeros(len(mesh.tail), dtype=np.bool_)).any()
    level = (mesh.vertices[mesh.triangles].mean(axis=1)[:, 2] > 0.99).astype(float)
    assert ((fine_largest(refinement, level) == 1) == (refinement.polyhedron.vertices[:, 2] == 1)).all()


def test_arcs_of_refined_facets() -> None:
    mesh = triangulated(cylinder(24))
    refinement = bisected(mesh, 0.1, True)
    arcs = Arcs.of(refinement, sharp_edges(mesh, 30))
    fine = refinement.polyhedron
    lifted = fine.vertices[fine.triangles].mean(axis=1) + arcs.lifts(
        np.arange(fine.face_count), np.full((fine.face_count, 3), 1 / 3)
    )
    wall = arcs.height[arcs.facet] > 0
    assert np.abs(np.hypot(lifted[wall, 0], lifted[wall, 1]) - 0.5).max() < 0.01 * 0.5 * (1 - np.cos(np.pi / 24))
    at_given = (arcs.corners > 1 - 1e-12).any(axis=2)
    assert arcs.over_corners[at_given].max() < 1e-12
