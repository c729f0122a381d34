"""Smooth surfaces: derivatives against differences, curvature against closed forms, meshes on them, scale."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from fitted import REGISTRY, config, fitted, mesh_of
from reference_surfaces import triangulated as closed_form

from orbiframe.errors import FitError
from orbiframe.fitting import pipeline
from orbiframe.functions.basis import Basis
from orbiframe.meshes.bisection import bisected
from orbiframe.meshes.orientation import reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.meshes.surface_type import surface_type
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.testing.polyhedra import reference_polyhedra

NAMES = ["tetrahedron", "projective plane", "torus", "Klein bottle", "double torus"]
SIZE = 60


def some_points(surface: OrbifoldSurface, count: int, seed: int = 0) -> Points:
    rng = np.random.default_rng(seed)
    face = rng.integers(surface.refinement.coarse.face_count, size=count)
    return surface.points(face, rng.dirichlet([1, 1, 1], size=count))


def along(surface: OrbifoldSurface, points: Points, direction: tuple[float, float], step: float) -> np.ndarray:
    """The surface at a distance along the geodesics that leave the points in a direction of their frames."""
    geometry = surface.orbifold.geometry
    velocity = geometry.frame(points.x) @ np.array(direction) * step
    return surface.evaluate(Points(points.patch, geometry.exp(points.x, velocity)))


# ---- derivatives ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_first_derivatives_are_differences_along_geodesics(name: str) -> None:
    surface = fitted(name, SIZE).surface
    points = some_points(surface, 200)
    jet = surface.jet(points)
    np.testing.assert_allclose(jet.value, surface.evaluate(points), atol=1e-12)
    for k, direction in enumerate([(1.0, 0.0), (0.0, 1.0)]):
        h = 1e-3
        d = [
            (along(surface, points, direction, s * h) - along(surface, points, direction, -s * h)) / (2 * s * h)
            for s in (1, 2)
        ]
        error = np.abs(jet.first[:, k] - (4 * d[0] - d[1]) / 3).max()
        assert error < 1e-6 * np.abs(jet.first).max()


@pytest.mark.parametrize("name", NAMES)
def test_hessians_are_second_differences_along_geodesics(name: str) -> None:
    surface = fitted(name, SIZE).surface
    points = some_points(surface, 200)
    s11, s12, s22 = np.moveaxis(surface.jet(points).second, 1, 0)
    r = np.sqrt(0.5)
    for direction, expected in [((1.0, 0.0), s11), ((0.0, 1.0), s22), ((r, r), (s11 + 2 * s12 + s22) / 2)]:
        h = 1e-3
        middle = surface.evaluate(points)
        ends = along(surface, points, direction, h) + along(surface, points, direction, -h)
        error = np.abs((ends - 2 * middle) / h**2 - expected).max()
        assert error < 1e-3 * np.abs(expected).max()


@pytest.mark.parametrize("name", NAMES)
def test_normals_are_unit_and_across_the_tangents(name: str) -> None:
    surface = fitted(name, SIZE).surface
    points = some_points(surface, 100)
    normals, jet, bent = surface.normals(points), surface.jet(points), surface.curvature(points)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-14)
    np.testing.assert_allclose(normals, bent.normal, atol=1e-12)
    cross = np.cross(jet.first[:, 0], jet.first[:, 1])
    np.testing.assert_allclose(bent.element, np.linalg.norm(cross, axis=1), rtol=1e-12)
    np.testing.assert_allclose(normals * bent.element[:, None], cross, atol=1e-12 * bent.element.max())


@pytest.mark.parametrize("name", ["torus", "Klein bottle", "double torus", "plate_genus3.off"])
def test_a_point_is_the_same_seen_from_any_patch(name: str) -> None:
    surface = fitted(name, SIZE).surface
    atlas, geometry = surface.orbifold.atlas, surface.orbifold.geometry
    step = np.arange(1, len(atlas.tail))
    rng = np.random.default_rng(4)
    here = geometry.from_polar(rng.random(len(step)), rng.uniform(0, 2 * np.pi, len(step)))
    there = geometry.settle(geometry.act(atlas.isometry[step], here))
    seen = Points(atlas.head[step], here), Points(atlas.tail[step], there)
    a, b = (surface.evaluate(points) for points in seen)
    np.testing.assert_allclose(a, b, atol=1e-12 * surface.scale)
    first, second = (surface.curvature(points) for points in seen)
    np.testing.assert_allclose(first.gaussian, second.gaussian, atol=1e-8 * np.abs(first.gaussian).max())
    np.testing.assert_allclose(first.normal, second.normal * geometry.parity(atlas.isometry[step])[:, None], atol=1e-9)


# ---- curvature ------------------------------------------------------------------------------------------------------


@cache
def approximated(name: str, place: Callable[[np.ndarray], np.ndarray]) -> OrbifoldSurface:
    """The surface x -> place(x) over a closed-form X/H, by plain least squares with 120 wide Gaussians."""
    made = closed_form(name, 4)
    basis = REGISTRY.load("basis", "gaussian")(made.orbifold, made, size=120, width=3.0)
    count = made.polyhedron.face_count
    weights = np.tile([[0.6, 0.2, 0.2], [0.2, 0.6, 0.2], [0.2, 0.2, 0.6]], (count, 1))
    points = made.locate(np.repeat(np.arange(count), 3), weights)
    design = basis.design_matrix(points).toarray()
    coefficients = np.linalg.lstsq(design, place(points.x), rcond=1e-12)[0]
    return OrbifoldSurface(made, bisected(made.polyhedron, np.inf), basis, coefficients, np.zeros(3), 1.0)


def ball(x: np.ndarray) -> np.ndarray:
    return 2 * x


def ring(x: np.ndarray) -> np.ndarray:
    return revolved(*2 * np.pi * x[:, 1:].T)


def slanting_ring(x: np.ndarray) -> np.ndarray:
    """The same torus, where the coordinate lines do not meet at right angles."""
    u, v = 2 * np.pi * x[:, 1:].T
    return revolved(u, u + v)


def revolved(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.stack([(3 + np.cos(v)) * np.cos(u), (3 + np.cos(v)) * np.sin(u), np.sin(v)], axis=1)


def test_curvature_of_a_round_sphere() -> None:
    """Radius 2: K = 1/4; normals point outwards, so H = -1/2."""
    surface = approximated("sphere", ball)
    points = some_points(surface, 500)
    bent = surface.curvature(points)
    np.testing.assert_allclose(bent.gaussian, 0.25, atol=1e-4)
    np.testing.assert_allclose(bent.mean, -0.5, atol=1e-4)
    np.testing.assert_allclose(bent.normal, surface.evaluate(points) / 2, atol=1e-5)
    np.testing.assert_allclose(bent.element, 4, rtol=1e-4)


@pytest.mark.parametrize("place", [ring, slanting_ring])
def test_curvature_of_a_torus_of_revolution(place: Callable[[np.ndarray], np.ndarray]) -> None:
    """Radii 3 and 1: principal curvatures 1 and cos v / (3 + cos v), against the outward normal."""
    surface = approximated("torus", place)
    points = some_points(surface, 500)
    bent, x = surface.curvature(points), surface.evaluate(points)
    radius = np.hypot(x[:, 0], x[:, 1])
    other = (radius - 3) / radius
    for found, expected in ((bent.gaussian, other), (bent.mean, -(1 + other) / 2)):
        np.testing.assert_allclose(found, expected, atol=0.08)
        assert np.sqrt(np.mean((found - expected) ** 2)) < 0.02


def test_curvature_of_a_fitted_torus_of_revolution() -> None:
    surface = pipeline.fit(mesh_of("round torus"), config(400, "basis.width=2.0"), REGISTRY).surface
    points = some_points(surface, 500)
    bent, x = surface.curvature(points), surface.evaluate(points)
    radius = np.hypot(x[:, 0], x[:, 1])
    np.testing.assert_allclose((radius - 3) ** 2 + x[:, 2] ** 2, 1, atol=0.01)
    expected = (radius - 3) / radius
    assert np.sqrt(np.mean((bent.gaussian - expected) ** 2)) < 0.02
    outwards = np.stack([x[:, 0] * (1 - 3 / radius), x[:, 1] * (1 - 3 / radius), x[:, 2]], axis=1)
    assert (np.einsum("ni,ni->n", outwards, bent.normal) > 0.99).all()


# ---- meshes on the surface ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("density", [1, 3])
def test_tessellation_is_the_surface_of_the_input(name: str, density: int) -> None:
    result = fitted(name, SIZE)
    mesh = result.surface.tessellate(density)
    given = mesh_of(name)
    assert isinstance(given, Polyhedron)
    assert surface_type(mesh) == surface_type(given)
    assert mesh.face_count == density**2 * (given.face_sizes - 2).sum()
    if surface_type(mesh).orientable:
        assert not mesh.same.any()


@pytest.mark.parametrize("name", NAMES)
def test_vertices_do_not_depend_on_the_density(name: str) -> None:
    surface = fitted(name, SIZE).surface
    few, more = surface.tessellate(2), surface.tessellate(4)
    count = len(surface.refinement.coarse.vertices)
    np.testing.assert_array_equal(few.vertices[:count], more.vertices[:count])
    places = {tuple(np.round(v / surface.scale, 10)) for v in more.vertices}
    near = {tuple(np.round(v / surface.scale, 10)) for v in few.vertices}
    assert len(near - places) <= 0.01 * len(near)  # rounding at a boundary


@pytest.mark.parametrize("name", NAMES)
def test_normals_stand_on_the_side_of_the_faces(name: str) -> None:
    mesh = fitted(name, SIZE).surface.tessellate(12)
    assert mesh.normals is not None
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-12)
    areas = vector_areas(mesh)
    # At a vertex of a one-sided surface the faces need not agree: its normal suits the first of them.
    first = np.full(len(mesh.vertices), -1)
    first[mesh.tail[::-1]] = mesh.face[::-1]
    face = areas[first] / np.linalg.norm(areas[first], axis=1, keepdims=True)
    suits = np.einsum("ni,ni->n", face, mesh.normals) > 0
    assert suits.mean() > 0.96


@pytest.mark.parametrize("name", ["tetrahedron", "torus", "double torus"])
def test_orientation_is_that_of_the_input(name: str) -> None:
    def volume(mesh: Polyhedron) -> float:
        return float(np.linalg.det(mesh.vertices[mesh.triangles]).sum() / 6)

    given = mesh_of(name)
    assert isinstance(given, Polyhedron)
    outwards = fitted(name, SIZE).output
    turned = reversed_faces(given, np.ones(given.face_count, dtype=bool))
    inwards = pipeline.fit(turned, config(SIZE), REGISTRY).output
    sign = 1 if name != "torus" else np.sign(volume(fitted(name, SIZE).surface.refinement.coarse))
    assert sign * volume(outwards) > 0
    assert sign * volume(inwards) < 0


def test_a_basis_without_derivatives_gives_points_but_no_normals() -> None:
    surface = fitted("torus", SIZE).surface

    class Plain(Basis):
        def __init__(self) -> None:
            self.orbifold, self.size, self.smoothness = surface.basis.orbifold, surface.basis.size, 0

        def design_matrix(self, points):
            return surface.basis.design_matrix(points)

    plain = replace(surface, basis=Plain())
    mesh = plain.tessellate(2)
    np.testing.assert_allclose(mesh.vertices, surface.tessellate(2).vertices, atol=1e-12)
    assert mesh.normals is None
    with pytest.raises(FitError, match="derivatives"):
        plain.jet(some_points(plain, 3))


def test_no_points_at_all() -> None:
    surface = fitted("torus", SIZE).surface
    nothing = Points(np.zeros(0, dtype=np.intp), np.zeros((0, 3)))
    assert surface.evaluate(nothing).shape == (0, 3)
    assert surface.curvature(nothing).gaussian.shape == (0,)


def test_many_points_are_those_of_their_parts() -> None:
    surface = fitted("torus", SIZE).surface
    points = some_points(surface, 70_000)
    part = slice(65_000, 66_000)
    whole = surface.evaluate(points)
    np.testing.assert_allclose(whole[part], surface.evaluate(Points(points.patch[part], points.x[part])), atol=1e-13)


# ---- scale and place ------------------------------------------------------------------------------------------------


def moved(name: str, scale: float, shift: float) -> OrbifoldSurface:
    mesh = mesh_of(name)
    assert isinstance(mesh, Polyhedron)
    return pipeline.fit(mesh.with_vertices(mesh.vertices * scale + shift), config(SIZE), REGISTRY).surface


def test_a_mesh_scaled_and_moved_by_powers_of_two_gives_the_same_bits() -> None:
    surface, other = fitted("double torus", SIZE).surface, moved("double torus", 2.0**20, 2.0**30)
    np.testing.assert_array_equal(other.coefficients, surface.coefficients)
    np.testing.assert_array_equal(other.triangulation.points, surface.triangulation.points)
    points = some_points(surface, 100)
    expected = surface.evaluate(points) * 2.0**20 + 2.0**30
    np.testing.assert_allclose(other.evaluate(points), expected, atol=1e-6)


def test_a_mesh_scaled_by_a_million_and_moved_by_a_milliard_gives_the_same_map() -> None:
    """Coordinates have lost six digits to the shift, 1e-13 of the size is left.

    The functions may differ a little more: rounding decides which of two equally near centres a vertex belongs to.
    """
    rng = np.random.default_rng(6)
    mesh = reference_polyhedra()["double torus"]
    mesh = mesh.with_vertices(mesh.vertices + rng.normal(scale=0.05, size=mesh.vertices.shape))
    surface, other = (
        pipeline.fit(mesh.with_vertices(mesh.vertices * scale + shift), config(SIZE), REGISTRY).surface
        for scale, shift in ((1.0, 0.0), (1e6, 1e9))
    )
    np.testing.assert_allclose(other.triangulation.points, surface.triangulation.points, atol=1e-10)
    points = some_points(surface, 200)
    expected = surface.evaluate(points) * 1e6 + 1e9
    np.testing.assert_allclose(other.evaluate(points), expected, rtol=0, atol=2e-3 * other.scale)


@pytest.mark.parametrize("power", [-500, 500])
def test_tiny_and_huge_meshes(power: int) -> None:
    """1e-150 and 1e150: squares of coordinates are no longer numbers, curvatures still are."""
    surface, other = fitted("torus", SIZE).surface, moved("torus", 2.0**power, 0.0)
    points = some_points(surface, 50)
    np.testing.assert_allclose(other.evaluate(points), surface.evaluate(points) * 2.0**power, rtol=1e-9)
    a, b = surface.curvature(points), other.curvature(points)
    np.testing.assert_allclose(b.gaussian * 2.0**power * 2.0**power, a.gaussian, rtol=1e-6)
    np.testing.assert_allclose(b.mean * 2.0**power, a.mean, rtol=1e-6)
    assert other.total_curvature(2) == pytest.approx(surface.total_curvature(2), abs=1e-9)
    mesh = other.tessellate(2)
    assert mesh.normals is not None
    assert np.isfinite(mesh.vertices).all()
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-12)


def test_total_curvature_counts_every_triangle_once_in_chunks_of_any_size(monkeypatch) -> None:
    """Of 1,000 triangles, and of all but one, which then is a chunk of its own."""
    whole = fitted("torus", SIZE).surface
    expected = whole.total_curvature(4)
    for triangles in (1000, whole.triangulation.polyhedron.face_count - 1):
        monkeypatch.setattr("orbiframe.surfaces.surface._CHUNK", 16 * triangles)
        assert whole.total_curvature(4) == pytest.approx(expected, abs=1e-9)
