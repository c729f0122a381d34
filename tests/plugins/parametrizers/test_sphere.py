"""Maps to S^2 and P^2: symmetric solids, conformal maps known in closed form, antipodes, bad meshes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_groups.finite import FiniteGroup
from orbiframe_groups.lattice import lattice_group
from orbiframe_markers.tree_cotree import tree_cotree
from orbiframe_parametrizers.double_cover import double_cover
from orbiframe_parametrizers.plane_layout import _dipole, _unfolded_round
from orbiframe_parametrizers.sphere import _spherical, sphere
from reference_meshes import (
    connected_sum,
    dataset,
    edge_lengths,
    geometry,
    icosphere,
    platonic,
    reference,
    reordered,
    shuffled,
)

from orbiframe import MapError
from orbiframe.groups import MarkedGroup
from orbiframe.meshes.orientation import reversed_faces

CENTRAL_ANGLE = {
    "tetrahedron": np.arccos(-1 / 3),
    "octahedron": np.pi / 2,
    "icosahedron": np.arccos(1 / np.sqrt(5)),
}


def check(result):
    assert result.not_positive == 0
    assert result.area_defect < 1e-11
    assert result.relation_defect == 0
    assert np.abs(np.linalg.norm(result.points, axis=1) - 1).max() < 1e-14


@pytest.mark.parametrize("name", CENTRAL_ANGLE)
def test_platonic_solids_stay_regular(name):
    result = sphere(platonic(name), geometry(1), weights="packing")
    check(result)
    assert np.allclose(edge_lengths(result), CENTRAL_ANGLE[name], rtol=0, atol=1e-9)


def test_the_projective_plane_on_six_vertices_becomes_the_halved_icosahedron():
    """The only place where opposite points are in balance: the vertices in space are irregular and do not matter."""
    mesh = reference("projective plane")
    result = sphere(mesh, geometry(1), weights="packing")
    check(result)
    assert np.allclose(edge_lengths(result), CENTRAL_ANGLE["icosahedron"], rtol=0, atol=1e-9)


def turned_onto(points: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Points after the rotation that brings them closest to the target (Kabsch 1976)."""
    u, _, vt = np.linalg.svd(points.T @ target)
    assert np.linalg.det(u @ vt) > 0, "mirrored"
    return points @ u @ vt


def errors_against(result, exact: np.ndarray) -> tuple[float, float]:
    """The largest and the mean distance from the exact points after the best rotation."""
    distance = np.linalg.norm(turned_onto(result.points, exact) - exact, axis=1)
    return float(distance.max()), float(np.sqrt((distance**2).mean()))


def test_the_map_of_a_fine_sphere_tends_to_the_identity():
    """With the square of the edge length, but for the vertices beside the pole."""
    found, distortions = [], []
    for density in (4, 8, 16):
        mesh = icosphere(density)
        result = sphere(mesh, geometry(1))
        check(result)
        assert result.weights == "cotangent"
        found.append(errors_against(result, mesh.vertices))
        distortions.append(np.median(result.angle_distortion) - 1)
    (largest, mean), (_, middle), (last_largest, last_mean) = found
    assert largest < 0.05
    assert last_largest < largest / 3
    assert mean > 3 * middle > 9 * last_mean
    assert distortions[0] > 2.5 * distortions[1] > 6.25 * distortions[2]


def conformal_latitude(latitude: np.ndarray, eccentricity: float) -> np.ndarray:
    """The latitude on the sphere of the conformal image of a spheroid (Snyder 1987, Map Projections, equation 3-1)."""
    sine = eccentricity * np.sin(latitude)
    stretch = ((1 - sine) / (1 + sine)) ** (eccentricity / 2)
    return 2 * np.arctan(np.tan(np.pi / 4 + latitude / 2) * stretch) - np.pi / 2


def test_the_map_of_a_spheroid_tends_to_its_conformal_latitude():
    flattened, errors = 0.6, []
    for density in (6, 12, 24):
        mesh = icosphere(density)
        mesh = mesh.with_vertices(mesh.vertices * np.array([1, 1, flattened]))
        x, y, z = mesh.vertices.T
        # Geodetic latitude is the direction of the normal (x, y, z / flattened^2).
        latitude = np.arctan2(z / flattened**2, np.hypot(x, y))
        image, around = conformal_latitude(latitude, np.sqrt(1 - flattened**2)), np.arctan2(y, x)
        exact = np.stack([np.cos(image) * np.cos(around), np.cos(image) * np.sin(around), np.sin(image)], axis=1)
        result = sphere(mesh, geometry(1), weights="cotangent")
        check(result)
        errors.append(errors_against(result, exact)[1])
    assert errors[0] < 0.01
    assert errors[0] > 3 * errors[1] > 9 * errors[2]


@settings(max_examples=15, deadline=None)
@given(st.sampled_from(["tetrahedron", "octahedron", "icosahedron"]), st.integers(0, 40), st.integers(0, 2**32 - 1))
def test_random_triangulations_of_the_sphere_are_packed_without_folds(name, moves, seed):
    rng = np.random.default_rng(seed)
    mesh = shuffled(platonic(name), moves, rng)
    result = sphere(mesh.with_vertices(rng.normal(size=mesh.vertices.shape)), geometry(1), weights="packing")
    check(result)
    assert (np.linalg.det(result.lifts) > 0).all() or (np.linalg.det(result.lifts) < 0).all()


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 40), st.integers(0, 2**32 - 1))
def test_random_triangulations_of_the_projective_plane_are_packed_without_folds(moves, seed):
    mesh = shuffled(reference("projective plane"), moves, np.random.default_rng(seed))
    check(sphere(mesh, geometry(1), weights="packing"))


@pytest.mark.parametrize("weights", ["cotangent", "mean-value", "packing"])
def test_the_sheets_over_a_projective_plane_are_antipodal(weights):
    """Nobody tells the map of the double cover about its symmetry; packing and centring are unique, a pole is not."""
    mesh = dataset("projective_plane", 3)
    cover = double_cover(mesh)
    points = _spherical(cover.polyhedron, weights, geometry(1))
    rounding = {"packing": 1e-8, "cotangent": 0.02, "mean-value": 0.15}[weights]
    assert np.abs(points + points[cover.mate]).max() < rounding
    check(sphere(mesh, geometry(1), weights=weights))


@pytest.mark.parametrize("name", ["sphere", "cube", "dodecahedron"])
@pytest.mark.parametrize("weights", ["cotangent", "mean-value", "packing"])
def test_datasets(name, weights):
    mesh = dataset(name, 3)
    result = sphere(mesh, geometry(1), weights=weights)
    check(result)
    assert result.weights == weights
    assert (np.linalg.det(result.lifts) > 0).all()


def test_auto_takes_the_least_distortion():
    mesh = dataset("cube", 6)
    names = ("cotangent", "mean-value", "packing")
    found = {name: np.median(sphere(mesh, geometry(1), weights=name).angle_distortion) for name in names}
    assert sphere(mesh, geometry(1)).weights == min(found, key=found.get)


@pytest.mark.parametrize("weights", ["cotangent", "packing"])
def test_numbering_does_not_matter(weights):
    mesh = dataset("cube", 4)
    other, number = reordered(mesh, np.random.default_rng(3))
    first, second = (sphere(m, geometry(1), weights=weights).points for m in (mesh, other))
    assert np.allclose(first @ first.T, second[number] @ second[number].T, rtol=0, atol=1e-7)


@pytest.mark.parametrize(("parts", "curvature"), [("T", 1), ("TT", 1), ("PP", 1)])
def test_other_surfaces_are_refused(parts, curvature):
    with pytest.raises(MapError, match=r"a surface with chi = -?\d does not live on s2"):
        sphere(connected_sum(parts), geometry(curvature))


@pytest.mark.parametrize("curvature", [0, -1])
def test_other_planes_are_refused(curvature):
    with pytest.raises(MapError, match="a surface with chi = 2 does not live on"):
        sphere(platonic("octahedron"), geometry(curvature))


def test_a_named_group_changes_the_name_alone():
    mesh = platonic("octahedron")
    marking = tree_cotree(mesh)
    named = sphere(mesh, geometry(1), MarkedGroup(FiniteGroup(geometry(1), marking.word), marking, "finite"))
    assert named.group == "finite, word aA"
    np.testing.assert_array_equal(named.points, sphere(mesh, geometry(1), None).points)


def test_a_flat_group_is_refused():
    marking = tree_cotree(reference("torus"))
    with pytest.raises(MapError, match="lattice, word abAB does not live on s2"):
        sphere(
            platonic("octahedron"),
            geometry(1),
            MarkedGroup(lattice_group(geometry(0), marking.word), marking, "lattice"),
        )


def test_faces_oriented_against_each_other_are_refused():
    mesh = reversed_faces(platonic("octahedron"), np.arange(8) == 3)
    with pytest.raises(MapError, match="not oriented alike"):
        sphere(mesh, geometry(1))


def test_coincident_vertices_are_packed():
    mesh = dataset("sphere")
    vertices = mesh.vertices.copy()
    vertices[mesh.head[0]] = vertices[mesh.tail[0]]
    result = sphere(mesh.with_vertices(vertices), geometry(1))
    check(result)
    assert result.weights == "packing"
    for weights in ("cotangent", "mean-value"):
        with pytest.raises(
            MapError, match="no map to the sphere without a fold was found; 2 of 320 triangles are needles"
        ):
            sphere(mesh.with_vertices(vertices), geometry(1), weights=weights)


@pytest.mark.parametrize("stretch", [10.0, 1e4, 1e-4])
def test_long_and_flat_spheres_have_no_folds_or_are_named(stretch):
    mesh = icosphere(8)
    mesh = mesh.with_vertices(mesh.vertices * np.array([1, 1, stretch]))
    check(sphere(mesh, geometry(1)))


def test_a_mesh_without_area_is_named():
    mesh = platonic("octahedron")
    with pytest.raises(MapError):
        sphere(mesh.with_vertices(np.zeros((6, 3))), geometry(1))


def test_charges_beside_the_pole_have_no_quadrupole():
    """On an equilateral triangle and its three neighbours, and on a random patch: the moments of 1 / z."""
    rng = np.random.default_rng(1)
    regular = np.exp(2j * np.pi * np.arange(3) / 3)
    for places in (np.concatenate([regular, -2 * regular]), rng.normal(size=6) + 1j * rng.normal(size=6)):
        charge = _dipole(places)
        moments = [charge @ f for f in (places**0, places, places.conj(), places**2, places.conj() ** 2)]
        assert np.allclose(moments, [0, np.abs(places).max(), 0, 0, 0], rtol=0, atol=1e-12)


def test_the_neighbours_of_a_face_are_unfolded_into_its_plane():
    """On a flat mesh nothing has to be unfolded; on a solid the distances within each neighbour stay."""
    mesh = icosphere(1)
    vertices, places = _unfolded_round(mesh, 4)
    a, b, c, beyond_ab, beyond_bc, beyond_ca = places
    side = mesh.edge_lengths[0]
    assert np.array_equal(vertices[:3], mesh.triangles[4])
    assert np.allclose(np.abs([a - b, b - c, c - a]), side)
    for apex, i, j, k in ((beyond_ab, a, b, c), (beyond_bc, b, c, a), (beyond_ca, c, a, b)):
        assert np.allclose([apex], [i + j - k])
        assert np.allclose(np.abs([apex - i, apex - j]), side)
    assert a + b + c == pytest.approx(0, abs=1e-14)
    assert ((b - a).conjugate() * (c - a)).imag > 0
