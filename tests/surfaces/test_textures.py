"""Texture coordinates of closed surfaces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fitted import REGISTRY, config, fitted_linearly

from orbiframe.errors import UsageError
from orbiframe.fitting import pipeline
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.unions import disjoint_union
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.surfaces.textures import texture_coordinates, texture_distortion
from orbiframe.triangulations.cut_open import unrolled

NAMES = [
    "torus.off",
    "klein_bottle.off",
    "projective_plane.off",
    "plate_genus2.off",
    "three_crosscaps.off",
    "sphere.off",
]


def surface(name: str) -> OrbifoldSurface:
    return fitted_linearly(name).surface


def textured(name: str, density: int = 1, *, bisected: bool = True) -> Polyhedron:
    mesh = surface(name).tessellate(density, bisected=bisected)
    return replace(mesh, corner_uv=texture_coordinates(surface(name), density, bisected=bisected))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("density", [1, 2])
def test_the_square_is_filled_once_without_a_fold(name, density):
    mesh = textured(name, density)
    found = texture_distortion(mesh)
    assert found.folded == 0
    assert np.isfinite(found.angle).all()
    room = 0.15 if name == "sphere.off" else 1e-12
    assert mesh.corner_uv.min() >= -room
    assert mesh.corner_uv.max() <= 1 + room
    assert (found.area @ areas(mesh)) / areas(mesh).sum() == pytest.approx(1.0)
    assert np.median(found.angle) < 2.1


def areas(mesh: Polyhedron) -> np.ndarray:
    u, v = (mesh.vertices[mesh.triangles][:, k] - mesh.vertices[mesh.triangles][:, 0] for k in (1, 2))
    return np.linalg.norm(np.cross(u, v), axis=1) / 2


@pytest.mark.parametrize("name", ["torus.off", "plate_genus2.off", "sphere.off"])
def test_textures_of_orientable_surfaces_are_not_mirrored(name):
    """Counterclockwise in space, from the side of the normals, is counterclockwise in the square."""
    mesh = textured(name)
    a, b, c = np.moveaxis(mesh.corner_uv.reshape(-1, 3, 2), 1, 0)
    assert ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] > 0).all()


@pytest.mark.parametrize("name", ["torus.off", "klein_bottle.off"])
def test_flat_surfaces_are_drawn_as_they_are(name):
    """Distances in the square are those in the plane, all by one factor."""
    map = surface(name).triangulation
    uv = texture_coordinates(surface(name), bisected=True).reshape(-1, 3, 2)
    plane = map.orbifold.geometry.distance(map.lifts, np.roll(map.lifts, -1, axis=1))
    ratio = np.linalg.norm(np.roll(uv, -1, axis=1) - uv, axis=2) / plane
    assert np.ptp(ratio) < 1e-12 * ratio.max() * 1e3


def test_hyperbolic_surfaces_are_drawn_conformally():
    """Angles at the corners of small triangles are those in H^2, where triangles are almost flat."""
    map = surface("plate_genus2.off").triangulation
    uv = texture_coordinates(surface("plate_genus2.off"), bisected=True).reshape(-1, 3, 2)
    z = uv[..., 0] + 1j * uv[..., 1]
    drawn = np.abs(np.angle((z[:, 1] - z[:, 0]) / (z[:, 2] - z[:, 0])))
    x = map.lifts
    truth = map.orbifold.geometry.angle(x[:, 0], x[:, 1], x[:, 2])
    assert np.abs(drawn - np.abs(truth)).max() < 0.1
    assert np.median(np.abs(drawn - np.abs(truth))) < 0.02


@pytest.mark.parametrize("name", ["torus.off", "plate_genus2.off", "three_crosscaps.off"])
def test_the_cut_runs_along_the_sides_of_the_domain(name):
    sides = int((~unrolled(surface(name).triangulation).joined).sum()) // 2
    for density in (1, 2):
        assert texture_distortion(textured(name, density)).cut == density * sides


def test_a_refined_input_gets_coordinates_where_no_edge_was_flipped():
    name = "three_crosscaps.off"
    assert texture_distortion(textured(name, 6, bisected=False)).folded == 0


def test_flipped_triangles_need_the_refined_mesh():
    corners = [[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0], [0, 0, 1], [4, 0, 1], [4, 1, 1], [0, 1, 1]]
    top = [[8, 4, 5], [8, 5, 9], [5, 6, 9], [6, 8, 9], [8, 6, 7], [8, 7, 4]]  # the edge 8-5 is not Delaunay
    sides = [[0, 3, 2, 1], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    box = Polyhedron.from_faces([*corners, [1, 0.5, 1], [2.5, 0.5, 1]], top + sides)
    found = pipeline.fit(box, config(30, "fitter.name=least-squares", "data.lift=false"), REGISTRY).surface
    with pytest.raises(UsageError, match="leave --refine"):
        texture_coordinates(found, 3)
    assert len(texture_coordinates(found, bisected=True)) == 3 * found.triangulation.polyhedron.face_count


def test_distortion_of_a_known_map():
    mesh = Polyhedron.from_faces([[0, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0]], [[0, 1, 2], [1, 3, 2]])
    uv = np.array([[0, 0], [1, 0], [0, 1], [1, 0], [1, 1], [0, 1]], dtype=float)
    found = texture_distortion(replace(mesh, corner_uv=uv))
    assert found.angle == pytest.approx([2, 2])
    assert found.area == pytest.approx([1, 1])
    assert (found.cut, found.folded) == (0, 0)
    turned = uv.copy()
    turned[4] = [0.2, 0.2]
    assert texture_distortion(replace(mesh, corner_uv=turned)).folded == 1
    moved = uv.copy()
    moved[3:] += [0.0, 0.5]
    assert texture_distortion(replace(mesh, corner_uv=moved)).cut == 1
    with pytest.raises(UsageError, match="no texture coordinates"):
        texture_distortion(mesh)


def test_several_parts_share_the_square():
    one, two = textured("torus.off"), textured("sphere.off")
    both = disjoint_union([one, two])
    assert both.corner_uv[: len(one.tail)] == pytest.approx(one.corner_uv / 2)
    assert both.corner_uv[len(one.tail) :] == pytest.approx(two.corner_uv / 2 + [0.5, 0.0])
    assert disjoint_union([one, replace(two, corner_uv=None)]).corner_uv is None
