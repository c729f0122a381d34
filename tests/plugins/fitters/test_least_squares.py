"""Least squares against numpy.linalg.lstsq, and its options."""

from __future__ import annotations

import numpy as np
import pytest
import reference_surfaces as surfaces
from orbiframe_bases.gaussian import Gaussian
from orbiframe_fitters import chunks, gram, normal_equations
from orbiframe_fitters.least_squares import LeastSquares
from scipy.sparse import csr_array, diags_array, hstack

from orbiframe import Basis, DifferentiableBasis, FitError, Points, Samples, UsageError


def space(name: str, size: int = 40) -> Gaussian:
    triangulation = surfaces.triangulated(name)
    return Gaussian(triangulation.orbifold, triangulation, size=size, width=1.3)


def samples(basis: Basis, count: int, dimension: int = 3) -> Samples:
    rng = np.random.default_rng(11)
    points = surfaces.random_points(basis.orbifold, count, rng)
    return Samples(points, rng.normal(size=(count, dimension)), rng.uniform(1, 3, count), rng.uniform(1, 2, count))


def by_lstsq(basis: Gaussian, data: Samples, fairing: float) -> np.ndarray:
    """The minimiser from one tall matrix, with delta^2 = area of the surface in space per function."""
    jets = [m.toarray() for m in basis.jet_matrices(data.points, 2)]
    mean_stretch = np.average(data.stretch, weights=data.weights)
    delta = np.sqrt(basis.orbifold.area / mean_stretch / basis.size)
    laplacian = data.stretch[:, None] * (jets[3] + jets[5])
    rows = np.concatenate([jets[0], np.sqrt(fairing) * delta**2 * laplacian])
    right = np.concatenate([data.values, np.zeros_like(data.values)])
    root = np.sqrt(np.concatenate([data.weights, data.weights]))[:, None]
    return np.linalg.lstsq(root * rows, root * right, rcond=None)[0]


@pytest.mark.parametrize("fairing", [0.0, 0.003])
@pytest.mark.parametrize("name", ["sphere", "klein_bottle", "octagon"])
def test_minimises_what_it_says(name: str, fairing: float) -> None:
    basis = space(name)
    data = samples(basis, 600)
    expected = by_lstsq(basis, data, fairing)
    found = LeastSquares(fairing=fairing).fit(basis, data)
    np.testing.assert_allclose(found, expected, atol=1e-7 * np.abs(expected).max())


def test_sparse_and_dense_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    basis = space("octagon")
    data = samples(basis, 600)
    dense = LeastSquares().fit(basis, data)
    monkeypatch.setattr(gram, "_DENSE", 10)
    monkeypatch.setattr(normal_equations, "_FILLED", 2)
    monkeypatch.setattr(chunks, "_CHUNK", 97)
    np.testing.assert_allclose(LeastSquares().fit(basis, data), dense, atol=1e-9)


def test_fairing_is_a_pure_number() -> None:
    """A surface twice as large has the same coefficients, doubled; so has a fit with other units of weight."""
    basis = space("torus")
    data = samples(basis, 500)
    double = Samples(data.points, 2 * data.values, 7 * data.weights, data.stretch / 4)
    fitter = LeastSquares(fairing=0.01)
    np.testing.assert_allclose(fitter.fit(basis, double), 2 * fitter.fit(basis, data), rtol=1e-8)


def test_fairing_flattens_noise_and_keeps_constants() -> None:
    basis = space("torus")
    data = samples(basis, 500)
    roughness = []
    for fairing in (0.0, 0.003, 0.3):
        jets = basis.jet_matrices(data.points, 2)
        fitted = LeastSquares(fairing=fairing).fit(basis, data)
        roughness.append(np.square((jets[3] + jets[5]) @ fitted).sum())
    assert roughness[0] > 1.5 * roughness[1] > 6 * roughness[2]
    flat = Samples(data.points, np.full((500, 1), 2.5), data.weights, data.stretch)
    np.testing.assert_allclose(LeastSquares(fairing=0.3).fit(basis, flat), 2.5, rtol=1e-9)


def test_error_of_a_smooth_function_falls_with_the_number_of_functions() -> None:
    """cos 2 pi x + sin 2 pi y on the torus."""
    triangulation = surfaces.triangulated("torus", 4)
    points = surfaces.random_points(triangulation.orbifold, 4000, np.random.default_rng(1))
    x, y = 2 * np.pi * points.x[:, 1:].T
    data = Samples(points, (np.cos(x) + np.sin(y))[:, None], np.ones(4000), np.ones(4000))
    errors = []
    for size in (30, 120, 480):
        basis = Gaussian(triangulation.orbifold, triangulation, size=size, width=1.5)
        residual = basis.design_matrix(points) @ LeastSquares(fairing=0).fit(basis, data) - data.values
        errors.append(np.sqrt(np.mean(residual**2)))
    assert errors[0] < 0.01
    assert errors[1] < errors[0] / 3
    assert errors[2] < errors[1] / 1.5


class Scaled(DifferentiableBasis):
    """The functions of another basis times numbers."""

    def __init__(self, basis: DifferentiableBasis, scale: np.ndarray) -> None:
        self.basis, self.scale = basis, scale
        self.orbifold, self.size, self.smoothness = basis.orbifold, basis.size, basis.smoothness

    def design_matrix(self, points: Points):
        return self.jet_matrices(points, 0)[0]

    def jet_matrices(self, points: Points, order: int):
        return [csr_array(m @ diags_array(self.scale)) for m in self.basis.jet_matrices(points, order)]


class Doubled(Scaled):
    """The functions of another basis, each twice."""

    def __init__(self, basis: DifferentiableBasis) -> None:
        super().__init__(basis, np.ones(basis.size))
        self.size = 2 * basis.size

    def jet_matrices(self, points: Points, order: int):
        return [hstack([m, m], format="csr") for m in self.basis.jet_matrices(points, order)]


class Values(Basis):
    """The values of another basis, without its derivatives."""

    def __init__(self, basis: Basis) -> None:
        self.basis, self.orbifold, self.size, self.smoothness = basis, basis.orbifold, basis.size, 0

    def design_matrix(self, points: Points):
        return self.basis.design_matrix(points)


def test_without_derivatives_fairing_is_refused_and_the_plain_fit_works() -> None:
    basis = space("torus")
    data = samples(basis, 300)
    with pytest.raises(FitError, match="fairing = 0"):
        LeastSquares().fit(Values(basis), data)
    plain = LeastSquares(fairing=0.0)
    np.testing.assert_allclose(plain.fit(Values(basis), data), plain.fit(basis, data), atol=1e-9)


def test_too_few_samples_are_an_error_with_the_way_out() -> None:
    basis = space("torus")
    with pytest.raises(FitError, match="10 samples do not determine 40 functions without fairing; raise the option"):
        LeastSquares(fairing=0).fit(basis, samples(basis, 10))


def test_as_many_samples_as_functions_are_interpolated() -> None:
    basis = space("torus")
    data = samples(basis, basis.size)
    assert len(data.weights) == basis.size
    coefficients = LeastSquares(fairing=0).fit(basis, data)
    np.testing.assert_allclose(basis.values(data.points, coefficients), data.values, atol=1e-6)


def test_functions_that_reach_no_sample_are_an_error() -> None:
    """Enough samples, but all in one place."""
    basis = space("torus", 100)
    data = samples(basis, 1)
    crowded = data.take(np.zeros(500, dtype=int))
    with pytest.raises(FitError, match=r"of 100 functions reach no sample \(the first is function \d+\)"):
        LeastSquares(fairing=0).fit(basis, crowded)


def test_functions_of_very_different_size_count_alike() -> None:
    """A function times 1e-9 has a coefficient times 1e9: the surface stays the same."""
    basis = space("octagon")
    data = samples(basis, 600)
    scale = np.ones(basis.size)
    scale[::3] = 1e-9
    expected = LeastSquares().fit(basis, data)
    np.testing.assert_allclose(scale[:, None] * LeastSquares().fit(Scaled(basis, scale), data), expected, atol=1e-8)


def test_dependent_functions_do_no_harm() -> None:
    """Every function twice: the same surface, and neither copy grows. Half the area per function, fairing times 4."""
    basis = space("octagon")
    data = samples(basis, 600)
    expected = LeastSquares().fit(basis, data)
    twice = LeastSquares(fairing=0.012).fit(Doubled(basis), data)
    np.testing.assert_allclose(twice[:40] + twice[40:], expected, atol=1e-7)
    assert np.abs(twice).max() < 2 * np.abs(expected).max()


@pytest.mark.parametrize("options", [{"fairing": -1.0}, {"fairing": float("nan")}])
def test_options_out_of_range(options: dict[str, float]) -> None:
    with pytest.raises(UsageError, match=next(iter(options))):
        LeastSquares(**options)


def test_weights_that_are_all_zero() -> None:
    basis = space("torus")
    data = samples(basis, 5)
    with pytest.raises(FitError, match="weight zero"):
        LeastSquares().fit(basis, Samples(data.points, data.values, 0 * data.weights, data.stretch))


@pytest.mark.parametrize("broken", ["values", "weights", "stretch"])
def test_samples_name_the_first_bad_number(broken: str) -> None:
    data = samples(space("torus"), 5)
    parts = {name: getattr(data, name).copy() for name in ("values", "weights", "stretch")}
    parts[broken][3] = np.nan
    with pytest.raises(FitError, match="sample 3 "):
        Samples(data.points, **parts)
    parts[broken] = parts[broken][:4]
    with pytest.raises(FitError, match="shapes"):
        Samples(data.points, **parts)


def test_fewer_samples_than_functions_are_an_error_that_names_what_is_missing():
    """Twenty values on forty functions were joined wildly: fairing at the samples says nothing of what is between."""
    basis = space("torus")
    with pytest.raises(FitError, match=f"20 samples leave at least {basis.size - 20} of {basis.size} functions"):
        LeastSquares().fit(basis, samples(basis, 20))
