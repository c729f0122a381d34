"""Spectra of surfaces in space, or of X/H: the smallest eigenvalues of the Laplacian and their functions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from orbiframe.components.one_line import one_line
from orbiframe.errors import FitError
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.surface_forms import SurfaceForms

Floats = NDArray[np.float64]

# Eigenvalues beyond those wanted, among which the gaps to the next ones are found.
_MARGIN = 6
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Eigenvalues of -Laplacian on a surface, rising from 0, and functions of a basis that belong to them.

    forms: of the surface and the basis; values: (k,); coefficients: (size, k), of functions that are orthonormal on the
    surface; the largest coefficient of each is positive; residual: (k,), the norm of Laplacian u + value u, so far from
    the value there is an eigenvalue (Weinstein); error: (k,), how far the value is from it as it seems, see `spectrum`.
    """

    forms: SurfaceForms
    values: Floats
    coefficients: Floats
    residual: Floats
    error: Floats

    __repr__ = one_line

    def evaluate(self, points: Points) -> Floats:
        """The eigenfunctions (n, k) over points of X/H."""
        return self.forms.basis.values(points, self.coefficients)


def spectrum(forms: SurfaceForms, count: int) -> Spectrum:
    """The `count` smallest eigenvalues of the surface of the forms with their functions, multiple ones as often.

    By Galerkin's method in the basis of the forms, so they are upper bounds up to quadrature and rounding; by Lanczos'
    method on the inverse of the shifted problem from a start that is always the same. Of functions with a continuous
    gradient the errors are those of Temple and Kato, residual^2 / gap, with the gap to those eigenvalues of the same
    space that are farther than the residuals, or the residual if that is less; of others they are nan. They do not say
    how far the surface is from another one that was meant. Raises FitError for a count below 1 or above what the
    basis has.
    """
    size = forms.basis.size
    if not 1 <= count <= size - _MARGIN - 2:
        raise FitError(f"{count} eigenvalues are wanted of {size} functions; ask for 1 to {size - _MARGIN - 2}")
    values, columns = _smallest(forms, count + _MARGIN)
    residual = _residuals(forms, values, columns)
    error = np.minimum(residual, residual**2 / _gaps(values, residual)) + _ROUNDING * values[-1]
    return Spectrum(forms, values[:count], columns[:, :count], residual[:count], error[:count])


def _smallest(forms: SurfaceForms, count: int) -> tuple[Floats, Floats]:
    stiff, mass = csc_array(forms.stiffness), csc_array(forms.mass)
    shift = 4 * np.pi / forms.area  # Weyl: about so far apart are the eigenvalues
    factor = splu(csc_array(stiff + shift * mass), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    inverse = LinearOperator(stiff.shape, matvec=factor.solve, dtype=np.float64)
    start = np.random.default_rng(0).standard_normal(forms.basis.size)
    values, columns = eigsh(stiff, count, mass, sigma=-shift, which="LM", OPinv=inverse, v0=start)
    order = np.argsort(values)
    columns = columns[:, order]
    largest = np.take_along_axis(columns, np.abs(columns).argmax(axis=0)[None], axis=0)
    return np.maximum(values[order], 0.0), columns * np.sign(largest)


def _residuals(forms: SurfaceForms, values: Floats, columns: Floats) -> Floats:
    if forms.basis.smoothness < 1:
        return np.full(len(values), np.nan)
    rest = forms.laplacians(columns) + values * forms.basis.values(forms.points, columns)
    return np.asarray(np.sqrt(forms.weights @ rest**2))


def _gaps(values: Floats, residual: Floats) -> Floats:
    """From each eigenvalue to the nearest that is no neighbour within the residuals; the last has none beyond it."""
    apart = np.abs(values[:, None] - values)
    apart[apart <= residual[:, None] + residual] = np.inf
    return np.asarray(apart.min(axis=1))
