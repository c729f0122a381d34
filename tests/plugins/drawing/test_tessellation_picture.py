"""Tessellations of X by lifted faces, and surfaces in space: what is drawn where."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from orbiframe_drawing.picture import Raster
from orbiframe_drawing.solid import Solid3D
from orbiframe_drawing.solid_picture import cut_picture, edge_chains, surface_picture
from orbiframe_drawing.tessellation_picture import tessellation_picture

from orbiframe import Config, Polyhedron, Registry, Word, fit, read
from orbiframe.delaunay import poisson_disc, polygon_triangulation
from orbiframe.meshes.orientation import reversed_faces
from orbiframe.triangulations import Tessellation
from orbiframe.words.word import text_of

DATASETS = Path(__file__).parents[3] / "datasets"
REGISTRY = Registry.discover()


@pytest.fixture(scope="module")
def plate():
    polyhedron = read(DATASETS / "plate_genus2_coarse.off", REGISTRY)
    return polyhedron, fit(polyhedron, Config.load(overrides=["basis.size=60"]), REGISTRY).surface


@pytest.fixture(scope="module")
def tessellation(plate):
    polyhedron, surface = plate
    return Tessellation.of_map(polyhedron, surface.refinement, surface.triangulation)


def polygon_area(geometry, corners):
    """Area of geodesic polygons (n, m, 3), by their fans."""
    first, a, b = corners[:, :1], corners[:, 1:-1], corners[:, 2:]
    return geometry.triangle_area(np.broadcast_to(first, a.shape), a, b).sum(axis=1)


def test_one_lift_of_every_face_covers_the_surface_once(tessellation, plate):
    """Gauss and Bonnet: the faces at home have the area of X/H."""
    copies = list(tessellation.copies(4.0))
    home = [c.corners[c.home] for c in copies]
    assert sum(map(len, home)) == plate[0].face_count == tessellation.face_count
    area = sum(np.abs(polygon_area(tessellation.geometry, x)).sum() for x in home)
    assert area == pytest.approx(4 * np.pi, rel=1e-6)


def test_lifts_of_faces_share_their_edges(tessellation):
    """Near the middle every edge of a lifted face is an edge of exactly one other one."""
    geometry = tessellation.geometry
    corners = np.concatenate([c.corners for c in tessellation.copies(4.5)])
    middles = geometry.project(corners + np.roll(corners, -1, axis=1)).reshape(-1, 3)
    near = middles[geometry.distance(geometry.origin, middles) < 1.5]
    gaps = np.linalg.norm(near[:, None] - middles, axis=2)
    assert ((gaps < 1e-6).sum(axis=1) == 2).all()
    assert len(near) > 50


def test_another_middle_moves_the_tessellation(tessellation, plate):
    """The vertex that is asked for is a corner of faces at the origin."""
    triangulation = plate[1].triangulation
    patch, x = int(triangulation.patch[5]), triangulation.points[5]
    corners = np.concatenate([c.corners.reshape(-1, 3) for c in tessellation.copies(4.0, patch, x)])
    at_origin = tessellation.geometry.distance(tessellation.geometry.origin, corners) < 1e-7
    valence = int((plate[0].tail == 5).sum())
    assert at_origin.sum() == valence


@pytest.mark.parametrize("name", ["torus", "klein_bottle", "projective_plane", "sphere"])
def test_tessellations_of_other_surfaces_have_one_lift_of_every_face(name):
    polyhedron = read(DATASETS / f"{name}.off", REGISTRY)
    surface = fit(polyhedron, Config.load(overrides=["basis.size=50"]), REGISTRY).surface
    found = Tessellation.of_map(polyhedron, surface.refinement, surface.triangulation)
    home = [c.corners[c.home] for c in found.copies(4.0)]
    assert sum(map(len, home)) == polyhedron.face_count
    area = sum(np.abs(polygon_area(found.geometry, x)).sum() for x in home)
    assert area == pytest.approx(found.orbifold.area, rel=1e-5)
    picture = tessellation_picture(found)
    assert picture.shapes[0].paths
    if name == "sphere":
        assert len(picture.shapes[0].paths) < polyhedron.face_count


def test_triangles_of_sites_are_drawn_with_their_vertices():
    word = Word.parse("aabbcc")
    group = REGISTRY.load("group", "regular-polygon")(REGISTRY.load("geometry", "h2")(), word)
    triangulation = poisson_disc(polygon_triangulation(group), 0.5)
    found = Tessellation.of_triangulation(triangulation)
    home = np.concatenate([c.corners[c.home] for c in found.copies(3.5)])
    assert len(home) == triangulation.face_count
    assert np.abs(polygon_area(found.geometry, home)).sum() == pytest.approx(2 * np.pi, rel=1e-6)


def test_a_larger_radius_shows_more(tessellation):
    few, many = (tessellation_picture(tessellation, radius=r) for r in (2.0, 4.0))
    count = [sum(len(path) for shape in p.shapes for path in shape.paths) for p in (few, many)]
    assert count[1] > 2 * count[0]


# ---- surfaces in space ----------------------------------------------------------------------------------------------

CUBE = Polyhedron.from_faces(
    np.array([(x, y, z) for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)]),
    [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)],
)


def edges_of(polyhedron):
    ends = np.stack([polyhedron.tail, polyhedron.head], axis=1)[polyhedron.representative]
    return list(polyhedron.vertices[ends])


def length(paths):
    return sum(np.linalg.norm(c.points[1] - c.points[0]) for path in paths for c in path)


def test_of_a_cube_nine_edges_are_seen_and_three_are_hidden():
    solid = Solid3D(CUBE, 300.0)
    seen = [length(solid.lines([edge])) for edge in edges_of(CUBE)]
    hidden = [length(solid.lines([edge], hidden=True)) for edge in edges_of(CUBE)]
    whole = [float(np.linalg.norm(np.diff(solid.place(edge)[:, :2], axis=0))) for edge in edges_of(CUBE)]
    assert sum(a > 0.97 * w for a, w in zip(seen, whole, strict=True)) == 9
    assert sum(a > 0.9 * w for a, w in zip(hidden, whole, strict=True)) == 3


def test_the_image_of_a_cube_covers_its_outline():
    """The area of the hexagon that is the shadow of the unit cube: the sum of the parts of the direction."""
    solid = Solid3D(CUBE, 300.0)
    image = solid.image()
    share = (image.colours[..., 3] / 255).mean()
    left, bottom, right, top = image.box
    scale = 300.0 / np.ptp(CUBE.vertices @ solid.axes[0])
    assert share * (right - left) * (top - bottom) == pytest.approx(np.abs(solid.axes[2]).sum() * scale**2, rel=0.01)


def test_faces_towards_the_light_are_brighter():
    solid = Solid3D(CUBE, 300.0)
    colours = solid.image().colours
    middle = CUBE.vertices.mean(axis=0)

    def brightness(face):
        x, y, _ = solid.place((middle + face)[None])[0]
        left, bottom, right, top = solid.image().box
        row, column = (top - y) / (top - bottom) * len(colours), (x - left) / (right - left) * colours.shape[1]
        return int(colours[int(row), int(column), 0])

    assert brightness(np.array([0, 0, 0.5])) > brightness(np.array([0, -0.5, 0])) + 20


@pytest.mark.parametrize("smooth", [False, True])
def test_a_face_is_lit_the_same_from_both_sides(smooth):
    inward = reversed_faces(CUBE, np.ones(CUBE.face_count, dtype=bool))
    images = [Solid3D(one, 300.0, smooth=smooth).image().colours for one in (CUBE, inward)]
    assert len(np.unique(images[0].reshape(-1, 4), axis=0)) > 3
    np.testing.assert_array_equal(*images)


def test_the_surface_stands_beside_its_tessellation(plate):
    polyhedron, surface = plate
    picture = surface_picture(surface, polyhedron)
    (raster,) = [item for item in picture.items if isinstance(item, Raster)]
    circles = picture.shapes[-1].paths[0]
    assert raster.box[2] < min(curve.points[:, 0].min() for curve in circles)
    # The lines on it are images of edges of the polyhedron: at most as many chains as there are edges.
    assert picture.shapes[0].paths


@pytest.mark.parametrize("boundary", ["cap", "collar"])
def test_the_lines_on_a_surface_with_a_boundary_are_its_edges(boundary):
    torus = read(DATASETS / "torus.off")
    quads = torus.tail.reshape(-1, 4)
    middle = torus.vertices[quads].mean(axis=1)[:, 0]
    mesh = Polyhedron.from_faces(torus.vertices, quads[middle < 0.85 * middle.max()])
    made = fit(mesh, boundary=boundary, size=150, fast=True, progress=False)
    chains = edge_chains(made.input, made.surface, 3)
    points = made.surface.tessellate(3).vertices[chains]
    ends = np.stack([made.input.tail, made.input.head], axis=1)[made.input.representative]
    assert len(chains) == len(ends)
    assert np.abs(points[:, [0, -1]] - made.input.vertices[ends]).max() < 0.02
    # Between its ends an edge goes straight on.
    steps = np.linalg.norm(np.diff(points, axis=1), axis=2)
    assert (steps.sum(axis=1) < 1.1 * np.linalg.norm(points[:, -1] - points[:, 0], axis=1)).all()


def test_loops_and_sides_of_one_letter_have_one_colour(plate):
    polyhedron, _ = plate
    marking = REGISTRY.load("marker", "tree-cotree")(polyhedron)
    group = REGISTRY.load("group", "regular-polygon")(REGISTRY.load("geometry", "h2")(), marking.word)
    picture = cut_picture(marking, group)
    loops, sides = picture.labels[:4], picture.labels[4:]
    assert [label.text for label in loops] == ["a", "b", "c", "d"]
    assert [label.text for label in sides] == [text_of(abs(letter)) for letter in marking.word.letters]
    colour = {label.text: label.colour for label in loops}
    assert all(colour[label.text] == label.colour for label in sides)
