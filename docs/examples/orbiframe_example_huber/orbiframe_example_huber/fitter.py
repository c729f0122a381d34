"""Huber's fit: squares of small residuals, and absolute values of large ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, diags_array, eye_array
from scipy.sparse.linalg import splu

from orbiframe import Basis, FitError, Fitter, Samples

Floats = NDArray[np.float64]


class Huber(Fitter):
    """Weighted least squares, again and again, where samples with large residuals count less each time.

    bend: residuals up to so many times their median count in full; rounds: how many times the weights are changed.
    """

    linear = False

    def __init__(self, *, bend: float = 3.0, rounds: int = 10) -> None:
        self.bend, self.rounds = bend, rounds

    def fit(self, basis: Basis, samples: Samples) -> Floats:
        """The coefficients (size, d)."""
        matrix, weights = basis.design_matrix(samples.points), samples.weights
        coefficients = _solved(matrix, weights, samples.values)
        for _ in range(self.rounds):
            away = np.linalg.norm(matrix @ coefficients - samples.values, axis=1)
            known = weights > 0
            allowed = self.bend * np.median(away[known]) if known.any() else 0.0
            # A weight of 1 up to the bend, and then one that makes the residual count by its absolute value.
            share = np.minimum(1.0, allowed / np.maximum(away, np.finfo(float).tiny)) if allowed else np.ones(len(away))
            coefficients = _solved(matrix, weights * share, samples.values)
        return coefficients


def _solved(matrix: csc_array, weights: Floats, values: Floats) -> Floats:
    """The coefficients of the least sum of w |B c - v|^2; functions that no sample sees become the mean."""
    if not (weights > 0).any():
        raise FitError("all samples have the weight 0; nothing can be fitted")
    weighted = diags_array(weights) @ matrix
    mean = np.average(values, axis=0, weights=weights)
    normal = csc_array(matrix.T @ weighted)
    normal += 1e-10 * normal.diagonal().max() * eye_array(matrix.shape[1], format="csc")
    return np.asarray(mean + splu(csc_array(normal)).solve(weighted.T @ (values - mean)))
