"""A few B-spline faces: near the surface, smooth across edges, and a closed solid for Open CASCADE."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from fitted import DATASETS, fitted as fit_of
from late import Late
from orbiframe_exact import few_faces, quad_domain as quad_domain_module
from orbiframe_exact.complete_spline import evaluate, evaluate_grid
from orbiframe_exact.faces_of_surface import described, fitted
from orbiframe_exact.few_faces import FewFaces
from orbiframe_exact.quad_domain import _divided, _matching, default_count, quad_domain
from orbiframe_exact.quad_places import places_in_quads
from scipy.spatial import cKDTree

from orbiframe import Points, read
from orbiframe.meshes import blocks_near
from orbiframe.triangulations import girth

opened, shared_edges, open_cascade = (
    Late("opened_shapes", needs="OCP.gp"),
    Late("shared_edges", needs="OCP.gp"),
    Late("orbiframe_exact.open_cascade", needs="OCP.gp"),
)

SHAPES = ["plate_genus2_coarse.off", "torus.off", "klein_bottle.off", "cube.off", "projective_plane.off"]


def corners(count: int) -> tuple[np.ndarray, np.ndarray]:
    return np.tile([0.0, 1, 1, 0], count), np.tile([0.0, 0, 1, 1], count)


def diagonal(surface) -> float:
    flat = surface.triangulation
    places = surface.basis.values(Points(flat.patch, flat.points), surface.coefficients)
    return float(np.linalg.norm(np.ptp(places, axis=0)))


@pytest.mark.parametrize("name", SHAPES)
def test_derivatives_are_those_of_differences(name):
    points = quad_domain(fit_of(name).surface, 20).points
    rng = np.random.default_rng(3)
    quad = rng.integers(0, len(points.corners), 40)
    s, t = rng.uniform(0.1, 0.9, (2, 40))
    _, fs, ft, fst = points.jets(quad, s, t, 2)
    h = 1e-4

    def at(i: float, j: float) -> np.ndarray:
        return points.jets(quad, s + i * h, t + j * h, 0)[0]

    size = np.abs(fs).max()
    assert np.abs((at(1, 0) - at(-1, 0)) / (2 * h) - fs).max() < 1e-4 * size
    assert np.abs((at(0, 1) - at(0, -1)) / (2 * h) - ft).max() < 1e-4 * size
    mixed = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h * h)
    assert np.abs(mixed - fst).max() < 1e-3 * np.abs(fst).max()


@pytest.mark.parametrize("name", SHAPES)
def test_quadrilaterals_cover_x_h_and_agree_on_their_sides(name):
    surface = fit_of(name).surface
    domain = quad_domain(surface, 20)
    orbifold, geometry = surface.orbifold, surface.orbifold.geometry
    assert domain.count >= 20
    x = geometry.project(domain.points.corners)
    halves = (geometry.triangle_area(x[:, 0], x[:, i], x[:, i + 1]) for i in (1, 2))
    assert sum(area.sum() for area in halves) == pytest.approx(orbifold.area, rel=1e-6)
    assert domain.count == domain.ends.max() + 1 - orbifold.euler_characteristic
    few = FewFaces(domain, 1.0)
    u = np.linspace(0, 1, 7)
    places = []
    for sides in few.sides.tolist():
        for side in sides:
            places.append(domain.points.jets(np.full(len(u), side // 4), *few.along(side, u), 0)[0])
    one, other = np.array(places[::2]), np.array(places[1::2])
    assert np.abs(one - other).max() < 1e-8


def test_faces_are_blocks_of_the_input_where_it_has_some():
    """The plate of 50 unit squares and the torus of 24 x 12 quads; corners of faces are corners of blocks in space."""
    for name, count in (("plate_genus2_coarse.off", 50), ("torus.off", 18)):
        surface, mesh = fit_of(name).surface, read(DATASETS / name)
        blocks = blocks_near(mesh.tail.reshape(-1, 4), default_count(surface))
        assert blocks is not None
        domain = quad_domain(surface, default_count(surface), blocks)
        assert domain.count == count
        corner = domain.points.jets(np.repeat(np.arange(count), 4), *corners(count), 0)[0].reshape(count, 4, 3)
        own = surface.basis.values(surface.vertex_points, surface.coefficients)[: len(mesh.vertices)]
        there = own[blocks]
        gap = np.linalg.norm(corner[:, None, :, None] - there[None, :, None, :], axis=-1)
        met = (gap < 1e-6).any(axis=3).all(axis=2)
        assert met.sum() >= 0.9 * count
    assert blocks_near(mesh.tail.reshape(-1, 4), 36) is None


def test_blocks_far_from_square_count_for_nothing(monkeypatch):
    surface, mesh = fit_of("torus.off").surface, read(DATASETS / "torus.off")
    blocks = blocks_near(mesh.tail.reshape(-1, 4), 16)
    monkeypatch.setattr(quad_domain_module, "_SQUARE_ENOUGH", 1.0)
    assert quad_domain(surface, 16, blocks).count == quad_domain(surface, 16).count == 16


def test_the_matching_is_the_best_of_all():
    rng = np.random.default_rng(5)
    for _ in range(20):
        pairs = np.array(list(itertools.combinations(range(6), 2))).T
        worth = rng.normal(size=pairs.shape[1])
        best = max(
            sum(worth[list(chosen)])
            for chosen in itertools.combinations(range(pairs.shape[1]), 3)
            if len(set(pairs[:, list(chosen)].ravel().tolist())) == 6
        )
        assert worth[_matching(pairs, worth, 6)].sum() == pytest.approx(best)
    assert _matching(np.array([[0, 0], [1, 2]]), np.ones(2), 4) is None


@pytest.mark.parametrize("name", ["plate_genus2_coarse.off", "klein_bottle.off", "cube.off"])
def test_faces_are_near_the_surface_and_share_edges_and_planes(name):
    surface = fit_of(name).surface
    found = fitted(surface)
    said = described(found, surface, 1e-4)
    assert said["reached"]
    assert said["faces"] <= 40 + 8 * abs(surface.orbifold.euler_characteristic)
    rng, size = np.random.default_rng(1), diagonal(surface)
    for quad, (breaks, poles) in found.faces.items():
        s, t = rng.random((2, 30))
        wanted = found.domain.points.jets(np.full(30, quad), s, t, 0)[0]
        gap = [evaluate_grid(breaks, poles, s[[i]], t[[i]], (0, 0))[0, 0] - wanted[i] for i in range(30)]
        assert np.linalg.norm(gap, axis=1).max() < 2e-4 * size
        for k in range(4):
            u = np.sort(rng.random(9))
            edge = found.domain.edge[quad, k]
            curve = evaluate(found.edge_breaks[edge], found.edge_poles[edge], u)
            places = [found.along(4 * quad + k, u[[i]]) for i in range(9)]
            border = [evaluate_grid(breaks, poles, *place, (0, 0))[0, 0] for place in places]
            assert np.abs(curve - border).max() < 1e-9


def test_without_common_planes_neighbours_meet_at_an_angle(monkeypatch):
    """The mutant of what makes faces smooth: derivatives across borders that keep their part off the common plane."""
    surface = fit_of("plate_genus2_coarse.off").surface
    good = fitted(surface)
    plain = FewFaces._rim

    def careless(self, quad, k, breaks, border):
        curve, tangent, _ = plain(self, quad, k, breaks, border)
        return curve, tangent, border[0]

    monkeypatch.setattr(FewFaces, "_rim", careless)
    good._fit_faces(list(range(good.domain.count)))
    before = good.angle.max()
    good._rough_faces()
    assert before <= few_faces.ANGLE
    assert good.angle.max() > 1.5 * before


@pytest.mark.long
@pytest.mark.parametrize("suffix", [".step", ".iges"])
@pytest.mark.parametrize("name", ["plate_genus2_coarse.off", "torus.off", "klein_bottle.off", "cube.off"])
def test_open_cascade_reads_a_closed_shape_of_the_same_volume(name, suffix, tmp_path):
    surface = fit_of(name).surface
    path = tmp_path / f"surface{suffix}"
    write = open_cascade.write_step if suffix == ".step" else open_cascade.write_iges
    said = write(path, surface, exact=False)
    assert said["valid"]
    shape = opened.read_back(path)
    assert opened.is_valid(shape)
    if surface.orbifold.orientable:
        assert opened.is_solid(shape)
        fine = surface.tessellate(12)
        corners = fine.vertices[fine.triangles]
        assert opened.volume(shape) == pytest.approx(np.linalg.det(corners).sum() / 6, rel=5e-3)
    else:
        assert opened.is_shell(shape)
    if suffix == ".step":
        met = shared_edges.meeting(shape)
        assert met.faces == [2] * (2 * said["faces"])
        assert met.gap < 1e-6
        assert met.angle < 0.11


@pytest.mark.long
def test_a_face_that_meets_a_vertex_twice_is_read_whole(tmp_path):
    """Three crosscaps have faces that no reader finds in the square by their edges in space alone."""
    surface, path = fit_of("three_crosscaps.off").surface, tmp_path / "surface.step"
    assert quad_domain(surface, default_count(surface)).meets_itself.any()
    said = open_cascade.write_step(path, surface, exact=False)
    assert said["valid"]
    met = shared_edges.meeting(opened.read_back(path), 7)
    assert met.faces == [2] * (2 * said["faces"])
    assert met.gap < 1e-6


@pytest.mark.long
def test_valid_is_what_the_file_is(tmp_path, monkeypatch):
    """Without the lines in the squares of its faces the same shape is not what is read again, and that is told."""
    monkeypatch.setattr(quad_domain_module.QuadDomain, "meets_itself", np.zeros(1, dtype=bool))
    surface = fit_of("three_crosscaps.off").surface
    assert not open_cascade.write_step(tmp_path / "surface.step", surface, exact=False)["valid"]


def test_a_tolerance_and_a_number_are_kept():
    surface = fit_of("torus.off").surface
    coarse, fine = fitted(surface, 30, 1e-3), fitted(surface, 30, 1e-6)
    assert coarse.domain.count == fine.domain.count == 30
    for tolerance, found in ((1e-3, coarse), (1e-6, fine)):
        assert max(found.error.values()) <= tolerance * diagonal(surface) * (1 + 1e-9)
    poles = [sum(p.size for _, p in found.faces.values()) for found in (coarse, fine)]
    assert poles[0] < poles[1]


def test_limbs_ask_for_more_faces():
    torus, plate = (fit_of(name).surface for name in ("torus.off", "plate_genus2_coarse.off"))
    energy = girth(torus.triangulation).energy
    assert 5 < energy < 20
    assert default_count(torus) == 16 + round(energy / 5)
    assert 32 <= default_count(plate) <= 32 + 24


@pytest.mark.parametrize("name", SHAPES)
def test_parameters_are_found_again(name):
    points = quad_domain(fit_of(name).surface, 20).points
    rng = np.random.default_rng(4)
    quad, (s, t) = rng.integers(0, len(points.corners), 60), rng.random((2, 60))
    corners = points.corners[quad]
    weights = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=1)
    x = 3 * np.einsum("nk,nki->ni", weights, corners)
    assert np.abs(np.stack(points.parameters(quad, x)) - (s, t)).max() < 1e-9


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("make", [quad_domain, _divided])
def test_vertices_are_found_in_the_faces(name, make):
    surface = fit_of(name).surface
    domain = make(surface, 20)
    quad, s, t, area = places_in_quads(domain)
    there = domain.points.jets(quad, s, t, 0)[0]
    own = surface.basis.values(surface.vertex_points, surface.coefficients)
    gap, vertex = cKDTree(own).query(there)
    assert gap.max() < 1e-8
    assert np.sort(vertex).tolist() == list(range(len(own)))
    mesh = surface.triangulation.polyhedron
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    assert area.sum() == pytest.approx(3 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def test_where_no_domain_is_convex_triangles_are_divided_in_three(monkeypatch):
    """All turns at corners are to the left, and the faces are as near and as smooth as others."""
    surface = fit_of("plate_genus2_coarse.off").surface
    real = quad_domain_module._paired
    monkeypatch.setattr(quad_domain_module, "_paired", lambda *given: (real(*given)[0], -5.0))
    found = fitted(surface, 40)
    x = found.domain.points.corners
    for k in range(4):
        assert (np.linalg.det(np.stack([x[:, k - 1], x[:, k], x[:, (k + 1) % 4]], axis=1)) > 0).all()
    said = described(found, surface, 1e-4)
    assert said["reached"]
    assert said["faces"] % 3 == 0
    assert said["faces"] > 40


def test_domains_that_are_not_convex_are_passed_over(monkeypatch):
    surface, tried = fit_of("torus.off").surface, []
    real = quad_domain_module._paired

    def worse(*given):
        tried.append(real(*given)[0])
        return tried[-1], (-5.0, -4.0, 0.1)[len(tried) - 1]

    monkeypatch.setattr(quad_domain_module, "_paired", worse)
    assert quad_domain(surface, 20) is tried[2]
    assert len(tried) == 3
