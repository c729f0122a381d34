"""Integrals and equations on surfaces with a boundary: over the surface alone, nothing flows across its boundary."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from open_shapes import bumpy_disc, cylinder, square_sheet
from scipy.special import jnp_zeros

from orbiframe import OrbifoldSurface, fit
from orbiframe.surfaces import SurfaceForms, fit_field, heat, poisson, spectrum, surface_forms

PI2 = np.pi**2


@cache
def square(basis: str = "gaussian") -> OrbifoldSurface:
    """The unit square."""
    flat = square_sheet(8)
    return fit(
        flat.with_vertices(flat.vertices * [1, 1, 0]), size=300, boundary="auto", basis=basis, progress=False
    ).surface


@cache
def tube() -> OrbifoldSurface:
    return fit(cylinder(), size=300, boundary="auto", progress=False).surface


@pytest.mark.parametrize("basis", ["gaussian", "ps6"])
def test_eigenvalues_of_a_square_are_those_of_neumann(basis: str) -> None:
    found = spectrum(SurfaceForms.of(square(basis)), 8)
    assert found.values / PI2 == pytest.approx([0, 1, 1, 2, 4, 4, 5, 5], abs=2e-3)
    assert np.isnan(found.error).all()


def test_eigenvalues_of_a_disc_are_squares_of_zeros_of_derivatives_of_bessel_functions() -> None:
    flat = bumpy_disc(16)
    surface = fit(flat.with_vertices(flat.vertices * [1, 1, 0]), size=400, boundary="auto", progress=False).surface
    wanted = sorted([0.0, jnp_zeros(0, 1)[0] ** 2, *(jnp_zeros(m, 1)[0] ** 2 for m in (1, 1, 2, 2, 3, 3))])[:7]
    assert spectrum(SurfaceForms.of(surface), 7).values == pytest.approx(wanted, rel=1e-2, abs=1e-6)


def test_eigenvalues_of_a_tube_are_sums_of_those_of_its_circle_and_its_height() -> None:
    wanted = sorted(m**2 + (np.pi * k / 2) ** 2 for m in (0, 1, 1, 2, 2) for k in (0, 1, 2))[:6]
    assert spectrum(SurfaceForms.of(tube()), 6).values == pytest.approx(wanted, rel=1e-2, abs=1e-6)


def test_poisson_and_heat_on_a_square() -> None:
    """cos(pi x) is an eigenfunction."""
    forms = SurfaceForms.of(square())
    wave = np.cos(np.pi * square().evaluate(forms.points)[:, 0])
    u = poisson(forms, wave)
    assert forms.basis.values(forms.points, u[:, None])[:, 0] == pytest.approx(wave / PI2, abs=1e-4)
    later = heat(forms, u, 0.1)
    assert forms.basis.values(forms.points, later[:, None])[:, 0] == pytest.approx(
        wave / PI2 * np.exp(-0.1 * PI2), abs=1e-4
    )


def test_areas_integrals_and_means_are_those_of_the_surface_alone() -> None:
    """A tube of radius 1 and height 2: area 4 pi; the mean of z is 1, that of z^2 is 4 / 3."""
    assert SurfaceForms.of(tube()).area == pytest.approx(4 * np.pi, rel=1e-3)
    z = cylinder().vertices[:, 2]
    field = fit_field(tube(), cylinder().vertices, np.stack([z, z**2], axis=1))
    assert field.mean() == pytest.approx([1, 4 / 3], abs=2e-3)
    assert field.integral() == pytest.approx([4 * np.pi, 16 * np.pi / 3], rel=2e-3)


def test_means_on_a_closed_surface() -> None:
    """Of x^2 over a torus of radii 1 and 0.4: the integral of (R + r cos v)^3 over that of R + r cos v, halved."""
    found = fit("dataset:torus", size=300, progress=False)
    x = found.surface.refinement.coarse.vertices * found.surface.scale + found.surface.origin
    axis = int(np.ptp(x, axis=0).argmax())
    field = found.surface.fit_field(x, x[:, axis] ** 2)
    assert field.mean()[0] == pytest.approx((1 + 1.5 * 0.4**2) / 2, rel=5e-3)


def test_without_a_hold_beyond_the_boundary_there_is_no_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    """The mutant: functions that lie beyond the boundary have no energy."""
    surface = fit(bumpy_disc(6), size=120, boundary="auto", basis="bernstein", progress=False).surface
    held = SurfaceForms.of(surface)
    assert np.linalg.eigvalsh(held.stiffness.toarray())[1] > 1e-12
    monkeypatch.setattr(surface_forms, "_BEYOND", 0.0)
    loose = SurfaceForms.of(surface)
    assert np.linalg.eigvalsh(loose.stiffness.toarray())[1] < 1e-12
