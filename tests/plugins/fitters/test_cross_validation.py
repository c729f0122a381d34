"""The fairing that noisy points ask for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fitted import REGISTRY, grid
from orbiframe_bases.powell_sabin import PowellSabin6
from orbiframe_fitters.least_squares import linear_fit
from orbiframe_fitters.sliding import Sliding

from orbiframe.functions import vertex_samples
from orbiframe.meshes import bisected, triangulated


def place(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    ring = 3 + np.cos(v)
    return np.stack([ring * np.cos(u), ring * np.sin(u), np.sin(v)], axis=1)


def off(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean((np.hypot(np.hypot(x[:, 0], x[:, 1]) - 3, x[:, 2]) - 1) ** 2)))


@pytest.fixture(scope="module")
def clean():
    """A space and the 800 vertices of a torus."""
    refinement = bisected(triangulated(grid(40, 20, place)), 0.4, True)
    mapped = REGISTRY.load("parametrizer", "harmonic")(refinement.polyhedron, REGISTRY.geometry(0), None)
    return PowellSabin6(mapped.orbifold, mapped, size=500), vertex_samples(mapped, refinement)


def noisy(samples, sigma: float):
    noise = np.random.default_rng(0).normal(scale=sigma, size=samples.values.shape)
    return replace(samples, values=samples.values + noise)


def test_points_without_noise_get_the_least(clean) -> None:
    assert linear_fit(*clean, None).fairing == 0.001


def test_noise_is_not_interpolated(clean) -> None:
    """With noise of 0.05 the surface is much nearer to the torus than its points are, and than without smoothing."""
    basis, samples = clean
    data = noisy(samples, 0.05)
    found = off(basis.values(samples.points, Sliding().fit(basis, data)))
    plain = off(basis.values(samples.points, Sliding(fairing=0.001).fit(basis, data)))
    assert linear_fit(basis, data, None).fairing > 0.01
    assert found < 0.5 * 0.05
    assert found < 0.7 * plain


def test_a_stated_noise_is_what_is_left(clean) -> None:
    basis, samples = clean
    data = replace(noisy(samples, 0.05), noise=0.05)
    fit = linear_fit(basis, data, None)
    counted = data.weights > 0
    residual = (basis.values(data.points, fit.coefficients) - data.values)[counted]
    share = data.weights[counted] / data.weights.sum()
    rms = np.sqrt(share @ (residual**2).mean(axis=1))
    assert 0.03 < rms <= 0.05 * (1 + 1e-9)
