"""Posterior: what is known of coefficients after a fit, and conditions that are met exactly, with their rank."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.linalg.lapack import dpstrf
from scipy.sparse import csr_array

from orbiframe import FitError
from orbiframe_fitters.normal_equations import solved

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_SHIFTS = (0.0, 1e-14, 1e-13, 1e-12, 1e-11)
# A condition whose squared distance from those before is below this share of its square follows from them.
_RANK = 1e-13
_MISSED = 1e-6
_STEPS = 4
_NAMED = 5


class Posterior:
    """The coefficients c of the least c M c - 2 r c with A c = b: a normal distribution about them, of covariance C.

    C = M^-1 - M^-1 A^T S^-1 A M^-1 with S = A M^-1 A^T is the same for M + mu A^T A, which makes M definite where data
    alone do not. matrix: M, positive definite; exact: A, sparse (m, size), or None; names: what each row of A asks for.
    """

    def __init__(self, matrix: Any, exact: csr_array | None = None, names: Sequence[str] = ()) -> None:
        self._matrix, self._exact, self._names = matrix, exact, names
        dense = matrix if isinstance(matrix, np.ndarray) else matrix.toarray()
        self._scale = 1 / np.sqrt(np.diagonal(dense))
        self._factor = _factor(self._scale[:, None] * dense * self._scale)

    def coefficients(self, right: Floats, wanted: Floats | None = None) -> Floats:
        """The coefficients (size, d) for r (size, d) and b (m, d).

        Raises FitError where conditions contradict each other or what the functions can do: with their rank and which.
        """
        found = solved(self._matrix, right)
        if self._exact is None or wanted is None:
            return found
        chosen, lower = self._independent
        for _ in range(_STEPS):
            missed = (self._exact @ found - wanted)[chosen]
            found = found - self._towards @ scipy.linalg.cho_solve((lower, True), missed)
        self._require_met(np.abs(self._exact @ found - wanted).max(axis=1), np.abs(wanted).max())
        return np.asarray(found)

    def half(self, rows: csr_array) -> Floats:
        """Columns h (size, n), one for every row, with b C b' = h . h'."""
        found = self._solved_half(rows)
        return found if self._exact is None else np.asarray(found - self._exact_span @ (self._exact_span.T @ found))

    def forms(self, rows: csr_array) -> Floats:
        """b C b for every row b, (n,)."""
        half = self.half(rows)
        return np.asarray(np.einsum("ij,ij->j", half, half))

    def moves(self, rows: csr_array) -> Floats:
        """C b for every row b, as columns (size, n): how to move, with the least energy and without leaving A c."""
        return self._back(self.half(rows))

    def inverse(self) -> Floats | None:
        """S^-1, (m, m); None where conditions are dependent."""
        chosen, lower = self._independent
        if len(chosen) < len(self._names):
            return None
        back = np.argsort(chosen)
        return np.asarray(scipy.linalg.cho_solve((lower, True), np.eye(len(chosen)))[np.ix_(back, back)])

    def _solved_half(self, rows: csr_array) -> Floats:
        part = np.asfortranarray((rows.toarray() * self._scale).T)
        return np.asarray(
            scipy.linalg.solve_triangular(self._factor, part, lower=True, check_finite=False, overwrite_b=True)
        )

    def _back(self, half: Floats) -> Floats:
        solved_part = scipy.linalg.solve_triangular(self._factor, half, lower=True, trans="T", check_finite=False)
        return np.asarray(self._scale[:, None] * solved_part)

    @cached_property
    def _exact_half(self) -> Floats:
        assert self._exact is not None
        return self._solved_half(self._exact)

    @cached_property
    def _exact_span(self) -> Floats:
        """Orthonormal columns that span those of the independent conditions."""
        chosen, lower = self._independent
        return np.asarray(scipy.linalg.solve_triangular(lower, self._exact_half[:, chosen].T, lower=True).T)

    @cached_property
    def _towards(self) -> Floats:
        """M^-1 A^T for the independent rows of A."""
        return self._back(self._exact_half[:, self._independent[0]])

    @cached_property
    def _independent(self) -> tuple[Ints, Floats]:
        """Rows of A that are independent, and the Cholesky factor of S for them."""
        product = self._exact_half.T @ self._exact_half
        norm = np.sqrt(np.maximum(np.diagonal(product), np.finfo(float).tiny))
        factor, pivots, rank, _ = dpstrf(product / np.outer(norm, norm), lower=1, tol=_RANK)
        chosen = pivots[:rank].astype(np.intp) - 1
        return chosen, norm[chosen, None] * np.tril(factor[:rank, :rank])

    def _require_met(self, missed: Floats, size: float) -> None:
        wrong = np.flatnonzero(~(missed <= _MISSED * max(size, np.finfo(float).tiny)))
        if len(wrong):
            told = "; ".join(f"{self._names[k]} is missed by {missed[k]:.3g}" for k in wrong[:_NAMED])
            more = f"; and {len(wrong) - _NAMED} more" if len(wrong) > _NAMED else ""
            raise FitError(
                f"{len(missed)} conditions have the rank {len(self._independent[0])}, and {len(wrong)} of them "
                f"contradict the others: {told}{more}; fix fewer samples, or use more functions (the option size)"
            )


def _factor(scaled: Floats) -> Floats:
    diagonal = np.diag_indices_from(scaled)
    for shift in _SHIFTS:
        scaled[diagonal] = 1 + shift
        try:
            return np.asarray(scipy.linalg.cholesky(scaled, lower=True, check_finite=False))
        except scipy.linalg.LinAlgError:
            continue
    raise FitError("the equations of the fit are singular; raise the option fairing")
