"""Moebius centring against a brute force minimum, and its indifference to Moebius maps."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_parametrizers.moebius import centred_caps
from scipy.optimize import minimize

from orbiframe import MapError


def random_points(rng, count=40):
    return rng.normal(size=count) + 1j * rng.normal(size=count), rng.uniform(0.2, 2, count)


def moved(matrix, z, radii):
    """Circles after z -> (a z + b) / (c z + d), by their Hermitian matrices."""
    (a, b), (c, d) = matrix
    inverse = np.array([[d, -b], [-c, a]]) / (a * d - b * c)
    circles = np.array([[np.ones_like(z), -z], [-z.conj(), np.abs(z) ** 2 - radii**2]]).transpose(2, 0, 1)
    image = inverse.conj().T @ circles.conj() @ inverse
    alpha, beta, delta = image[:, 0, 0].real, image[:, 0, 1], image[:, 1, 1].real
    centre = -(beta / alpha).conj()
    return centre, np.sqrt(np.maximum(np.abs(centre) ** 2 - delta / alpha, 0))


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_weighted_mean_is_zero(seed):
    rng = np.random.default_rng(seed)
    z, weights = random_points(rng)
    for radii in (np.zeros(40), rng.uniform(0, 0.01, 40)):
        points = centred_caps(z, radii, weights).centres
        assert np.abs(weights @ points / weights.sum()).max() < 1e-9
        assert np.allclose(np.linalg.norm(points, axis=1), 1, rtol=0, atol=1e-14)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_moebius_map_before_it_changes_nothing_but_a_rotation(seed):
    rng = np.random.default_rng(seed)
    z, weights = random_points(rng)
    matrix = rng.normal(size=(2, 2)) + 1j * rng.normal(size=(2, 2))
    first = centred_caps(z, np.zeros(40), weights).centres
    second = centred_caps(moved(matrix, z, np.zeros(40))[0], np.zeros(40), weights).centres
    assert np.allclose(first @ first.T, second @ second.T, rtol=0, atol=1e-7)
    turn = np.linalg.lstsq(first, second)[0]
    assert np.linalg.det(turn) == pytest.approx(1, abs=1e-6)


def test_a_moebius_map_of_circles_changes_nothing_but_a_rotation():
    """The map keeps small circles circles of finite size: it is chosen with its pole outside all of them."""
    rng = np.random.default_rng(8)
    z, weights = random_points(rng)
    radii = rng.uniform(0, 0.05, 40)
    matrix = np.array([[1.0, 0.5j], [0.1, 1.5]])
    first = centred_caps(z, radii, weights).centres
    second = centred_caps(*moved(matrix, z, radii), weights).centres
    assert np.allclose(first @ first.T, second @ second.T, rtol=0, atol=1e-9)


def test_the_centre_is_the_minimum_of_the_sum_of_horospherical_distances():
    """The balanced position is where sum w log(-<x, p>) is least on H^3, p the light vectors (Springborn 2005)."""
    z, weights = random_points(np.random.default_rng(5))
    weights = weights / weights.sum()
    power = np.abs(z) ** 2
    light = np.stack([(1 + power) / 2, (1 - power) / 2, z.real, z.imag], axis=1)

    def energy(x):
        return weights @ np.log(light[:, 0] * np.sqrt(1 + x @ x) - light[:, 1:] @ x)

    x = minimize(energy, np.zeros(3), method="BFGS", options={"gtol": 1e-11}).x
    time = np.sqrt(1 + x @ x)
    # Seen from the minimum, angles between points follow from the Lorentz products alone.
    height = light[:, 0] * time - light[:, 1:] @ x
    product = light[:, 1:] @ light[:, 1:].T - np.outer(light[:, 0], light[:, 0])
    cosines = 1 + product / np.outer(height, height)
    points = centred_caps(z, np.zeros(40), weights).centres
    assert np.allclose(points @ points.T, cosines, rtol=0, atol=1e-6)


def test_a_heavy_point_cannot_be_balanced():
    z = np.array([0, 1, 1j, -1])
    with pytest.raises(MapError, match="could not be balanced"):
        centred_caps(z, np.zeros(4), np.array([10.0, 1, 1, 1]))


def test_a_crowd_far_from_the_rest_is_balanced():
    """Half of the points in a disc of radius 1e-6: many steps of bounded size."""
    rng = np.random.default_rng(2)
    z, _ = random_points(rng)
    z[:20] *= 1e-6
    points = centred_caps(z, np.zeros(40), np.ones(40)).centres
    assert np.abs(points.mean(axis=0)).max() < 1e-9
    assert np.linalg.norm(points[:20].mean(axis=0)) > 0.1
