"""Orthonormal functions, and projection in the mean square, with the rank of the functions named."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.linalg.lapack import dpstrf

from orbiframe.errors import FitError
from orbiframe.surfaces.surface_forms import SurfaceForms

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Pivots below this share of the largest are rounding: what is left of a function beside the others.
_RANK = 1e-13


@dataclass(frozen=True, eq=False)
class Orthonormal:
    """Functions that are orthonormal for the scalar product of forms, and span what the basis spans.

    forms: the scalar product; matrix: (size, rank), the coefficients of each; chosen: (rank,), the functions of the
    basis of which they are made, each the farthest from those before; condition: the largest squared distance against
    the least, of functions of norm 1: by so much rounding grows. size - rank functions are combinations of the others.
    """

    forms: SurfaceForms
    matrix: Floats
    chosen: Ints
    condition: float

    @property
    def rank(self) -> int:
        """How many of the functions of the basis are independent, up to rounding."""
        return len(self.chosen)

    def project(self, values: Floats) -> Floats:
        """The coefficients (size,) in the basis of the function that is nearest in the mean square.

        values: (n,), those of the given function at the Gauss points `forms.points`.
        """
        if np.shape(values) != self.forms.weights.shape or not np.isfinite(values).all():
            raise FitError(
                f"a projection needs {len(self.forms.weights)} finite values, those at forms.points; their shape is "
                f"{np.shape(values)}"
            )
        return np.asarray(self.matrix @ (self.matrix.T @ self.forms.against(self.forms.weights * values)))


def orthonormal(forms: SurfaceForms, tolerance: float = _RANK) -> Orthonormal:
    """Gram and Schmidt's functions as they should be made: by Cholesky's factors with pivots (paper, section 3.4).

    tolerance: a function whose squared distance from those before is below this share of its square is dependent.
    Raises FitError if all functions vanish.
    """
    mass = forms.mass.toarray()
    norm = np.sqrt(np.maximum(np.diagonal(mass), 0))
    if not norm.any():
        raise FitError("all functions of the basis vanish; there is nothing to make orthonormal")
    scale = np.divide(1, norm, out=np.zeros_like(norm), where=norm > 0)
    factor, pivots, rank, _ = dpstrf(scale[:, None] * mass * scale, lower=1, tol=tolerance)
    chosen, lower = pivots[:rank].astype(np.intp) - 1, np.tril(factor[:rank, :rank])
    matrix = np.zeros((len(mass), rank))
    inverse = scipy.linalg.solve_triangular(lower, np.eye(rank), lower=True)
    matrix[chosen] = scale[chosen, None] * inverse.T
    squares = np.diagonal(lower) ** 2
    return Orthonormal(forms, matrix, chosen, float(squares.max() / squares.min()))
