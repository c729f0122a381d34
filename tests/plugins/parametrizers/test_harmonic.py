"""Harmonic maps: derivatives, the minimum and its independence of start and numbering, embedding, bad meshes."""

from __future__ import annotations

from dataclasses import replace

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.developing import developed
from orbiframe_parametrizers.harmonic import harmonic
from orbiframe_parametrizers.harmonic_energy import HarmonicEnergy, _square_distance_derivatives, minimised
from reference_meshes import (
    connected_sum,
    dataset,
    edge_lengths,
    geometry,
    grid,
    klein_quartic,
    lifted_edges,
    platonic,
    reordered,
    shuffled,
)
from scipy.optimize import minimize

from orbiframe import MapError, surface_type

SURFACES = ("T", "PP", "TT", "PPP", "TTT", "PT")


def layout(mesh):
    surface = surface_type(mesh)
    curvature = int(np.sign(surface.euler_characteristic))
    packing = packed(mesh, curvature)
    return developed(mesh, geometry(curvature), packing.lengths, packing.angles, surface=surface, patch_radius=1.0)


def random_case(parts, seed, moves=6):
    rng = np.random.default_rng(seed)
    mesh = shuffled(connected_sum(parts), moves, rng)
    weights = rng.uniform(0.1, 5, mesh.edge_count)[mesh.edge]
    return layout(mesh), weights, rng


# ---- the energy -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("parts", SURFACES)
def test_gradient_and_hessian_are_derivatives_along_geodesics(parts):
    start, weights, rng = random_case(parts, 1)
    energy = HarmonicEnergy(start, weights)
    points = energy.moved(start.points, rng.normal(scale=0.3, size=(len(start.points), 2)))
    step = rng.normal(size=(len(points), 2))
    terms = energy.terms(points)
    h = 1e-4
    slope = float((energy.gradient(terms) * step).sum())
    bend = step.ravel() @ (energy.hessian(terms) @ step.ravel())
    ahead, here, behind = (energy.value(energy.moved(points, t * step)) for t in (h, 0.0, -h))
    assert (ahead - behind) / (2 * h) == pytest.approx(slope, rel=1e-6)
    assert (ahead - 2 * here + behind) / h**2 == pytest.approx(bend, rel=1e-4)


def test_the_energy_is_the_sum_of_squared_distances():
    start, weights, _ = random_case("TT", 2)
    near, far = lifted_edges(start)
    form = np.diag([1.0, -1, -1])
    distance = np.arccosh(np.einsum("hi,ij,hj->h", near, form, far))
    once = start.polyhedron.representative
    assert HarmonicEnergy(start, weights).value(start.points) == pytest.approx(
        0.5 * weights[once] @ distance[once] ** 2, rel=1e-9
    )


@pytest.mark.parametrize("versine", [1e-9, 1e-4, 9.9e-4, 1.01e-3, 0.1, 3.0, 100.0])
def test_derivatives_of_the_squared_distance(versine):
    with mpmath.workdps(40):
        half_square = lambda c: mpmath.acosh(1 + c) ** 2 / 2  # noqa: E731
        exact = [float(mpmath.diff(half_square, mpmath.mpf(versine), n)) for n in (1, 2)]
    found = _square_distance_derivatives(geometry(-1), np.array([versine]))
    assert found[0][0] == pytest.approx(exact[0], rel=1e-11)
    assert found[1][0] == pytest.approx(exact[1], rel=1e-8)


# ---- the minimum ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("parts", ["TT", "PPP"])
def test_the_minimum_is_the_one_that_a_general_method_finds(parts):
    start, weights, _ = random_case(parts, 3, moves=0)
    mesh = start.polyhedron
    once = np.flatnonzero(mesh.representative)
    isometry = start.orbifold.atlas.isometry[start.transition[once]]
    form = np.diag([1.0, -1, -1])

    def on_hyperboloid(flat):
        plane = flat.reshape(-1, 2)
        return np.column_stack([np.sqrt(1 + (plane**2).sum(axis=1)), plane])

    def energy(flat):
        x = on_hyperboloid(flat)
        far = np.einsum("eij,ej->ei", isometry, x[mesh.head[once]])
        cosine = np.einsum("ei,ij,ej->e", x[mesh.tail[once]], form, far)
        return weights[once] @ np.arccosh(np.maximum(cosine, 1)) ** 2

    found = minimize(energy, start.points[:, 1:].ravel(), method="BFGS", options={"gtol": 1e-6})
    points = minimised(start, weights)
    assert energy(points[:, 1:].ravel()) <= found.fun * (1 + 1e-12)
    assert np.allclose(on_hyperboloid(found.x), points, rtol=0, atol=1e-4)


@pytest.mark.parametrize("parts", ["T", "PP"])
def test_the_flat_minimum_solves_one_linear_system(parts):
    start, weights, _ = random_case(parts, 4)
    mesh = start.polyhedron
    g = start.orbifold.atlas.isometry[start.transition]
    size = 2 * len(mesh.vertices)
    matrix, right = np.zeros((size, size)), np.zeros(size)
    for h in np.flatnonzero(mesh.representative):
        i, j = 2 * mesh.tail[h] + np.arange(2), 2 * mesh.head[h] + np.arange(2)
        turn, move = g[h][1:, 1:], g[h][1:, 0]
        # The gradient of w |q_i - turn q_j - move|^2 / 2 in q_i and in q_j.
        for rows, factor in ((i, np.eye(2)), (j, -turn.T)):
            matrix[np.ix_(rows, i)] += weights[h] * factor
            matrix[np.ix_(rows, j)] -= weights[h] * factor @ turn
            right[rows] += weights[h] * factor @ move
    solution = np.linalg.lstsq(matrix, right)[0].reshape(-1, 2)
    exact = replace(start, points=np.column_stack([np.ones(len(solution)), solution]))
    found = replace(start, points=minimised(start, weights))
    assert np.allclose(edge_lengths(found), edge_lengths(exact), rtol=0, atol=1e-9)


@settings(max_examples=20, deadline=None)
@given(st.sampled_from(SURFACES), st.integers(0, 2**32 - 1))
def test_positive_weights_give_an_embedding_in_balance(parts, seed):
    """Colin de Verdiere 1991, Hass and Scott 2015; at the minimum the weighted logarithms of the neighbours cancel."""
    start, weights, _ = random_case(parts, seed, moves=20)
    result = replace(start, points=minimised(start, weights))
    assert result.not_positive == 0
    plane, atlas, mesh = result.orbifold.geometry, result.orbifold.atlas, result.polyhedron
    once = np.flatnonzero(mesh.representative)
    tail, head, transition = mesh.tail[once], mesh.head[once], result.transition[once]
    far = plane.act(atlas.isometry[transition], result.points[head])
    back = plane.act(atlas.isometry[atlas.inverse[transition]], result.points[tail])
    pull = np.zeros((len(mesh.vertices), 3))
    np.add.at(pull, tail, weights[once, None] * plane.log(result.points[tail], far))
    np.add.at(pull, head, weights[once, None] * plane.log(result.points[head], back))
    assert np.abs(pull).max() < 1e-5


@settings(max_examples=15, deadline=None)
@given(st.sampled_from(SURFACES), st.integers(0, 2**32 - 1))
def test_the_start_does_not_matter(parts, seed):
    start, weights, rng = random_case(parts, seed)
    energy = HarmonicEnergy(start, weights)
    elsewhere = energy.moved(start.points, rng.normal(scale=0.5, size=(len(start.points), 2)))
    first, second = (replace(start, points=minimised(s, weights)) for s in (start, replace(start, points=elsewhere)))
    assert np.allclose(edge_lengths(first), edge_lengths(second), rtol=0, atol=1e-5)


@pytest.mark.parametrize("name", ["plate_genus2_coarse", "three_crosscaps", "torus", "klein_bottle"])
def test_numbering_does_not_matter(name):
    mesh = dataset(name)
    other, number = reordered(mesh, np.random.default_rng(3))
    curvature = int(np.sign(surface_type(mesh).euler_characteristic))
    first, second = (harmonic(m, geometry(curvature), None) for m in (mesh, other))
    length = {}
    for result, names in ((second, np.arange(len(number))), (first, number)):
        ends = np.sort(names[np.stack([result.polyhedron.tail, result.polyhedron.head])], axis=0)
        length[result] = dict(zip(map(tuple, ends.T.tolist()), edge_lengths(result).tolist(), strict=True))
    assert len(length[first]) == mesh.edge_count
    assert length[first] == pytest.approx(length[second], abs=1e-7)


def test_symmetric_surfaces_are_mapped_symmetrically():
    """Klein's quartic: cosh(half an edge) = 1 / (2 sin(pi/7)). A torus of squares with diagonals: equal edges."""
    lengths = edge_lengths(harmonic(klein_quartic(), geometry(-1), metric="circle-packing", weights="uniform"))
    assert np.allclose(np.cosh(lengths / 2), 1 / (2 * np.sin(np.pi / 7)), rtol=1e-9)
    for mesh in (grid(6, 6), grid(9, 5), grid(8, 6, twisted=True)):
        lengths = edge_lengths(harmonic(mesh, geometry(0), weights="uniform"))
        assert np.ptp(lengths) < 1e-9 * lengths.mean()


# ---- the component --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("weights", ["auto", "cotangent", "mixed", "mean-value", "uniform"])
@pytest.mark.parametrize("name", ["plate_genus3", "three_crosscaps", "klein_bottle"])
def test_every_choice_of_weights_maps_the_datasets(name, weights):
    mesh = dataset(name)
    result = harmonic(mesh, geometry(int(np.sign(surface_type(mesh).euler_characteristic))), weights=weights)
    assert result.not_positive == 0
    assert result.area_defect < 1e-9
    assert result.relation_defect < 1e-12
    assert weights in (result.weights, "auto")


@pytest.mark.parametrize("name", ["torus", "klein_bottle", "plate_genus2_coarse", "three_crosscaps"])
@pytest.mark.parametrize("seed", range(2))
def test_rough_meshes_get_mixed_weights_or_mean_values(name, seed):
    """Noise as large as the edges: cotangents alone fold."""
    mesh, rng = dataset(name), np.random.default_rng(seed)
    noise = mesh.edge_lengths.mean() * rng.normal(size=mesh.vertices.shape)
    mesh = mesh.with_vertices(mesh.vertices + noise)
    plane = geometry(int(np.sign(surface_type(mesh).euler_characteristic)))
    result = harmonic(mesh, plane)
    assert result.not_positive == 0
    assert result.weights in ("mixed", "mean-value")
    with pytest.raises(MapError, match="no map without a fold was found with cotangent weights"):
        harmonic(mesh, plane, weights="cotangent")


@pytest.mark.parametrize(
    ("mesh", "curvature"),
    [
        (platonic("octahedron"), 0),
        (platonic("octahedron"), -1),
        (platonic("octahedron"), 1),
        (connected_sum("T"), 1),
        (connected_sum("T"), -1),
        (connected_sum("TT"), 0),
        (connected_sum("P"), -1),
    ],
)
def test_surfaces_that_do_not_live_on_the_geometry_are_refused(mesh, curvature):
    with pytest.raises(MapError, match=r"a surface with chi = -?\d does not live on"):
        harmonic(mesh, geometry(curvature))


def test_a_group_is_refused():
    with pytest.raises(MapError, match="finds its group from the mesh"):
        harmonic(connected_sum("TT"), geometry(-1), object())


@pytest.mark.parametrize("name", ["plate_genus2_coarse", "torus", "three_crosscaps"])
def test_coincident_vertices_fall_back_to_uniform_weights(name):
    mesh = dataset(name)
    vertices = mesh.vertices.copy()
    vertices[mesh.head[0]] = vertices[mesh.tail[0]]
    mesh = mesh.with_vertices(vertices)
    plane = geometry(int(np.sign(surface_type(mesh).euler_characteristic)))
    result = harmonic(mesh, plane)
    assert result.weights == "uniform"
    assert result.not_positive == 0
    for weights in ("cotangent", "mixed", "mean-value"):
        with pytest.raises(MapError, match="no map without a fold"):
            harmonic(mesh, plane, weights=weights)


@pytest.mark.parametrize("parts", ["T", "TT", "PPP"])
def test_a_mesh_in_one_point_still_has_a_map(parts):
    mesh = connected_sum(parts)
    result = harmonic(mesh.with_vertices(0 * mesh.vertices), geometry(0 if parts == "T" else -1))
    assert result.weights == "uniform"
    assert result.not_positive == 0


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("flat", [1e-3, 1e-6, 1e-12, 1e-200])
@pytest.mark.parametrize("name", ["plate_genus2_coarse", "torus", "klein_bottle"])
def test_extremely_thin_triangles(name, flat):
    mesh = dataset(name)
    mesh = mesh.with_vertices(mesh.vertices * np.array([flat, 1, 1]))
    result = harmonic(mesh, geometry(int(np.sign(surface_type(mesh).euler_characteristic))))
    assert result.not_positive == 0
    assert np.isfinite(result.points).all()


@pytest.mark.parametrize(("name", "limit"), [("plate_genus2", 1.15), ("torus", 1.05)])
def test_the_map_of_a_finer_mesh_is_nearly_conformal(name, limit):
    mesh = dataset(name, 3)
    result = harmonic(mesh, geometry(int(np.sign(surface_type(mesh).euler_characteristic))))
    assert np.median(result.angle_distortion) < limit


@pytest.mark.parametrize(
    ("name", "stretch", "better"),
    [
        ("plate_genus2_coarse", 1, "circle packing"),
        ("plate_genus2_coarse", 8, "vertex scaling"),
        ("three_crosscaps", 1, "vertex scaling"),
    ],
)
def test_auto_takes_the_metric_whose_map_distorts_angles_less(name, stretch, better):
    mesh = dataset(name)
    mesh = mesh.with_vertices(mesh.vertices * [stretch, 1, 1])
    made = {metric: harmonic(mesh, geometry(-1), metric=metric) for metric in ("vertex-scaling", "circle-packing")}
    least = min(made, key=lambda metric: float(np.median(made[metric].angle_distortion)))
    found = harmonic(mesh, geometry(-1))
    assert least == better.replace(" ", "-")
    assert found.group == f"mesh, by {better}"
    np.testing.assert_array_equal(found.points, made[least].points)


@pytest.mark.parametrize("name", ["plate_genus2_coarse", "torus"])
def test_rounds_of_even_areas_end_before_a_fold(name):
    """Areas in space that differ by 17 powers of ten: rounding folds the map of some round."""
    mesh = dataset(name)
    mesh = mesh.with_vertices(mesh.vertices * np.exp(20 * mesh.vertices[:, :1] / np.ptp(mesh.vertices)))
    result = harmonic(mesh, geometry(int(np.sign(surface_type(mesh).euler_characteristic))), even_areas=12)
    assert result.not_positive == 0
    assert 1 <= int(result.weights.split(", ")[1].split()[0]) < 12
