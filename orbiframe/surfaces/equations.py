"""Equations on surfaces in space, or on X/H: Poisson's equation, the biharmonic one, and the flow of heat."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_array, csc_array, csr_array
from scipy.sparse.linalg import splu

from orbiframe.errors import FitError
from orbiframe.surfaces.surface_forms import SurfaceForms

Floats = NDArray[np.float64]

# The integral of a source, of that of its absolute values, which may be rounding and quadrature.
_BALANCED = 1e-3


def poisson(forms: SurfaceForms, source: Floats) -> Floats:
    """The coefficients (size,) of the function u of mean 0 with -Laplacian u = source, on the surface of the forms.

    source: (n,), its values at `forms.points`. At a boundary the derivative across it is 0: nothing flows out. By
    Galerkin's method; the error falls like h^(degree + 1) with the size
    of the triangles. Raises FitError unless the integral of the source is 0, as it must be where
    nothing flows out.
    """
    values = _at_points(forms, source)
    total, size = float(forms.weights @ values), float(forms.weights @ np.abs(values))
    if abs(total) > _BALANCED * size:
        raise FitError(
            f"the source has the integral {total:.6g} and no solution: where nothing flows out it must be 0; subtract "
            f"its mean, {total / forms.area:.6g}"
        )
    right = forms.against(forms.weights * (values - total / forms.area))
    return _of_mean_zero(forms, right)


def biharmonic(forms: SurfaceForms, source: Floats) -> Floats:
    """The coefficients (size,) of the function u of mean 0 with Laplacian Laplacian u = source: plates, and splines.

    source: (n,), its values at `forms.points`. As two equations of Poisson, which on a closed surface it is (at a
    boundary the derivatives of u and of its Laplacian across it are 0), so that
    functions need no more than gradients, and the order of the error is that of `poisson`. Raises what that does.
    """
    bent = poisson(forms, source)
    return _of_mean_zero(forms, forms.mass @ bent)


def heat(forms: SurfaceForms, start: Floats, time: float, steps: int = 64) -> Floats:
    """The coefficients (size,) of what the function with coefficients `start` has become after a time of heat flow.

    Nothing flows across a boundary. By so many equal steps of Crank and Nicolson's method after two of Euler's, whose
    halves make rough starts smooth:
    second order in time. Raises FitError for a time that is not positive.
    """
    if not (time > 0 and steps > 1):
        raise FitError(f"time {time} in {steps} steps; give a positive time and at least 2 steps")
    step = time / steps
    mass, half = forms.mass, step / 2 * forms.stiffness
    solve = splu(csc_array(mass + half), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve
    found = np.asarray(start, dtype=np.float64)
    for _ in range(2):
        found = solve(mass @ found)
    for _ in range(steps - 1):
        found = solve(mass @ found - half @ found)
    return np.asarray(found)


def _of_mean_zero(forms: SurfaceForms, right: Floats) -> Floats:
    """The solution of stiffness c = right whose function has the integral 0."""
    column = csr_array(forms.integrals[:, None])
    bordered = block_array([[forms.stiffness, column], [column.T, None]], format="csc")
    return np.asarray(splu(csc_array(bordered)).solve(np.append(right, 0.0)))[:-1]


def _at_points(forms: SurfaceForms, values: Floats) -> Floats:
    found = np.asarray(values, dtype=np.float64)
    if found.shape != forms.weights.shape or not np.isfinite(found).all():
        raise FitError(
            f"the source has the shape {found.shape}; it must be {len(forms.weights)} finite values, at forms.points"
        )
    return found
