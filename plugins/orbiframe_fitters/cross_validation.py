"""Cross-validation: how much fairing data ask for, found from the data themselves or from their noise."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe import FitError
from orbiframe_fitters.normal_equations import solved

Floats = NDArray[np.float64]

_LADDER = 10 ** np.arange(0, 8, 0.5)
_PROBES = 12
_GAIN = 0.92
# Noise asks for so many times the least fairing; what asks for less is what the functions miss of exact data.
_NOISY = 9.0


class Trial(NamedTuple):
    """Data rows, sparse (n, size), weights (n,) and values (n, d), with their Gram matrix and that of the energy.

    normals: (n, 3), of the surface where values are points of it: then only what residuals have along normals is taken
    for noise, because along the surface they are errors of the parameters, which the points need not have.
    """

    rows: csr_array
    weights: Floats
    values: Floats
    gram: Any
    stiff: Any
    normals: Floats | None = None

    def fairing(self, least: float, noise: float | None) -> float:
        """The fairing, at least `least`, for data with this noise (rms of one coordinate), or by cross-validation.

        With a noise: the largest of a ladder that leaves no larger residual. Without one: the least |r| / tr(1 - S)
        (generalised cross-validation; Craven and Wahba, 1979), where S takes data to the fit and its trace is estimated
        from signs drawn at random (Hutchinson, 1990); data without noise get `least`.
        """
        ladder, drawn = least * _LADDER, self._drawn()
        if noise is not None:
            residuals = (self._scored(fairing, drawn)[0] for fairing in ladder)
            fitting = [fairing for fairing, rms in zip(ladder, residuals, strict=True) if rms <= noise]
            return float(max(fitting, default=least))
        best, chosen = np.inf, least
        for fairing in ladder:
            rms, freedom = self._scored(fairing, drawn)
            score = rms / max(freedom, 1e-3)
            if score < (_GAIN if chosen == least else 1.0) * best:
                best, chosen = score, fairing
            elif score > 2 * best:
                break
        return float(chosen if chosen >= _NOISY * least else least)

    def _drawn(self) -> _Drawn:
        signs = np.random.default_rng(0).choice([-1.0, 1.0], size=(len(self.weights), _PROBES))
        data = self.weights[:, None] * np.concatenate([self.values, signs], axis=1)
        return _Drawn(np.asarray(self.rows.T @ data), np.asarray(self.rows.T @ signs))

    def _scored(self, fairing: float, drawn: _Drawn) -> tuple[float, float]:
        """The rms of the residual of one coordinate, and the share of the data that is left free."""
        try:
            found = solved(self.gram + fairing * self.stiff, drawn.right)
        except FitError:
            return np.inf, 1.0
        split, share = self.values.shape[1], self.weights / self.weights.sum()
        residual = self._counted(self.values - self.rows @ found[:, :split])
        trace = np.vdot(drawn.signs, found[:, split:]) / _PROBES
        return float(np.sqrt(share @ residual)), float(1 - trace / len(self.weights))

    def _counted(self, residual: Floats) -> Floats:
        """The squares of what residuals (n, d) count, by coordinate or along normals, (n,)."""
        if self.normals is None:
            return np.asarray((residual**2).mean(axis=1))
        return np.asarray(np.einsum("ni,ni->n", residual, self.normals) ** 2)


class _Drawn(NamedTuple):
    """Right-hand sides of the values and of signs drawn at random, (size, d + p), and the signs as seen by the rows."""

    right: Floats
    signs: Floats
