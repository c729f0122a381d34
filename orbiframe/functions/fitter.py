"""Fitter: coefficients of functions in a basis that approximate samples."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions.basis import Basis
from orbiframe.functions.samples import Samples


class Fitter(ABC):
    """A way to approximate; built by keyword options from the configuration alone."""

    @abstractmethod
    def fit(self, basis: Basis, samples: Samples) -> NDArray[np.float64]:
        """The coefficients (size, d) of the approximations of the d sampled functions; pure and deterministic."""
