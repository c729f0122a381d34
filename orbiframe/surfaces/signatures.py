"""Signatures: what heat and waves on a surface tell of its points, by the spectrum."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.errors import FitError
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.surface_spectrum import Spectrum

Floats = NDArray[np.float64]


def heat_kernel(spectrum: Spectrum, first: Points, second: Points, time: float) -> Floats:
    """How much heat is at n points after a time that started as 1 at one of m points: (n, m).

    The sum of exp(-value time) u(x) u(y) over the spectrum; what lies beyond it is missing, which is little where
    exp(-time largest value) is. Raises FitError for a time that is not positive.
    """
    decay = np.exp(-spectrum.values * _positive("time", [time]))
    return np.asarray((spectrum.evaluate(first) * decay) @ spectrum.evaluate(second).T)


def heat_kernel_signature(spectrum: Spectrum, points: Points, times: ArrayLike) -> Floats:
    """The heat kernel (n, t) of n points with themselves at t times.

    For small times 1 / (4 pi time) + K / (12 pi) with the Gaussian curvature K: the same on surfaces that can be bent
    into each other. Raises FitError for times that are not positive.

    Source: J. Sun, M. Ovsjanikov and L. Guibas, A concise and provably informative multi-scale signature based on heat
    diffusion, Computer Graphics Forum 28 (2009).
    """
    decay = np.exp(-spectrum.values[:, None] * _positive("times", times))
    return np.asarray(spectrum.evaluate(points) ** 2 @ decay)


def wave_kernel_signature(spectrum: Spectrum, points: Points, energies: ArrayLike, width: float) -> Floats:
    """How likely a quantum particle of an energy is at n points, (n, e): the mean of u^2 over the spectrum near it.

    energies: logarithms of eigenvalues; width: of the Gaussian weights exp(-(energy - log value)^2 / (2 width^2)),
    whose sum is made 1; the eigenvalue 0 has none. Raises FitError for a width that is not positive, and for energies
    that no eigenvalue is near.

    Source: M. Aubry, U. Schlickewei and D. Cremers, The wave kernel signature, ICCV Workshops (2011).
    """
    wanted = np.atleast_1d(np.asarray(energies, dtype=np.float64))
    spread = float(_positive("width", [width])[0])
    # The constant function, whose eigenvalue is 0 up to rounding, tells nothing.
    some = spectrum.values > 1e-6 * spectrum.values.max()
    weights = np.exp(-((wanted - np.log(spectrum.values[some, None])) ** 2) / (2 * spread**2))
    total = weights.sum(axis=0)
    if not some.any() or not (total > 0).all():
        raise FitError(
            f"no eigenvalue is near some of the energies {wanted.tolist()}; those of {some.sum()} eigenvalues are "
            f"{np.log(spectrum.values[some]).round(3).tolist()}, and a greater width reaches farther"
        )
    return np.asarray(spectrum.evaluate(points)[:, some] ** 2 @ (weights / total))


def _positive(name: str, numbers: ArrayLike) -> Floats:
    found = np.atleast_1d(np.asarray(numbers, dtype=np.float64))
    if not (found > 0).all() or not np.isfinite(found).all():
        raise FitError(f"{name}: {found.tolist()}; give positive numbers")
    return found
