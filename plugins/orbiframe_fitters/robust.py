"""Robust: smoothing splines that outliers do not pull, and that name them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from orbiframe import Basis, Samples, UsageError
from orbiframe.components import did_you_mean
from orbiframe.functions import ValidatedFit, ValidatedFitter
from orbiframe_fitters.least_squares import require_not_negative
from orbiframe_fitters.smoothing import validated
from orbiframe_fitters.smoothing_system import Fit, SmoothingSystem

Floats = NDArray[np.float64]
Weighing = Callable[[Floats], Floats]

# Where errors are normal, fits by these have 95 % of the efficiency of least squares (Huber, 1964; Beaton and Tukey,
# 1974; Holland and Welsch, 1977).
_HUBER, _TUKEY = 1.345, 4.685
_OUTLIER = 4.0  # standard deviations: of 16,000 normal errors one is larger
_NORMAL = 1.4826  # the standard deviation of a normal error, of its median absolute value
_MOST_STEPS, _SETTLED = 50, 1e-9


def _huber(size: Floats) -> Floats:
    """Errors up to a bound count by their squares, larger ones by their absolute values."""
    return np.asarray(np.minimum(1.0, _HUBER / np.maximum(size, _HUBER)))


def _tukey(size: Floats) -> Floats:
    """The weight falls to 0 at 4.685 standard deviations: what is beyond does not count at all."""
    return np.asarray(np.maximum(1 - (size / _TUKEY) ** 2, 0.0) ** 2)


LOSSES: dict[str, Weighing] = {"huber": _huber, "tukey": _tukey}


class Robust(ValidatedFitter):
    """Smoothing splines where large errors count less: M-estimates by iterated weights (Huber, 1964).

    Each datum has a trust of 1 for an error that is small against the scale, and less beyond; the fit is that of
    `smoothing` with weights times trust, again and again until it settles. The scale is the median size of the errors,
    as a standard deviation, from the data. Fixed samples are met exactly and have a trust of 1.

    loss: "tukey", which gives far outliers no weight, from the fit of "huber" on; or "huber", whose fit is the only one
    of its kind. fairing: how much is smoothed; by default first as the least median of the errors by cross-validation
    says, and then as cross-validation of the trusted data does.

    Outliers are data that are off by more than four standard deviations. Raises UsageError for an unknown loss, and
    what `smoothing` raises.
    """

    linear = False

    def __init__(self, *, fairing: float | None = None, loss: str = "tukey") -> None:
        require_not_negative("robust", fairing=fairing)
        if loss not in LOSSES:
            raise UsageError(
                f"option loss of the fitter robust is '{loss}'; it must be huber or tukey.{did_you_mean(loss, LOSSES)}"
            )
        super().__init__(fairing=fairing)
        self.loss = loss

    def fit_validated(self, basis: Basis, samples: Samples) -> ValidatedFit:
        """See `ValidatedFitter`; the trust of a sample is that of its value."""
        system = SmoothingSystem.of(basis, samples)
        trust = np.ones(len(system.soft.places))
        fairing = system.best_fairing(system.tried, robust=True) if self.fairing is None else self.fairing
        trust, found = _settled(system, fairing, trust, _huber)
        if self.fairing is None:
            fairing = _trusting(system, trust).best_fairing(system.tried)
            trust, found = _settled(system, fairing, trust, _huber)
        if self.loss == "tukey":
            trust, found = _settled(system, fairing, trust, _tukey)
        told = np.where(samples.weights > 0, 1.0, np.nan)
        sample = np.unique(system.soft.sample)
        told[sample] = trust
        outliers = np.zeros(len(told), dtype=np.bool_)
        outliers[sample] = _relative(found) > _OUTLIER
        noise = _NORMAL * np.median(np.abs(found.sizes), axis=0)
        fit = validated(basis, samples, _trusting(system, trust), found, fairing, noise)
        return fit._replace(noise=noise, trust=told, outliers=outliers)


def _trusting(system: SmoothingSystem, trust: Floats) -> SmoothingSystem:
    """With so much trust in the value and the slopes of each sample."""
    number = np.unique(system.soft.sample, return_inverse=True)[1]
    return system.trusting(trust[number])


def _settled(system: SmoothingSystem, fairing: float, trust: Floats, weigh: Weighing) -> tuple[Floats, Fit]:
    """Trust and fit, the one by the other, until they stay."""
    every = np.arange(len(trust))
    for _ in range(_MOST_STEPS):
        found = _trusting(system, trust).fit(fairing, every)
        before, trust = trust, weigh(_relative(found))
        if np.abs(trust - before).max(initial=0) < _SETTLED:
            break
    return before, found


def _relative(found: Fit) -> Floats:
    """The errors of each datum, those of several functions together, by the median of all, (k,)."""
    size = np.sqrt((found.sizes**2).mean(axis=1))
    scale = _NORMAL * float(np.median(size)) if len(size) else 0.0
    return np.asarray(size / scale if scale > 0 else np.zeros(len(size)))
