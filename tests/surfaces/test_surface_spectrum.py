"""Spectra and kernels of surfaces against closed forms: the round sphere, the round torus and flat tori."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from creased import fitted_with_creases
from fitted import DATASETS, REGISTRY, config
from round_surfaces import RADIUS, forms as forms_on_torus, round_torus_eigenvalues, sphere, torus
from scipy.special import eval_legendre

from orbiframe import fit
from orbiframe.errors import FitError
from orbiframe.orbifolds.flat_lattice import FlatLattice
from orbiframe.surfaces.signatures import heat_kernel, heat_kernel_signature, wave_kernel_signature
from orbiframe.surfaces.surface_forms import SurfaceForms
from orbiframe.surfaces.surface_spectrum import spectrum


@cache
def of_sphere(count: int = 16):
    return spectrum(SurfaceForms.of(sphere()), count)


def places(surface, count: int):
    """Points of X/H and their images."""
    faces = np.arange(count) * 7 % len(surface.refinement.coarse.tail) // 3
    points = surface.points(faces, np.tile([0.2, 0.5, 0.3], (count, 1)))
    return points, surface.evaluate(points)


def test_the_sphere():
    """l (l + 1) / R^2, 2 l + 1 times."""
    found = of_sphere()
    exact = np.concatenate([np.full(2 * degree + 1, degree * (degree + 1)) for degree in range(4)]) / RADIUS**2
    np.testing.assert_allclose(found.values, exact, rtol=1e-4, atol=1e-9)
    gram = found.coefficients.T @ (found.forms.mass @ found.coefficients)
    np.testing.assert_allclose(gram, np.eye(16), atol=1e-9)


@pytest.mark.long
def test_the_round_torus_and_what_the_errors_say():
    """Against a Fourier series; and with four times the functions no value is farther off than its error says."""
    found = spectrum(forms_on_torus("ps6", 1500), 12)
    np.testing.assert_allclose(found.values, round_torus_eigenvalues(0.4)[:12], rtol=3e-6, atol=1e-9)
    for basis, size in (("ps6", 300), ("ps2", 400)):
        made = fit(DATASETS / "torus.off", config(size, f"basis.name={basis}"), REGISTRY).surface
        more = REGISTRY.load("basis", "ps6")(made.orbifold, made.basis.domain.refined())
        coarse, fine = (spectrum(SurfaceForms.of(made, there), 12) for there in (made.basis, more))
        off = coarse.values - fine.values
        assert (off[1:] > 0).all()
        assert (off <= coarse.error + fine.error).all()
        assert (off[1:] > coarse.error[1:] / 30).all()
        assert (coarse.error <= coarse.residual + 1e-9).all()


def test_the_laplacian_is_that_of_closed_forms():
    """Of the heights of the sphere, -2 z / R^2; on the torus it integrates by parts to the stiffness."""
    there = SurfaceForms.of(sphere())
    columns = sphere().coefficients * sphere().scale
    z = sphere().evaluate(there.points) - sphere().origin
    found = there.laplacians(columns)
    assert np.sqrt(np.mean((found + 2 / RADIUS**2 * z) ** 2)) < 1e-3
    ring = forms_on_torus("ps6", 400)
    some = np.random.default_rng(0).normal(size=(ring.basis.size, 2))
    values = ring.basis.values(ring.points, some)
    left = -values.T @ (ring.weights[:, None] * ring.laplacians(some))
    right = some.T @ (ring.stiffness @ some)
    np.testing.assert_allclose(left, right, atol=2e-4 * np.abs(right).max())


def test_heat_on_the_sphere():
    """Sum of (2 l + 1) / (4 pi R^2) exp(-l (l + 1) t / R^2) P_l(cos of the angle)."""
    points, x = places(sphere(), 6)
    time, degree = 2.0, np.arange(4)
    cosine = np.clip(x @ x.T / RADIUS**2, -1, 1)
    decay = (2 * degree + 1) / (4 * np.pi * RADIUS**2) * np.exp(-degree * (degree + 1) * time / RADIUS**2)
    exact = sum(decay[k] * eval_legendre(k, cosine) for k in degree)
    np.testing.assert_allclose(heat_kernel(of_sphere(), points, points, time), exact, atol=3e-5)
    np.testing.assert_allclose(heat_kernel_signature(of_sphere(), points, [time])[:, 0], np.diagonal(exact), atol=3e-5)


def test_waves_on_the_sphere_are_everywhere_alike():
    """The functions of one degree have everywhere the same sum of squares, so the mean is 1 / area."""
    points, _ = places(sphere(), 6)
    found = wave_kernel_signature(of_sphere(), points, np.log([0.5, 1.5]), 0.1)
    np.testing.assert_allclose(found, 1 / (4 * np.pi * RADIUS**2), rtol=1e-3)


def test_heat_on_a_flat_torus_by_images():
    """The sum over the lattice of Gaussians exp(-d^2 / (4 t)) / (4 pi t), which knows no spectrum."""
    made = torus()
    there = SurfaceForms.of(made, on_x=True)
    found = spectrum(there, 40)
    lattice = FlatLattice.of(made.orbifold)
    time = made.orbifold.area / 25
    points, _ = places(made, 5)
    x = np.einsum("nij,nj->ni", lattice.linear[points.patch], points.x[:, 1:]) + lattice.shift[points.patch]
    whole = np.arange(-6, 7)
    steps = np.stack(np.meshgrid(whole, whole), axis=-1).reshape(-1, 2) @ lattice.basis.T
    far = np.linalg.norm(x[:, None, None] - x[None, :, None] - steps, axis=-1)
    exact = (np.exp(-(far**2) / (4 * time)) / (4 * np.pi * time)).sum(axis=-1)
    np.testing.assert_allclose(heat_kernel(found, points, points, time), exact, rtol=1e-6)


def test_what_cannot_be_is_an_error():
    there = forms_on_torus("ps2", 400)
    with pytest.raises(FitError, match="0 eigenvalues are wanted of"):
        spectrum(there, 0)
    points, _ = places(sphere(), 2)
    with pytest.raises(FitError, match="positive numbers"):
        heat_kernel(of_sphere(), points, points, 0.0)
    with pytest.raises(FitError, match="no eigenvalue is near"):
        wave_kernel_signature(of_sphere(), points, [200.0], 0.1)


def test_coarse_functions_have_large_errors():
    """Where all eigenvalues are within the residuals there is no gap, and no error that is 0 for want of one."""
    made = fit(DATASETS / "plate_genus2_coarse.off", config(60, "basis.name=ps2"), REGISTRY).surface
    found = spectrum(SurfaceForms.of(made), 5)
    assert (found.error[1:] > 1e-3 * found.values[1:]).all()
    finer = REGISTRY.load("basis", "ps2")(made.orbifold, made.basis.domain.refined().refined())
    off = found.values - spectrum(SurfaceForms.of(made, finer), 5).values
    assert (off <= found.error).all()


def test_creases_and_corners_have_no_error():
    creased = fitted_with_creases("cube.off", 30, 200, "basis.name=ps2").surface
    found = spectrum(SurfaceForms.of(creased), 4)
    assert np.isnan(found.error).all()
    assert np.isfinite(found.values).all()
