"""Operators and gradients: against jets, and against central differences that are extrapolated to 1e-10."""

from __future__ import annotations

import sys
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from fitted import DATASETS, REGISTRY, config

from orbiframe import fit
from orbiframe.errors import FitError, UsageError
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.for_jax import jax_surface
from orbiframe.surfaces.for_torch import torch_surface

# One of each plane: S^2, E^2, H^2 and one without orientation; two bases of polynomials, and one of Gaussians.
CASES = [("sphere", "ps6"), ("torus", "ps6"), ("plate_genus2", "ps2"), ("klein_bottle", "gaussian")]


@cache
def surface(name: str, basis: str):
    return fit(DATASETS / f"{name}.off", config(150, f"basis.name={basis}", "data.lift=false"), REGISTRY).surface


def some_points(made, count: int = 12) -> Points:
    faces = np.arange(count) * 5 % (len(made.refinement.coarse.tail) // 3)
    return made.points(faces, np.tile([0.22, 0.45, 0.33], (count, 1)))


@pytest.mark.parametrize(("name", "basis"), CASES)
def test_the_operator_gives_points_jets_and_batches(name, basis):
    made = surface(name, basis)
    points = some_points(made)
    operator = made.operator(points, 2)
    assert list(operator.matrices) == ["value", "D1", "D2", "D11", "D12", "D22"]
    found, jet = operator(made.coefficients), made.jet(points)
    size = np.abs(found).max(axis=(1, 2), keepdims=True)
    np.testing.assert_allclose(found[0] + operator.origin, made.evaluate(points), atol=1e-12 * size[0, 0, 0])
    wanted = np.concatenate([np.moveaxis(jet.first, 1, 0), np.moveaxis(jet.second, 1, 0)])
    assert (np.abs(found[1:] - wanted) / size[1:]).max() < 1e-11
    batch = np.stack([made.coefficients, 2 * made.coefficients, 0 * made.coefficients])
    many = operator(batch[None])
    assert many.shape == (1, 3, 6, len(points.patch), 3)
    np.testing.assert_allclose(many[0, 1], 2 * found, rtol=1e-13)
    assert operator.stacked.shape == (6 * len(points.patch), made.basis.size)
    with pytest.raises(FitError, match="give 0 for values"):
        made.operator(points, 3)
    with pytest.raises(FitError, match="or a batch"):
        operator(np.zeros((3, 3)))


def test_first_derivatives_are_those_along_geodesics_and_second_ones_of_them():
    made = surface("plate_genus2", "ps2")
    points = some_points(made)
    geometry = made.orbifold.geometry
    frame = geometry.frame(points.x)
    found = made.operator(points, 2)(made.coefficients)
    for a, one, two in ((0, 1, 3), (1, 2, 5)):
        along = lambda t, a=a: made.evaluate(  # noqa: E731
            Points(points.patch, geometry.exp(points.x, t * frame[..., a]))
        )
        assert np.abs(extrapolated(along, 1e-3) - found[one]).max() < 1e-9 * np.abs(found[one]).max()
        step = 1e-3
        second = (along(step) - 2 * along(0.0) + along(-step)) / step**2
        assert np.abs(second - found[two]).max() < 1e-4 * np.abs(found[two]).max()


def extrapolated(along, step: float, levels: int = 5):
    """The derivative at 0 by central differences of steps halved, extrapolated (Romberg): error step^(2 levels)."""
    table = [(along(step / 2**k) - along(-step / 2**k)) / (2 * step / 2**k) for k in range(levels)]
    for order in range(1, levels):
        table = [(4**order * b - a) / (4**order - 1) for a, b in pairwise(table)]
    return table[0]


def loss(x, power):
    """A smooth number of points in space, in the language of any library."""
    return power(x[:, 0], 3).sum() + (x[:, 1] * x[:, 2]).sum() + power(x[:, 1], 2).sum()


def by_torch(made, coefficients, patch, x):
    torch = pytest.importorskip("torch", reason="PyTorch is not installed")
    c, y = (torch.tensor(part, dtype=torch.float64, requires_grad=True) for part in (coefficients, x))
    loss(torch_surface(made)(c, Points(patch, y)), torch.pow).backward()
    return c.grad.numpy(), y.grad.numpy()


def by_jax(made, coefficients, patch, x):
    jax = pytest.importorskip("jax", reason="JAX is not installed")
    with jax.enable_x64(True):
        evaluate = jax_surface(made)
        number = jax.jit(lambda c, y: loss(evaluate(c, Points(patch, y)), jax.numpy.power))
        return tuple(np.asarray(part) for part in jax.grad(number, (0, 1))(coefficients, x))


@pytest.mark.parametrize("gradients", [by_torch, by_jax])
@pytest.mark.parametrize(("name", "basis"), CASES)
def test_gradients_to_ten_digits(name, basis, gradients):
    """By the coefficients the number is a cubic, whose differences are exact; by the points they are extrapolated."""
    made = surface(name, basis)
    points = some_points(made)
    c, x = made.coefficients, points.x
    by_c, by_x = gradients(made, c, points.patch, x)
    rng = np.random.default_rng(0)
    aside = rng.normal(size=c.shape)

    def number(coefficients, y):
        on_x = made.orbifold.geometry.project(y)
        return loss(made.origin + made.scale * made.basis.values(Points(points.patch, on_x), coefficients), np.power)

    found = extrapolated(lambda t: number(c + t * aside, x), 0.5, 2)
    assert abs(found - (by_c * aside).sum()) < 1e-10 * np.abs(by_c * aside).sum()
    move = rng.normal(size=x.shape)
    # Not across an edge of the domain, where third derivatives jump.
    found = extrapolated(lambda t: number(c, x + t * move), 2e-3)
    assert abs(found - (by_x * move).sum()) < 1e-10 * np.abs(by_x * move).sum()
    # Nothing changes along a ray, also at a point beside X.
    assert np.abs(np.einsum("ni,ni->n", by_x, x)).max() < 1e-12 * np.abs(by_x).max() * np.abs(x).max()
    twice = gradients(made, c, points.patch, 2 * x)[1]
    np.testing.assert_allclose(2 * twice, by_x, atol=1e-12 * np.abs(by_x).max())


@pytest.mark.parametrize(("module", "made_by"), [("torch", torch_surface), ("jax", jax_surface)])
def test_without_the_library_the_next_step_is_said(module, made_by, monkeypatch):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(UsageError, match=f"orbiframe\\[{module}\\]"):
        made_by(surface("torus", "ps6"))
