"""Weighted least squares with a fairing term."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, diags_array, eye_array
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.sparse.linalg import splu

from orbiframe import Basis, DifferentiableBasis, FitError, Fitter, Samples, UsageError
from orbiframe.meshes import curve_order
from orbiframe_fitters.gram import add_gram

Floats = NDArray[np.float64]

_DENSE = 3000  # up to this many functions the matrix is dense
_CHUNK = 1 << 14  # samples whose derivatives are in memory at one time


class LeastSquares(Fitter):
    """The coefficients c that minimise the sum of w |B c - v|^2 + fairing delta^4 w |Laplace(B c)|^2 (paper, 3.4).

    Over all samples with values v and weights w; Laplace is that of the surface in space, the Laplacian on X times the
    stretch of the sample, and delta^2 the area of the surface in space per function, so that fairing is a pure number
    and the same for a mesh of any size. Solved by the normal equations with one step of refinement.

    fairing: how strongly ripples between creases are damped; 0 is the plain fit, 0.01 suits polyhedra, 0.001 smooth
    input; ridge: a multiple of the mean diagonal that is added to the diagonal and keeps the equations definite.

    Raises UsageError for a negative option, FitError if fairing needs derivatives that the basis does not know, for
    weights that are all zero, and if the equations cannot be solved.
    """

    def __init__(self, *, fairing: float = 0.003, ridge: float = 1e-12) -> None:
        for name, value in (("fairing", fairing), ("ridge", ridge)):
            if not value >= 0:
                raise UsageError(f"option {name} of the fitter least-squares is {value}; it must not be negative")
        self.fairing = fairing
        self.ridge = ridge

    def fit(self, basis: Basis, samples: Samples) -> Floats:
        """The coefficients (size, d); see the class."""
        if not samples.weights.sum() > 0:
            raise FitError("all samples have weight zero; at least one must count")
        smoothing = self._smoothing(basis, samples)
        matrix, right = _normal_equations(basis, samples, smoothing)
        if isinstance(matrix, np.ndarray):
            return _refined(matrix, right, _dense_solver(matrix, self.ridge))
        return _refined(matrix, right, _sparse_solver(matrix, self.ridge))

    def _smoothing(self, basis: Basis, samples: Samples) -> float:
        """The factor of the squared Laplacian: fairing delta^4."""
        if self.fairing == 0:
            return 0.0
        if not isinstance(basis, DifferentiableBasis):
            raise FitError(
                f"{type(basis).__name__} does not know derivatives, which fairing needs; set fairing = 0 or choose "
                "another basis"
            )
        stretched = float(samples.weights @ samples.stretch)
        if not stretched > 0:
            raise FitError("the stretch of all samples is zero, which fairing needs; set fairing = 0 or check the map")
        area_in_space = basis.orbifold.area * float(samples.weights.sum()) / stretched
        return self.fairing * (area_in_space / basis.size) ** 2


def _normal_equations(basis: Basis, samples: Samples, smoothing: float) -> tuple[Floats | csr_array, Floats]:
    """B^T W B + smoothing L^T W L and B^T W v, chunk by chunk."""
    size = basis.size
    matrix = np.zeros((size, size)) if size <= _DENSE else csr_array((size, size))
    right = np.zeros((size, samples.values.shape[1]))
    for part in _chunks(samples):
        values, laplacian = _rows(basis, part, smoothing > 0)
        right += values.T @ (part.weights[:, None] * part.values)
        matrix = _with_gram(matrix, values, part.weights)
        if laplacian is not None:
            matrix = _with_gram(matrix, laplacian, smoothing * part.weights * part.stretch**2)
    if isinstance(matrix, np.ndarray):
        matrix = np.triu(matrix) + np.triu(matrix, 1).T
    return matrix, right


def _chunks(samples: Samples) -> Iterator[Samples]:
    """The samples patch by patch and near ones together: they share lifts, and places of the matrix in the cache."""
    order = curve_order(samples.points.x)
    order = order[np.argsort(samples.points.patch[order], kind="stable")]
    for begin in range(0, len(order), _CHUNK):
        yield samples.take(order[begin : begin + _CHUNK])


def _rows(basis: Basis, samples: Samples, derivatives: bool) -> tuple[csr_array, csr_array | None]:
    if not derivatives or not isinstance(basis, DifferentiableBasis):
        return basis.design_matrix(samples.points), None
    jets = basis.jet_matrices(samples.points, 2)
    return jets[0], jets[3] + jets[5]


def _with_gram(matrix: Floats | csr_array, rows: csr_array, weights: Floats) -> Floats | csr_array:
    """The matrix plus A^T W A; of a dense matrix only the upper triangle counts."""
    if isinstance(matrix, np.ndarray):
        add_gram(rows.indptr, rows.indices, rows.data, weights, matrix)
        return matrix
    return csr_array(matrix + rows.T @ (diags_array(weights) @ rows))


def _dense_solver(matrix: Floats, ridge: float) -> Callable[[Floats], Floats]:
    damped = matrix + ridge * np.trace(matrix) / len(matrix) * np.eye(len(matrix))
    try:
        factor = scipy.linalg.cho_factor(damped, overwrite_a=True, check_finite=False)
    except scipy.linalg.LinAlgError as error:
        raise _indefinite(str(error)) from error
    return lambda right: np.asarray(scipy.linalg.cho_solve(factor, right, check_finite=False))


def _sparse_solver(matrix: csr_array, ridge: float) -> Callable[[Floats], Floats]:
    damped = matrix + ridge * matrix.trace() / matrix.shape[0] * eye_array(matrix.shape[0])
    order = reverse_cuthill_mckee(csr_array(damped), symmetric_mode=True)
    try:
        factor = splu(
            csc_array(damped[order][:, order]),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError as error:
        raise _indefinite(str(error)) from error
    back = np.argsort(order)
    return lambda right: np.asarray(factor.solve(np.ascontiguousarray(right[order])))[back]


def _refined(matrix: Floats | csr_array, right: Floats, solve: Callable[[Floats], Floats]) -> Floats:
    """The solution with one step of refinement, which takes back most of what the ridge changed."""
    first = solve(right)
    coefficients = first + solve(right - matrix @ first)
    if not np.isfinite(coefficients).all():
        raise _indefinite("the solution is not finite")
    return np.asarray(coefficients)


def _indefinite(reason: str) -> FitError:
    return FitError(
        f"the normal equations cannot be solved ({reason}): the functions are nearly dependent on these samples; raise "
        "the option ridge, lower the width or number of the functions, or use more samples"
    )
