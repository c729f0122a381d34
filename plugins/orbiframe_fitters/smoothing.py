"""Smoothing: as near to the data as they deserve, and as fair as that allows all over the surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe import Basis, Samples
from orbiframe.functions import ValidatedFit, ValidatedFitter
from orbiframe_fitters.given_normals import with_normals
from orbiframe_fitters.least_squares import require_not_negative
from orbiframe_fitters.smoothing_system import Fit, SmoothingSystem, drawn_of

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# So many data are left out in turn.
_TOLD = 5000


class Smoothing(ValidatedFitter):
    """Splines with a penalty on the whole surface: the least sum of w |f - v|^2 + fairing length^(2k) |D^k f|^2.

    Data are the samples with weight; the energy is the sum over all samples of their areas, so that samples without
    weight all over the surface make it an integral. D^k is the gradient of the Laplacian, or the Laplacian for
    functions with one continuous derivative, in the metric of the surface. length^2 is the area of the surface per
    function, so that fairing is a pure number. Slopes of the samples are data as well: one counts like the difference
    of values that it makes over that length on X. Fixed samples are met exactly, with their slopes, and three functions
    that are a surface have their normals exactly where a fixed sample has one.

    fairing: how much is smoothed; by default the one whose fits without a datum are nearest to that datum, in the mean
    square: cross-validation (Allen, 1974; Craven and Wahba, 1979), by leverages and without a second fit. Data without
    noise are nearly interpolated. interpolate: all data are met exactly, with the least energy.

    Raises UsageError for a negative option, FitError if all weights are zero, for functions without derivatives, where
    data and fairing do not determine the functions, and for conditions that cannot be met together: their rank, and
    which of them.
    """

    def __init__(self, *, fairing: float | None = None, interpolate: bool = False) -> None:
        require_not_negative("smoothing", fairing=fairing)
        super().__init__(fairing=fairing)
        self.interpolate = interpolate

    def fit_validated(self, basis: Basis, samples: Samples) -> ValidatedFit:
        """See `ValidatedFitter`; of more than 5,000 data as many, drawn at random, are left out in turn."""
        system = SmoothingSystem.of(basis, samples, interpolate=self.interpolate)
        fairing = system.best_fairing(system.tried) if self.fairing is None else self.fairing
        found = system.fit(fairing, drawn_of(len(system.soft.places), _TOLD))
        return validated(basis, samples, system, found, fairing)


def validated(
    basis: Basis, samples: Samples, system: SmoothingSystem, found: Fit, fairing: float, noise: Floats | None = None
) -> ValidatedFit:
    """What a fit tells of itself: errors of the values, noise, standard errors.

    noise: the standard deviation of the values, (d,), by default by what is left out.
    """
    about = system.soft if len(system.weights) else system.exact
    told = np.unique(about.sample)
    told = told if len(found.left_out) == len(told) else told[drawn_of(len(told), _TOLD)][: len(found.left_out)]
    errors = np.full(samples.values.shape, np.nan)
    errors[told] = found.left_out
    mean = float(system.weights[system.soft.kind == 0].mean()) if len(system.weights) else np.inf
    unit = found.noise if noise is None else noise * np.sqrt(mean)
    posterior = found.posterior

    def deviation(rows: csr_array) -> Floats:
        return np.asarray(np.sqrt(posterior.forms(rows))[:, None] * unit)

    taken = float(found.leverage.mean()) * len(system.soft.places) if len(system.weights) else 0.0
    coefficients = with_normals(basis, samples, posterior, found.coefficients)
    freedom = taken + len(system.exact.sample)
    return ValidatedFit(coefficients, float(fairing), freedom, errors, deviation, unit / np.sqrt(mean))
