"""Geodesics of X/H: against closed forms, brute force over tiles, and the laws of a metric, in any atlas."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import reference_surfaces as surfaces
from hypothesis import given, settings, strategies as st
from orbiframe_groups.finite import FiniteGroup
from orbiframe_groups.lattice import lattice_group
from orbiframe_invariants.geodesics import Geodesics
from reference_geometries import GEOMETRIES

from orbiframe import GeometryError, Points, Word
from orbiframe.groups import PolygonGroup, regular_polygon
from orbiframe.planes import PreciseIsometry
from orbiframe.testing.reference import RECIPES, reference_triangulations

S2, E2, H2 = GEOMETRIES
GROUPS = {
    "sphere": lambda: FiniteGroup(S2, Word.parse("aA")),
    "projective plane": lambda: FiniteGroup(S2, Word.parse("aa")),
    "torus": lambda: lattice_group(E2, Word.parse("abAB"), second=(2.3, 1.1)),
    "Klein bottle": lambda: lattice_group(E2, Word.parse("abaB")),
    "Bolza": lambda: PolygonGroup(regular_polygon(H2, Word.parse("abcdABCD"))),
    "three crosscaps": lambda: PolygonGroup(regular_polygon(H2, Word.parse("aabbcc"))),
}
each_group = pytest.mark.parametrize("name", GROUPS)


@cache
def of(name: str) -> Geodesics:
    return Geodesics.of_group(GROUPS[name]())


@cache
def of_mesh(name: str) -> Geodesics:
    return Geodesics(reference_triangulations()[name].orbifold)


def random_points(geodesics: Geodesics, count: int, seed: int) -> Points:
    return surfaces.random_points(geodesics.orbifold, count, np.random.default_rng(seed))


def random_velocities(geodesics: Geodesics, x: Points, speed: float, seed: int) -> np.ndarray:
    turn = np.random.default_rng(seed).uniform(0, 2 * np.pi, len(x.x))
    return np.einsum("nij,nj->ni", geodesics.geometry.frame(x.x), speed * np.stack([np.cos(turn), np.sin(turn)], 1))


@each_group
def test_distances_are_the_least_over_the_tiles(name: str) -> None:
    group, geodesics = GROUPS[name](), of(name)
    geometry = group.geometry
    x, y = random_points(geodesics, 40, 1), random_points(geodesics, 40, 2)
    tiles = group.tiles(np.pi if geometry.curvature > 0 else 3 * geodesics.orbifold.atlas.radius[0])
    brute = np.min([geometry.distance(x.x, geometry.act(g, y.x)) for g in tiles], axis=0)
    np.testing.assert_allclose(geodesics.distance(x, y), brute, atol=1e-11)


def test_the_torus_in_closed_form() -> None:
    geodesics = of("torus")
    x, y = random_points(geodesics, 50, 3), random_points(geodesics, 50, 4)
    n = np.arange(-9, 10)
    lattice = (n[:, None, None] * np.array([1.0, 0.0]) + n[:, None] * np.array([2.3, 1.1])).reshape(-1, 2)
    closed = np.hypot(*np.moveaxis((y.x - x.x)[:, None, 1:] + lattice, -1, 0)).min(axis=1)
    np.testing.assert_allclose(geodesics.distance(x, y), closed, atol=1e-14)


def test_the_sphere_and_the_projective_plane_in_closed_form() -> None:
    x, y = (random_points(of("sphere"), 50, seed) for seed in (5, 6))
    cosine = np.sum(x.x * y.x, axis=1)
    np.testing.assert_allclose(of("sphere").distance(x, y), np.arccos(cosine), atol=1e-7)
    np.testing.assert_allclose(of("projective plane").distance(x, y), np.arccos(np.abs(cosine)), atol=1e-7)


@settings(max_examples=12, deadline=None)
@given(st.sampled_from(list(GROUPS)), st.integers(0, 2**32 - 1))
def test_distance_is_a_metric(name: str, seed: int) -> None:
    geodesics = of(name)
    x, y, z = (random_points(geodesics, 20, seed + k) for k in range(3))
    xy, yz, xz = geodesics.distance(x, y), geodesics.distance(y, z), geodesics.distance(x, z)
    np.testing.assert_allclose(geodesics.distance(y, x), xy, atol=1e-10)
    np.testing.assert_allclose(geodesics.distance(x, x), 0, atol=1e-12)
    assert (xz <= xy + yz + 1e-10).all()


@settings(max_examples=12, deadline=None)
@given(st.sampled_from(list(GROUPS)), st.integers(0, 2**32 - 1))
def test_exp_inverts_log_and_paths_are_as_long_as_the_distance(name: str, seed: int) -> None:
    geodesics = of(name)
    x, y = random_points(geodesics, 20, seed), random_points(geodesics, 20, seed + 1)
    velocity, distance = geodesics.log(x, y), geodesics.distance(x, y)
    end, arriving = geodesics.exp(x, velocity)
    np.testing.assert_allclose(geodesics.distance(end, y), 0, atol=1e-9)
    np.testing.assert_allclose(geodesics.geometry.norm(end.x, arriving), distance, atol=1e-11)
    start, _ = geodesics.exp(end, -arriving)
    np.testing.assert_allclose(geodesics.distance(start, x), 0, atol=1e-9)
    middle = geodesics.between(x, y, np.full(20, 0.3))
    np.testing.assert_allclose(geodesics.distance(x, middle), 0.3 * distance, atol=1e-9)
    np.testing.assert_allclose(geodesics.distance(middle, y), 0.7 * distance, atol=1e-9)


@each_group
def test_long_geodesics_are_those_of_the_plane(name: str) -> None:
    """The end of a walk over X/H against the end of the geodesic in X, brought home by the group."""
    group, geodesics = GROUPS[name](), of(name)
    x = random_points(geodesics, 20, 7)
    velocity = random_velocities(geodesics, x, 7.0, 8)
    end, _ = geodesics.exp(x, velocity)
    far = group.reduce(group.geometry.exp(x.x, velocity))[0]
    np.testing.assert_allclose(geodesics.distance(end, Points(x.patch * 0, far)), 0, atol=1e-8)
    height = geodesics.geometry.distance(geodesics.geometry.origin, end.x)
    assert (height <= geodesics.orbifold.atlas.radius[end.patch] * (1 + 1e-6)).all()


def test_velocity_zero_stays() -> None:
    x = random_points(of("Bolza"), 5, 9)
    end, velocity = of("Bolza").exp(x, np.zeros((5, 3)))
    np.testing.assert_allclose(end.x, x.x, atol=1e-13)
    np.testing.assert_array_equal(velocity, np.zeros((5, 3)))


@pytest.mark.parametrize("name", ["torus", "klein_bottle", "octagon", "projective_plane"])
def test_two_patches_give_the_distances_of_one(name: str) -> None:
    one = surfaces.ALL[name]()
    geometry = one.geometry
    change = geometry.translation(0.4, 0.7) @ geometry.reflection(1.0)
    two = Geodesics(surfaces.in_two_patches(one, change))
    x, y = (surfaces.random_points(one, 30, np.random.default_rng(seed)) for seed in (1, 2))
    moved = two.geometry.act(geometry.inverse(change), y.x)
    options = [Points(np.ones_like(y.patch), frame) for frame in (moved, geometry.act(change, y.x))]
    wanted = Geodesics(one).distance(x, y)
    found = [np.abs(two.distance(x, option) - wanted).max() for option in options]
    assert min(found) < 1e-10


@pytest.mark.parametrize("name", sorted(RECIPES))
def test_atlases_of_meshes(name: str) -> None:
    """Atlases with many patches: symmetric, no longer than the edges of the mesh, and exp inverts log."""
    triangulation = reference_triangulations()[name]
    geodesics = of_mesh(name)
    x, y, z = (random_points(geodesics, 15, seed) for seed in (1, 2, 3))
    xy = geodesics.distance(x, y)
    np.testing.assert_allclose(geodesics.distance(y, x), xy, atol=1e-9)
    assert (geodesics.distance(x, z) <= xy + geodesics.distance(y, z) + 1e-9).all()
    end, _ = geodesics.exp(x, geodesics.log(x, y))
    np.testing.assert_allclose(geodesics.distance(end, y), 0, atol=1e-8)
    home = geodesics.home(x)
    np.testing.assert_allclose(geodesics.distance(home, x), 0, atol=1e-10)
    edge = triangulation.polyhedron.triangles[:20, :2]
    ends = [Points(triangulation.patch[k], triangulation.points[k]) for k in edge.T]
    lengths = geodesics.geometry.distance(triangulation.lifts[:20, 0], triangulation.lifts[:20, 1])
    assert (geodesics.distance(*ends) <= lengths + 1e-9).all()


@each_group
def test_the_area_of_a_triangle_is_its_angle_defect(name: str) -> None:
    geodesics = of(name)
    x, y, z = (random_points(geodesics, 40, seed) for seed in (11, 12, 13))
    found = geodesics.triangles(x, y, z)
    excess = found.angles.sum(axis=1) - np.pi
    np.testing.assert_allclose(geodesics.geometry.curvature * np.abs(found.areas), excess, atol=1e-10)
    np.testing.assert_allclose(found.sides[:, 0], geodesics.distance(x, y), atol=1e-12)
    np.testing.assert_allclose(found.sides[:, 2], geodesics.distance(x, z), atol=1e-12)


@pytest.mark.parametrize(
    ("name", "word", "length", "one_sided"),
    [
        ("torus", "a", np.hypot(2.3, 1.1), False),
        ("torus", "bbb", 3.0, False),
        ("Klein bottle", "a", 1.0, True),
        ("projective plane", "a", np.pi, True),
        ("Bolza", "a", 2 * np.arccosh(1 + np.sqrt(2)), False),
        ("three crosscaps", "a", 1.3169578969248166, True),
    ],
)
def test_closed_geodesics(name: str, word: str, length: float, one_sided: bool) -> None:
    group, geodesics = GROUPS[name](), of(name)
    found = geodesics.closed(group.precise_element(word))
    assert (found.length, found.one_sided) == (pytest.approx(length, abs=1e-11), one_sided)
    end, velocity = geodesics.exp(found.start, found.velocity * found.length)
    assert geodesics.distance(end, found.start)[0] < 1e-9
    assert geodesics.geometry.norm(end.x, velocity)[0] == pytest.approx(found.length)
    ring = found.points(48)
    after = Points(np.roll(ring.patch, -1), np.roll(ring.x, -1, axis=0))
    np.testing.assert_allclose(geodesics.distance(ring, after), found.length / 48, atol=1e-9)


def test_conjugate_loops_have_one_closed_geodesic() -> None:
    """The curve of c a b C is that of a b: its points lie on the other."""
    group, geodesics = GROUPS["Bolza"](), of("Bolza")
    one, other = (geodesics.closed(group.precise_element(word)) for word in ("ab", "cabC"))
    assert one.length == pytest.approx(other.length, abs=1e-10)
    ring, x = one.points(4000), other.points(5)
    for k in range(5):
        here = Points(np.repeat(x.patch[k], 4000), np.repeat(x.x[k : k + 1], 4000, axis=0))
        assert geodesics.distance(here, ring).min() < one.length / 4000


def test_the_identity_has_no_closed_geodesic() -> None:
    with pytest.raises(GeometryError, match="fixed point"):
        of("Bolza").closed(np.eye(3))
    with pytest.raises(GeometryError, match="fixed point"):
        of("Bolza").closed(PreciseIsometry.rotation(-1, [1.0]))
