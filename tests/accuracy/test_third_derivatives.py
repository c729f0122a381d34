"""Third covariant derivatives of every basis, in all three geometries."""

from __future__ import annotations

import numpy as np
import pytest
from dataset_laws import FAMILIES, REGISTRY, SIZE, exists, mapped
from third_derivatives import error_of_third_derivatives

from orbiframe import DifferentiableBasis, Points

SURFACES = ("projective_plane", "klein_bottle", "three_crosscaps")
# Degrees with third derivatives that are not all zero.
QUADRATIC = ("ps2", "klein_bottle")
OPTIONS = {"simplex": {"degree": 3}, "tensor-bspline": {"degree": 4}, "dms": {"degree": 4}}
PAIRS = [(f, s) for f in FAMILIES for s in SURFACES if exists(f, s) and (f, s) != QUADRATIC]


def made(family: str, surface: str) -> tuple[DifferentiableBasis, Points]:
    """A basis, and points of X/H."""
    triangulation = mapped(surface)
    options = {"size": SIZE, **OPTIONS.get(family, {})}
    rng = np.random.default_rng(5)
    face = rng.integers(triangulation.polyhedron.face_count, size=30)
    points = triangulation.locate(face, rng.dirichlet(np.ones(3), 30))
    return REGISTRY.load("basis", family)(triangulation.orbifold, triangulation, **options), points


@pytest.mark.parametrize(("family", "surface"), PAIRS)
def test_third_derivatives_are_differences_of_the_hessian(family: str, surface: str) -> None:
    """But for points so near to an edge that the differences reach across a jump."""
    error = error_of_third_derivatives(*made(family, surface), 2e-4)
    assert np.quantile(error, 0.8) < 1e-5


def test_quadratics_on_a_flat_surface_have_none() -> None:
    basis, points = made(*QUADRATIC)
    second, third = basis.jet_matrices(points, 3)[3], basis.jet_matrices(points, 3)[6:]
    assert all(abs(matrix).max() < 1e-10 * abs(second).max() for matrix in third)
