"""Forms on surfaces: against Galerkin's matrices and the round torus, and ranks that are known."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import scipy.linalg
from fitted import DATASETS, REGISTRY, config
from round_surfaces import round_torus_eigenvalues
from scipy.sparse import csr_array, hstack

from orbiframe import fit
from orbiframe.errors import FitError
from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.splines.galerkin import integrals, mass, stiffness
from orbiframe.surfaces.gram_schmidt import orthonormal
from orbiframe.surfaces.surface_forms import SurfaceForms


@cache
def surface(name: str, basis: str = "ps6", size: int = 500):
    return fit(DATASETS / f"{name}.off", config(size, f"basis.name={basis}"), REGISTRY).surface


@pytest.mark.parametrize(("name", "basis"), [("sphere", "ps2"), ("torus", "ps6"), ("klein_bottle", "ps2")])
def test_on_x_they_are_the_galerkin_matrices(name, basis):
    made = surface(name, basis, 200)
    forms = SurfaceForms.of(made, on_x=True)
    for found, wanted in ((forms.mass, mass(made.basis)), (forms.stiffness, stiffness(made.basis))):
        assert abs(found - wanted).max() < 1e-5 * abs(wanted).max()
    np.testing.assert_allclose(forms.integrals, integrals(made.basis), rtol=1e-4, atol=1e-9)
    assert forms.area == pytest.approx(made.orbifold.area, rel=1e-6)


def test_area_and_first_eigenvalues_of_the_round_torus_in_space():
    """Radii 1 and 0.4: the area is 4 pi^2 0.4; the eigenvalues are those of Sturm and Liouville's equation round it."""
    forms = SurfaceForms.of(surface("torus"))
    assert forms.area == pytest.approx(4 * np.pi**2 * 0.4, rel=1e-4)
    found = scipy.linalg.eigh(forms.stiffness.toarray(), forms.mass.toarray(), eigvals_only=True)[:6]
    np.testing.assert_allclose(found, round_torus_eigenvalues(0.4)[:6], rtol=1e-3, atol=1e-6)


class Doubled(DifferentiableBasis):
    """The functions of a basis, then half the sums of neighbours in their list: so many are dependent."""

    def __init__(self, basis, more: int) -> None:
        self.basis, self.more = basis, more
        self.orbifold, self.size, self.smoothness = basis.orbifold, basis.size + more, basis.smoothness
        self.degree = basis.degree

    def jet_matrices(self, points, order):
        jets = self.basis.jet_matrices(points, order)
        return [csr_array(hstack([m, (m[:, : self.more] + m[:, 1 : self.more + 1]) / 2])) for m in jets]


def test_the_rank_is_named_and_orthonormal_functions_are():
    made = surface("torus", "ps2", 200)
    plain = orthonormal(SurfaceForms.of(made))
    assert plain.rank == made.basis.size
    assert 1 < plain.condition < 1e6
    doubled = orthonormal(SurfaceForms.of(made, Doubled(made.basis, 30)))
    assert doubled.rank == made.basis.size
    gram = doubled.matrix.T @ (doubled.forms.mass @ doubled.matrix)
    np.testing.assert_allclose(gram, np.eye(doubled.rank), atol=1e-9)


def test_projection_finds_functions_of_the_space_and_leaves_an_orthogonal_rest():
    made = surface("torus", "ps2", 200)
    functions = orthonormal(SurfaceForms.of(made))
    forms = functions.forms
    inside = np.random.default_rng(0).normal(size=made.basis.size)
    found = functions.project(made.basis.values(forms.points, inside[:, None])[:, 0])
    np.testing.assert_allclose(found, inside, atol=1e-8 * np.abs(inside).max())
    x = made.evaluate(forms.points)
    values = np.exp(x[:, 0]) * np.sin(4 * x[:, 1])
    rest = values - made.basis.values(forms.points, functions.project(values)[:, None])[:, 0]
    assert np.abs(forms.against(forms.weights * rest)).max() < 1e-12 * np.abs(values).max()
    assert np.sqrt(forms.weights @ rest**2) < 0.1 * np.sqrt(forms.weights @ values**2)
    with pytest.raises(FitError, match="finite values"):
        functions.project(np.ones(3))
