"""Fitter: coefficients of functions in a basis that approximate samples."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe.functions.basis import Basis
from orbiframe.functions.samples import Samples

Floats = NDArray[np.float64]


class Fitter(ABC):
    """A way to approximate; built by keyword options from the configuration alone.

    linear: whether it claims that its coefficients are linear in the values; a robust fitter does not.
    """

    linear: bool = True

    @abstractmethod
    def fit(self, basis: Basis, samples: Samples) -> Floats:
        """The coefficients (size, d) of the approximations of the d sampled functions; pure and deterministic."""


class PreparedFitter(Fitter):
    """A linear fitter whose equations can be factored once, for values that change."""

    @abstractmethod
    def prepared(self, basis: Basis, samples: Samples) -> Callable[[Floats], Floats]:
        """The fit as a linear map of values (n, d) at the samples, whatever theirs are, to coefficients (size, d).

        Everything but the values is taken from the samples and stays; `prepared(basis, samples)(samples.values)` is
        `fit(basis, samples)` up to rounding.
        """


class StartedFit(NamedTuple):
    """A fit by steps, and the linear fit that they began with, (size, d) each; the same array if no step was made."""

    start: Floats
    coefficients: Floats


class StartedFitter(Fitter):
    """A fitter that goes on from a linear fit, so that who knows more than the samples can choose between the two."""

    def fit(self, basis: Basis, samples: Samples) -> Floats:
        """The coefficients (size, d)."""
        return self.fit_started(basis, samples).coefficients

    @abstractmethod
    def fit_started(self, basis: Basis, samples: Samples) -> StartedFit:
        """The fit, and where it began."""


class ValidatedFit(NamedTuple):
    """A fit and how well it foretells.

    coefficients: (size, d); fairing: how much smoothing was taken; freedom: how many numbers the fit takes from the
    data, between 1 and the number of functions; left_out: (n, d), what each value is beyond the fit of all others.

    deviation: takes rows, sparse (k, size), to the standard errors (k, d) of what they find in the fit; noise: (d,),
    the standard deviation of the values as the fit finds it; trust: (n,), how far each sample was believed, from 1 to 0
    for an outlier, nan without weight; outliers: (n,), the samples that are off by more than chance makes likely. None
    where the fitter does not tell.
    """

    coefficients: Floats
    fairing: float
    freedom: float
    left_out: Floats
    deviation: Callable[[csr_array], Floats] | None = None
    noise: Floats | None = None
    trust: Floats | None = None
    outliers: NDArray[np.bool_] | None = None


class ValidatedFitter(Fitter):
    """A fitter that leaves out each of its data in turn, to tell how well its fits foretell.

    Its option fairing, None by default, says how much is smoothed; without it that is found from the data.
    """

    def __init__(self, *, fairing: float | None = None) -> None:
        self.fairing = fairing

    def fit(self, basis: Basis, samples: Samples) -> Floats:
        """The coefficients (size, d)."""
        return self.fit_validated(basis, samples).coefficients

    @abstractmethod
    def fit_validated(self, basis: Basis, samples: Samples) -> ValidatedFit:
        """The fit with its errors by cross-validation, those of samples without weight being nan."""
