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
from orbiframe.splines.element_basis import ElementBasis
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

    At a boundary their derivative across it is 0 (Neumann).
    By Galerkin's method in the basis of the forms, so they are upper bounds up to quadrature and rounding; by Lanczos'
    method on the inverse of the shifted problem from a start that is always the same. Raises FitError for a count below
    1 or above what the basis has.

    The errors are the least of three: the residual, from which an eigenvalue is no farther (Weinstein); residual^2 /
    gap, with the gap to those eigenvalues found that are farther than the residuals (Temple and Kato); and the integral
    of (2 h residual / (pi degree))^2, the square of what the functions cannot follow, with the size h of the triangles
    in space: an estimate, which exceeds what is missing by a factor of 2.5 to 30 where it was tried. They know nothing
    of quadrature, which is right to rounding or nearly so for the functions of the surface itself, nor how far the
    surface is from another one that was meant. They are nan for functions without a continuous gradient, for those
    with creases, and for a surface with a boundary, across which a residual does not see what flows.
    """
    size = forms.basis.size
    if not 1 <= count <= size - _MARGIN - 2:
        raise FitError(f"{count} eigenvalues are wanted of {size} functions; ask for 1 to {size - _MARGIN - 2}")
    values, columns = _smallest(forms, count + _MARGIN)
    residual, seen = _residuals(forms, values, columns)
    error = np.minimum(np.minimum(residual, _with_gaps(values, residual)), seen) + _ROUNDING * values[-1]
    return Spectrum(forms, values[:count], columns[:, :count], residual[:count], error[:count])


def _smallest(forms: SurfaceForms, count: int) -> tuple[Floats, Floats]:
    stiff, mass = csc_array(forms.stiffness), csc_array(forms.mass)
    shift = 4 * np.pi / forms.area  # Weyl: about so far apart are the eigenvalues
    factor = splu(
        csc_array(stiff + shift * mass),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    inverse = LinearOperator(stiff.shape, matvec=factor.solve, dtype=np.float64)
    start = np.random.default_rng(0).standard_normal(forms.basis.size)
    values, columns = eigsh(stiff, count, mass, sigma=-shift, which="LM", OPinv=inverse, v0=start)
    order = np.argsort(values)
    columns = columns[:, order]
    largest = np.take_along_axis(columns, np.abs(columns).argmax(axis=0)[None], axis=0)
    return np.maximum(values[order], 0.0), columns * np.sign(largest)


def _residuals(forms: SurfaceForms, values: Floats, columns: Floats) -> tuple[Floats, Floats]:
    """The norms of the residuals (k,), and what the functions cannot follow of them, (k,)."""
    creased = isinstance(forms.basis, ElementBasis) and forms.basis.domain.crease is not None
    if forms.basis.smoothness < 1 or creased or forms.beyond is not None:
        return np.full(len(values), np.nan), np.full(len(values), np.nan)
    rest = forms.laplacians(columns) + values * forms.basis.values(forms.points, columns)
    return np.sqrt(forms.weights @ rest**2), (forms.weights * _reach(forms) ** 2) @ rest**2


def _reach(forms: SurfaceForms) -> Floats:
    """How long the waves are, over 2 pi and about, that the functions cannot follow at the Gauss points, (n,)."""
    basis, (a, b, c) = forms.basis, forms.metric.T
    stretch = 1 / np.sqrt((a + c) / 2 - np.hypot((a - c) / 2, b))
    if not isinstance(basis, ElementBasis):
        return np.asarray(stretch * np.sqrt(4 * basis.orbifold.area / basis.size))
    longest = basis.domain.edge_lengths.reshape(-1, 3).max(axis=1)
    return np.asarray(stretch * np.repeat(2 * longest, len(stretch) // len(longest)) / (np.pi * basis.degree))


def _with_gaps(values: Floats, residual: Floats) -> Floats:
    """The squares of the residuals over the gaps to the nearest eigenvalues that are farther; inf where none is."""
    apart = np.abs(values[:, None] - values)
    apart[~(apart > residual[:, None] + residual)] = np.inf
    gap = apart.min(axis=1)
    return np.where(np.isfinite(gap), residual**2 / gap, np.inf)
