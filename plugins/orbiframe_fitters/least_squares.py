"""Weighted least squares with a fairing term."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array

from orbiframe import Basis, DifferentiableBasis, FitError, Samples, UsageError
from orbiframe.functions import PreparedFitter
from orbiframe_fitters.chunks import chunks
from orbiframe_fitters.cross_validation import Trial
from orbiframe_fitters.energy import FAIRING, Energy, energy_of
from orbiframe_fitters.few_samples import few_samples
from orbiframe_fitters.gram import Gram
from orbiframe_fitters.normal_equations import solved, solver_of

Floats = NDArray[np.float64]


class LeastSquares(PreparedFitter):
    """The coefficients c that minimise the sum of w |B c - v|^2 + fairing length^(2k) area |D^k (B c)|^2 (paper, 3.4).

    Over all samples with values v and weights w; D^k is the Laplacian of the surface in space (k = 2), or its gradient
    (k = 3) where the samples lie on a smooth surface. length^2 is the area of the surface in space per function unless
    the samples say otherwise, so that fairing is a pure number and the same for a mesh of any size.

    fairing: how strongly ripples are damped, 0 is the plain fit; by default 0.003 between samples of a polyhedron, and
    between points of a smooth surface 0.001, or more if they are noisy: as much as cross-validation says, or as leaves
    no larger residual than the noise that the samples state.

    Raises UsageError for a negative option, FitError if fairing needs derivatives that the basis does not know, for
    weights that are all zero, and if the samples do not determine all functions.
    """

    def __init__(self, *, fairing: float | None = None) -> None:
        require_not_negative("least-squares", fairing=fairing)
        self.fairing = fairing

    def fit(self, basis: Basis, samples: Samples) -> Floats:
        """The coefficients (size, d); see the class."""
        return linear_fit(basis, samples, self.fairing).coefficients

    def prepared(self, basis: Basis, samples: Samples) -> Callable[[Floats], Floats]:
        """See `PreparedFitter`: the fairing is that of the fit of these samples."""
        found = equations(basis, samples, self.fairing)
        solve, pull = solver_of(found.matrix), found.pull()
        return lambda values: solve(np.asarray(pull @ values))


class LinearFit(NamedTuple):
    """The coefficients (size, d) of a linear fit, and the fairing that it took."""

    coefficients: Floats
    fairing: float


def linear_fit(basis: Basis, samples: Samples, fairing: float | None, fair: Samples | None = None) -> LinearFit:
    """The linear least squares fit; without a given fairing as much as the samples ask for, see `LeastSquares`.

    fair: the samples over which fairness is summed up; by default as few as stand for all.
    """
    found = equations(basis, samples, fairing, fair)
    return LinearFit(solved(found.matrix, found.right), found.fairing)


class Equations(NamedTuple):
    """The normal equations of a linear fit, (size, size) and (size, d), and the fairing that they have.

    rows, weights, order: of the samples that count, in parts, and their numbers among all `total` samples.
    """

    matrix: Any
    right: Floats
    fairing: float
    rows: list[csr_array]
    weights: list[Floats]
    order: list[NDArray[np.intp]]
    total: int

    def pull(self) -> csr_array:
        """The matrix from values at all samples, (total, d), to right-hand sides, (size, total)."""
        parts = [csr_array(diags_array(weight) @ rows) for weight, rows in zip(self.weights, self.rows, strict=True)]
        weighted = csr_array(scipy.sparse.vstack(parts)).tocoo()
        place = weighted.col, np.concatenate(self.order)[weighted.row]
        return csr_array((weighted.data, place), shape=(weighted.shape[1], self.total))


def equations(basis: Basis, samples: Samples, fairing: float | None, fair: Samples | None = None) -> Equations:
    """The equations of `linear_fit`."""
    require_values_alone(samples)
    require_rows(basis, samples, fairing)
    fair = samples if fairing == 0 else few_samples(basis, samples).fair if fair is None else fair
    energy = None if fairing == 0 else energy_of(basis, fair)
    gram, stiff, right = Gram(basis.size), Gram(basis.size), np.zeros((basis.size, samples.values.shape[1]))
    all_rows: list[csr_array] = []
    all_weights: list[Floats] = []
    order, values = [], []
    for part, chosen in chunks(samples):
        jets = _jets(basis, part, energy if fair is samples else None)
        gram.add(jets[0], part.weights)
        right += jets[0].T @ (part.weights[:, None] * part.values)
        if fair is samples:
            _add_energy(stiff, energy, jets, part, chosen)
        counted = np.flatnonzero(part.weights > 0)
        all_rows.append(csr_array(jets[0][counted]))
        all_weights.append(part.weights[counted])
        values.append(part.values[counted])
        order.append(chosen[counted])
    for part, chosen in () if fair is samples else chunks(fair):
        _add_energy(stiff, energy, _jets(basis, part, energy), part, chosen)
    matrix: Any = gram.matrices()[0]
    kept = all_rows, all_weights, order, len(samples.weights)
    if energy is None:
        return Equations(matrix, right, 0.0, *kept)
    bend: Any = stiff.matrices()[0]
    amount = FAIRING[energy.order] if fairing is None else fairing
    if fairing is None and energy.order == 3:
        rows, data = csr_array(scipy.sparse.vstack(all_rows)), (np.concatenate(all_weights), np.concatenate(values))
        normals = _normals(basis, samples, order, solved(matrix + amount * bend, right))
        trial = Trial(rows, *data, matrix, bend, normals)
        amount = trial.fairing(amount, samples.noise)
    return Equations(matrix + amount * bend, right, amount, *kept)


def _add_energy(
    stiff: Gram, energy: Energy | None, jets: list[csr_array], part: Samples, chosen: NDArray[np.intp]
) -> None:
    """Add what some samples say of an energy, if there is one."""
    for rows in energy.rows(jets) if energy else ():
        stiff.add(rows, energy.weights(chosen, part.stretch))  # type: ignore[union-attr]


def _normals(basis: Basis, samples: Samples, order: list[NDArray[np.intp]], coefficients: Floats) -> Floats | None:
    """The normals (n, 3) of a surface at samples; None where values are no points in space."""
    if coefficients.shape[1] != 3:
        return None
    assert isinstance(basis, DifferentiableBasis)
    jets = (basis.jets(samples.take(part).points, coefficients, 1) for part in order)
    cross = np.concatenate([np.cross(jet[1], jet[2]) for jet in jets])
    return np.asarray(cross / np.maximum(np.linalg.norm(cross, axis=1, keepdims=True), np.finfo(float).tiny))


def require_not_negative(fitter: str, **options: float | None) -> None:
    """Raises UsageError for an option that is negative or no number."""
    for name, value in options.items():
        if value is not None and not value >= 0:
            raise UsageError(f"option {name} of the fitter {fitter} is {value}; it must not be negative")


def require_values_alone(samples: Samples) -> None:
    """Raises FitError for slopes and fixed samples, of which least squares and sliding know nothing."""
    if samples.slopes is not None or samples.fixed is not None:
        raise FitError(
            "slopes are data for the fitters 'smoothing' and 'robust' alone, fixed samples also for 'sliding'; choose "
            "one of them (fitter.name)"
        )


def require_rows(basis: Basis, samples: Samples, fairing: float | None) -> None:
    """Raises FitError where there are too few samples, even if all of them are independent.

    Fairing acts at the samples alone, so that it joins no data between them: it needs samples all over the surface,
    with or without a weight, and at least as many as there are functions.
    """
    count = int((samples.weights > 0).sum())
    if not count:
        raise FitError("all samples have weight zero; at least one must count")
    places = int(((samples.weights > 0) | (samples.shares > 0)).sum())
    if fairing != 0 and places < basis.size:
        raise FitError(
            f"{places} samples leave at least {basis.size - places} of {basis.size} functions undetermined, for "
            "fairing acts at the samples only; add samples of weight 0 all over the surface, as surface.fit_field "
            "does, or lower the option size"
        )
    if fairing == 0 and count < basis.size:
        raise FitError(
            f"{count} samples do not determine {basis.size} functions without fairing; raise the option fairing, lower "
            "the option size, or use more samples"
        )


def _jets(basis: Basis, samples: Samples, energy: Energy | None) -> list[csr_array]:
    if energy is None:
        return [basis.design_matrix(samples.points)]
    assert isinstance(basis, DifferentiableBasis)
    return basis.jet_matrices(samples.points, energy.order)
