"""Normal equations: solved to rounding, or refused with the reason."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, diags_array, eye_array
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.sparse.linalg import splu

from orbiframe import FitError

Floats = NDArray[np.float64]
Solver = Callable[[Floats], Floats]

# Added to the unit diagonal of the scaled matrix, and taken back by the iteration.
_SHIFTS = (1e-13, 1e-12, 1e-11)
_RESIDUAL = 1e-9
_MOST_STEPS = 60
_FILLED = 0.1  # of a matrix; a fuller one is factored as a dense one


def solved(matrix: Floats | csr_array, right: Floats) -> Floats:
    """The solution c (size, d) of A c = right for a positive semidefinite A, in which every unknown counts alike.

    A is scaled to a unit diagonal, factored with a shift of rounding size, and the shift taken back by conjugate
    gradients, so that functions of very different size, and functions that are dependent up to rounding, do no harm:
    of all solutions that are the same function up to rounding, a small one is found. Raises FitError for an unknown
    that does not occur, and where no solution is reached.
    """
    return solver_of(matrix)(right)


def solver_of(matrix: Floats | csr_array) -> Solver:
    """How to find what `solved` gives for any right-hand sides, each factor being made once, when it is needed."""
    diagonal = np.asarray(matrix.diagonal())
    require_seen(diagonal)
    scale = 1 / np.sqrt(diagonal)
    unit = scaled(matrix, scale)
    factors: dict[float, Solver | None] = {}

    def solve(right: Floats) -> Floats:
        wanted = scale[:, None] * right
        for shift in _SHIFTS:
            if shift not in factors:
                factors[shift] = _factored(unit, shift)
            factor = factors[shift]
            found = None if factor is None else _iterated(unit, wanted, factor)
            if found is not None:
                return np.asarray(scale[:, None] * found)
        raise _undetermined(len(diagonal))

    return solve


def first_factored(matrix: Floats | csr_array) -> Solver:
    """How to solve with a matrix and the least shift that makes it positive definite."""
    for shift in (*_SHIFTS, 1e-9, 1e-6):
        if (solve := _factored(matrix, shift)) is not None:
            return solve
    raise _undetermined(matrix.shape[0])


def _undetermined(size: int) -> FitError:
    return FitError(
        f"the equations of {size} functions cannot be solved to more than {-np.log10(_RESIDUAL):.0f} digits: some "
        "combination of the functions is not determined by the samples; raise the option fairing, lower the number or "
        "width of the functions, or use more samples"
    )


def require_seen(diagonal: Floats) -> None:
    """Raises FitError for a function that no sample sees, by the diagonal of the equations."""
    unseen = np.flatnonzero(~(diagonal > 0) | ~np.isfinite(diagonal))
    if len(unseen):
        raise FitError(
            f"{len(unseen)} of {len(diagonal)} functions reach no sample (the first is function {unseen[0]}), so that "
            "nothing determines them; lower the option size, raise the option fairing, or use more samples"
        )


def scaled(matrix: Floats | csr_array, scale: Floats) -> Floats | csr_array:
    """The matrix with a unit diagonal; dense where it is not worth being sparse."""
    if isinstance(matrix, np.ndarray):
        return scale[:, None] * matrix * scale
    unit = csr_array(diags_array(scale) @ matrix @ diags_array(scale))
    return unit.toarray() if unit.nnz > _FILLED * len(scale) ** 2 and len(scale) <= 3000 else unit


def _factored(matrix: Floats | csr_array, shift: float) -> Solver | None:
    """How to solve with the matrix plus a multiple of the unit matrix; None where it is not positive definite."""
    return _dense(matrix, shift) if isinstance(matrix, np.ndarray) else _sparse(matrix, shift)


def _dense(matrix: Floats, shift: float) -> Solver | None:
    shifted = matrix.copy()
    shifted[np.diag_indices_from(shifted)] += shift
    try:
        factor = scipy.linalg.cho_factor(shifted, overwrite_a=True, check_finite=False)
    except scipy.linalg.LinAlgError:
        return None
    return lambda right: np.asarray(scipy.linalg.cho_solve(factor, right, check_finite=False))


def _sparse(matrix: csr_array, shift: float) -> Solver | None:
    shifted = csr_array(matrix + shift * eye_array(matrix.shape[0]))
    order = reverse_cuthill_mckee(shifted, symmetric_mode=True)
    try:
        factor = splu(
            csc_array(shifted[order][:, order]),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:
        return None
    back = np.argsort(order)
    return lambda right: np.asarray(factor.solve(np.ascontiguousarray(right[order])))[back]


def _iterated(matrix: Floats | csr_array, right: Floats, solve: Solver) -> Floats | None:
    """The solution by conjugate gradients from that of the shifted matrix, for all columns; None if not reached."""
    size = np.linalg.norm(right, axis=0)
    x = solve(right)
    residual = right - matrix @ x
    move = direction = solve(residual)
    energy = np.einsum("ij,ij->j", residual, move)
    for _ in range(_MOST_STEPS):
        if (np.linalg.norm(residual, axis=0) <= _RESIDUAL * size).all():
            return np.asarray(x)
        image = matrix @ direction
        step = _ratio(energy, np.einsum("ij,ij->j", direction, image))
        x, residual = x + step * direction, residual - step * image
        move = solve(residual)
        before, energy = energy, np.einsum("ij,ij->j", residual, move)
        direction = move + _ratio(energy, before) * direction
    return None


def _ratio(a: Floats, b: Floats) -> Floats:
    return np.divide(a, b, out=np.zeros_like(a), where=b > 0)
