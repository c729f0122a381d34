"""The girth of maps whose scale is known, and the density that it asks for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fitted import REGISTRY, grid, round_sphere, round_torus

from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.sizes import vector_areas
from orbiframe.triangulations.local_girth import girth, girth_radius, site_density, site_lengths
from orbiframe.triangulations.triangulation import Triangulation


def mapped(mesh, name: str) -> Triangulation:
    geometry = REGISTRY.geometry(2 if name == "sphere" else 0)
    return REGISTRY.load("parametrizer", name)(triangulated(mesh), geometry, None)


@pytest.fixture(scope="module")
def torus() -> Triangulation:
    return mapped(round_torus(), "harmonic")


def test_the_energy_of_a_torus_of_revolution(torus: Triangulation) -> None:
    """The scale of its conformal map is 1 / (R + r cos v), so that |grad log s| = |sin v| / (R + r cos v), and the

    integral of the square over u and v, with the area element r (R + r cos v), is (2 pi)^2 (R - sqrt(R^2 - r^2)) / r.
    """
    found = girth(torus)
    assert found.energy == pytest.approx((2 * np.pi) ** 2 * (3 - np.sqrt(8)), rel=0.05)
    x = torus.polyhedron.vertices
    ring = np.hypot(x[:, 0], x[:, 1])
    np.testing.assert_allclose(found.slope, np.abs(x[:, 2]) / ring, atol=0.06)


def test_a_sphere_has_none() -> None:
    assert girth(mapped(round_sphere(), "sphere")).energy < 0.05


def test_the_energy_is_a_pure_number(torus: Triangulation) -> None:
    large = replace(torus, polyhedron=torus.polyhedron.with_vertices(7 * torus.polyhedron.vertices))
    assert girth(large).energy == pytest.approx(girth(torus).energy)
    assert girth_radius(large) == pytest.approx(7 * girth_radius(torus))


def test_a_bulge_on_a_tube_is_where_functions_go() -> None:
    """A ring whose tube has one thin part: twice as thin, and the sites there are denser."""

    def place(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        small = 1 - 0.8 * np.exp(-(((u - np.pi) / 0.5) ** 2))
        ring = 3 + small * np.cos(v)
        return np.stack([ring * np.cos(u), ring * np.sin(u), small * np.sin(v)], axis=1)

    made = mapped(grid(160, 40, place), "harmonic")
    thin = made.polyhedron.vertices[:, 0] < -2.5
    even, graded = site_density(made, 0.0), site_density(made, 0.9)
    np.testing.assert_allclose(even, even[0])
    assert graded[thin].mean() > 1.1 * graded[~thin].mean()
    area = np.bincount(made.polyhedron.tail, np.repeat(np.linalg.norm(vector_areas(made.polyhedron), axis=1) / 3, 3))
    assert area @ graded**2 == pytest.approx(1, rel=0.05)


def test_a_wanted_density_multiplies(torus: Triangulation) -> None:
    wanted = np.where(torus.polyhedron.vertices[:, 0] > 0, 3.0, 1.0)
    denser = replace(torus, density=wanted)
    np.testing.assert_allclose(site_density(denser, 0.3), wanted * site_density(torus, 0.3))
    mesh = torus.polyhedron
    inside = (wanted[mesh.tail] == 3) & (wanted[mesh.head] == 3)
    np.testing.assert_allclose(site_lengths(denser, 0.3)[inside], 3 * site_lengths(torus, 0.3)[inside])
