"""Curved meshes: shared nodes, order of the error, and triangles that fold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from fitted import DATASETS, REGISTRY, config, fitted, fitted_linearly

from orbiframe.errors import UsageError
from orbiframe.fitting.pipeline import fit
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces import geodesic_faces
from orbiframe.surfaces.curved_triangles import curved_mesh, joined_meshes, node_exponents
from orbiframe.surfaces.geodesic_faces import GeodesicFaces, input_faces
from orbiframe.testing.reference import reference_triangulations
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

SPOT = DATASETS.parents[1] / "shared" / "meshes" / "odedstein_spot_control.obj"


@dataclass(frozen=True)
class Bean:
    """A surface in closed form over the sphere, whose atlas has one patch: a bent ellipsoid."""

    def evaluate(self, points: Points) -> np.ndarray:
        x, y, z = points.x.T
        return np.stack([1.5 * x, y + 0.3 * x**2, 0.8 * z + 0.2 * np.sin(2 * x)], axis=1)


def sphere_faces() -> GeodesicFaces:
    triangulation = reference_triangulations()["tetrahedron"]
    assert triangulation.orbifold.atlas.patch_count == 1
    return GeodesicFaces.of_triangulation(GeodesicTriangulation.of_map(triangulation))


def monomials(order: int, barycentric: np.ndarray) -> np.ndarray:
    """All products of barycentric coordinates of this degree, in which elements are polynomials."""
    powers = [(i, j, order - i - j) for i in range(order + 1) for j in range(order + 1 - i)]
    return np.stack([np.prod(barycentric ** np.array(power), axis=1) for power in powers], axis=1)


def small_triangles(density: int) -> np.ndarray:
    """The triangles in which one is cut by lines parallel to its sides, in barycentric coordinates, sorted rows."""
    found = []
    for i in range(density):
        for j in range(density - i):
            found.append([(i, j), (i + 1, j), (i, j + 1)])
            if i + j < density - 1:
                found.append([(i + 1, j), (i + 1, j + 1), (i, j + 1)])
    places = np.array(found) / density
    return np.concatenate([1 - places.sum(axis=2, keepdims=True), places], axis=2)


def largest_error(surface, faces: GeodesicFaces, order: int, density: int) -> float:
    """Between the elements and the surface at the same parameters, at points that are no nodes."""
    mesh = curved_mesh(surface, faces, order, density)
    inside = np.array([[0.6, 0.3, 0.1], [0.25, 0.3, 0.45], [0.1, 0.13, 0.77], [0.5, 0.5, 0.0]])
    shape = monomials(order, inside) @ np.linalg.inv(monomials(order, node_exponents(order) / order))
    found = np.einsum("pn,eni->epi", shape, mesh.nodes[mesh.elements])
    place = np.einsum("pc,eci->epi", inside, small_triangles(density)).reshape(-1, 3)
    count = faces.gluing.face_count
    wanted = surface.evaluate(faces.locate(np.repeat(np.arange(count), len(place)), np.tile(place, (count, 1))))
    return float(np.linalg.norm(found.reshape(-1, 3) - wanted, axis=1).max())


@pytest.mark.parametrize("order", range(1, 7))
def test_the_error_falls_by_one_order_more_than_that_of_the_elements(order):
    one, two = (largest_error(Bean(), sphere_faces(), order, density) for density in (2, 4))
    assert order + 0.8 < np.log2(one / two) < order + 2.2  # even orders gain some by symmetry


def test_the_error_on_a_fitted_surface():
    """576 triangles of a torus: smooth functions, wider than the elements."""
    surface = fitted_linearly("torus.off", 60).surface
    faces = input_faces(surface)
    for order in (1, 2, 3):
        one, two = (largest_error(surface, faces, order, density) for density in (2, 4))
        assert np.log2(one / two) > order + 0.6


@pytest.mark.parametrize("name", ["plate_genus2_coarse.off", "klein_bottle.off", "projective_plane.off"])
@pytest.mark.parametrize(("order", "density"), [(1, 1), (2, 1), (3, 2), (6, 1)])
def test_neighbours_share_the_nodes_of_their_side_and_no_others(name, order, density):
    surface = fitted(name).surface
    faces = input_faces(surface)
    mesh = curved_mesh(surface, faces, order, density)
    count, chi = faces.gluing.face_count, surface.orbifold.euler_characteristic
    assert mesh.elements.shape == (count * density**2, (order + 1) * (order + 2) // 2)
    # A grid of order times density on every triangle: V + E + F = chi + 2 E, and E = 3 F / 2.
    fine = order * density
    assert len(mesh.nodes) == chi + count * fine**2 // 2
    assert np.array_equal(np.unique(mesh.elements), np.arange(len(mesh.nodes)))
    sides: dict[tuple[int, ...], int] = {}
    for element in mesh.elements.tolist():
        for k, end in ((0, 1), (1, 2), (2, 0)):
            inner = element[3 + k * (order - 1) : 3 + (k + 1) * (order - 1)]
            side = (element[k], *inner, element[end])
            key = min(side, side[::-1])
            sides[key] = sides.get(key, 0) + 1
    assert set(sides.values()) == {2}
    assert len(np.unique(np.round(mesh.nodes, 9), axis=0)) == len(mesh.nodes)


def test_every_node_lies_where_its_barycentric_coordinates_say():
    surface = fitted("klein_bottle.off").surface
    faces = input_faces(surface)
    mesh = curved_mesh(surface, faces, 4)
    for element, place in enumerate(mesh.elements[:40]):
        weights = node_exponents(4) / 4
        x = surface.evaluate(faces.locate(np.full(len(weights), element), weights))
        assert np.abs(mesh.nodes[place] - x).max() < 1e-9


def test_the_elements_of_order_2_have_the_area_of_the_torus():
    """4 pi^2 R r for radii 3 and 1, by the three points of a rule of degree 2 on every element."""
    surface = fitted("round torus", 300).surface
    mesh = curved_mesh(surface, input_faces(surface), 2)
    points = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6
    step = 1e-5
    shapes = []
    for axis in ([1, -1, 0], [1, 0, -1]):
        ahead, behind = (monomials(2, points + sign * step * np.array(axis)) for sign in (1, -1))
        shapes.append((ahead - behind) / (2 * step) @ np.linalg.inv(monomials(2, node_exponents(2) / 2)))
    u, v = (np.einsum("pn,eni->epi", shape, mesh.nodes[mesh.elements]) for shape in shapes)
    area = np.linalg.norm(np.cross(u, v), axis=2).mean() / 2 * len(mesh.elements)
    assert area == pytest.approx(4 * np.pi**2 * 3, rel=1e-3)


def test_folded_triangles_give_way_to_the_delaunay_triangles_of_the_vertices(monkeypatch):
    surface = fitted("plate_genus2_coarse.off").surface
    assert input_faces(surface).gluing is surface.refinement.coarse
    plain = GeodesicFaces.whole.fget
    monkeypatch.setattr(
        geodesic_faces.GeodesicFaces,
        "whole",
        property(lambda faces: faces.gluing is not surface.refinement.coarse and plain(faces)),
    )
    mended = input_faces(surface)
    assert mended.whole
    count = surface.refinement.coarse.face_count
    assert mended.gluing.face_count == count
    at_corners = np.repeat(np.arange(count), 3), np.tile(np.eye(3), (count, 1))
    corners, vertices = surface.evaluate(mended.locate(*at_corners)), surface.evaluate(surface.points(*at_corners))
    assert set(map(tuple, np.round(corners, 6) + 0.0)) == set(map(tuple, np.round(vertices, 6) + 0.0))


def test_a_turned_triangle_is_noticed():
    faces = sphere_faces()
    assert faces.whole
    corners = faces.corners.copy()
    corners[0, 0] = -corners[0, 0]
    assert not faces._replace(corners=corners).whole
    corners = faces.corners.copy()
    corners[0, 0] = corners[0, 1]
    assert not faces._replace(corners=corners).whole


@pytest.mark.long
@pytest.mark.skipif(not SPOT.exists(), reason="shared/meshes is not here")
@pytest.mark.filterwarnings("ignore:the texture coordinates of the mesh")
def test_a_cow_of_which_two_triangles_fold():
    surface = fit(SPOT, config(600), REGISTRY).surface
    faces = input_faces(surface)
    assert faces.whole
    assert faces.gluing is not surface.refinement.coarse


def test_several_meshes_side_by_side():
    one = curved_mesh(Bean(), sphere_faces(), 2)
    both = joined_meshes([one, one])
    assert len(both.nodes) == 2 * len(one.nodes)
    assert np.array_equal(both.elements[len(one.elements) :], one.elements + len(one.nodes))


@pytest.mark.parametrize("order", [0, 7])
def test_orders_that_are_not_made(order):
    with pytest.raises(UsageError, match="give 1 to 6"):
        curved_mesh(Bean(), sphere_faces(), order)
