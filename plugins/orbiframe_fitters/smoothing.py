"""Smoothing: as near to the data as they deserve, and as fair as that allows all over the surface."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.sparse import csr_array, vstack

from orbiframe import Basis, DifferentiableBasis, FitError, Samples
from orbiframe.functions import ValidatedFit, ValidatedFitter
from orbiframe_fitters.energy import energy_of
from orbiframe_fitters.gram import Gram
from orbiframe_fitters.least_squares import chunks, require_not_negative
from orbiframe_fitters.normal_equations import solved

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# What is tried: powers of ten, and between them where it matters.
_LADDER = 10.0 ** np.arange(-9, 4)
_STEPS = 10.0 ** np.array([-0.5, 0.5])
# So many data are left out in turn while fairing is looked for, and at the end.
_TRIED, _TOLD = 1000, 5000
_SHIFTS = (0.0, 1e-14, 1e-13, 1e-12, 1e-11)


class Smoothing(ValidatedFitter):
    """Splines with a penalty on the whole surface: the least sum of w |f - v|^2 + fairing length^(2k) |D^k f|^2.

    Data are the samples with weight; the energy is the sum over all samples of their areas, so that samples without
    weight all over the surface make it an integral. D^k is the gradient of the Laplacian, or the Laplacian for
    functions with one continuous derivative, in the metric of the surface. length^2 is the area of the surface per
    function, so that fairing is a pure number.

    fairing: how much is smoothed; by default the one whose fits without a datum are nearest to that datum, in the mean
    square: cross-validation (Allen, 1974; Craven and Wahba, 1979), by leverages and without a second fit. Data without
    noise are nearly interpolated.

    Raises UsageError for a negative option, FitError if all weights are zero, for functions without derivatives, and
    where data and fairing do not determine the functions.
    """

    def __init__(self, *, fairing: float | None = None) -> None:
        require_not_negative("smoothing", fairing=fairing)
        super().__init__(fairing=fairing)

    def fit_validated(self, basis: Basis, samples: Samples) -> ValidatedFit:
        """See `ValidatedFitter`; of more than 5,000 data as many, drawn at random, are left out in turn."""
        system = _assembled(basis, samples)
        fairing = system.best_fairing() if self.fairing is None else self.fairing
        drawn = _drawn(len(system.weights), _TOLD)
        coefficients, leverage, left_out = system.tested(fairing, drawn)
        errors = np.full(samples.values.shape, np.nan)
        errors[np.flatnonzero(samples.weights > 0)[drawn]] = left_out
        return ValidatedFit(coefficients, float(fairing), float(leverage.mean() * len(system.weights)), errors)


class _System(NamedTuple):
    """The rows of data, sparse (n, size), weights (n,), values (n, d), and the Gram matrices of data and energy."""

    rows: csr_array
    weights: Floats
    values: Floats
    gram: Any
    stiff: Any

    def tested(self, fairing: float, drawn: Ints) -> tuple[Floats, Floats, Floats]:
        """The coefficients, and for some data their leverages and what they are beyond the fit of all others."""
        matrix = self.gram + fairing * self.stiff
        coefficients = solved(matrix, self.rows.T @ (self.weights[:, None] * self.values))
        rows = self.rows[drawn]
        leverage = self.weights[drawn] * _forms(matrix, rows)
        free = np.maximum(1 - leverage, np.finfo(float).eps)
        return coefficients, leverage, (self.values[drawn] - rows @ coefficients) / free[:, None]

    def best_fairing(self) -> float:
        """The fairing of the least error by cross-validation; of the ladder, and then of its steps in between."""
        drawn = _drawn(len(self.weights), _TRIED)
        errors = {float(fairing): self._error(fairing, drawn) for fairing in _LADDER}
        best = min(errors, key=lambda fairing: errors[fairing])
        if not np.isfinite(errors[best]):
            raise FitError("no fairing determines the functions from these data; use more data or fewer functions")
        errors |= {float(best * step): self._error(best * step, drawn) for step in _STEPS}
        return min(errors, key=lambda fairing: errors[fairing])

    def _error(self, fairing: float, drawn: Ints) -> float:
        try:
            left_out = self.tested(fairing, drawn)[2]
        except FitError:
            return np.inf
        return float(self.weights[drawn] @ (left_out**2).sum(axis=1))


def _drawn(count: int, most: int) -> Ints:
    """All of so many numbers, or some of them drawn at random, in order."""
    if count <= most:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, most, replace=False))


def _assembled(basis: Basis, samples: Samples) -> _System:
    """The data in their order, with the Gram matrices of data and energy."""
    counted, fair = np.flatnonzero(samples.weights > 0), samples.take(np.flatnonzero(samples.shares > 0))
    if not len(counted):
        raise FitError("all samples have weight zero; at least one must count")
    energy = energy_of(basis, fair)
    assert isinstance(basis, DifferentiableBasis)
    stiff, gram = Gram(basis.size), Gram(basis.size)
    for part, chosen in chunks(fair):
        for rows in energy.rows(basis.jet_matrices(part.points, energy.order)):
            stiff.add(rows, energy.weights(chosen, part.stretch))
    data = samples.take(counted)
    rows = _in_order(basis, data)
    gram.add(rows, data.weights)
    return _System(rows, data.weights, data.values, gram.matrices()[0], stiff.matrices()[0])


def _in_order(basis: Basis, data: Samples) -> csr_array:
    """The values of all functions at the data."""
    parts, order = zip(*((basis.design_matrix(part.points), chosen) for part, chosen in chunks(data)), strict=True)
    return csr_array(csr_array(vstack(parts))[np.argsort(np.concatenate(order))])


def _forms(matrix: Any, rows: csr_array) -> Floats:
    """b A^-1 b for every row b, (n,): by the Cholesky factor of the matrix scaled to a unit diagonal."""
    dense = matrix if isinstance(matrix, np.ndarray) else matrix.toarray()
    scale = 1 / np.sqrt(np.diagonal(dense))
    factor = _factor(scale[:, None] * dense * scale)
    part = np.asfortranarray((rows.toarray() * scale).T)
    half = scipy.linalg.solve_triangular(factor, part, lower=True, check_finite=False, overwrite_b=True)
    return np.asarray(np.einsum("ij,ij->j", half, half))


def _factor(scaled: Floats) -> Floats:
    diagonal = np.diag_indices_from(scaled)
    for shift in _SHIFTS:
        scaled[diagonal] = 1 + shift
        try:
            return np.asarray(scipy.linalg.cholesky(scaled, lower=True, check_finite=False))
        except scipy.linalg.LinAlgError:
            continue
    raise FitError("the equations of the fit are singular; raise the option fairing")
