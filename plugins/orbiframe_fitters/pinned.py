"""Pinned surfaces: a fit moved, as little as its data and its fairness allow, until it meets fixed samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import Basis, DifferentiableBasis, FitError, Points, Samples
from orbiframe.functions import foot_points
from orbiframe_fitters.energy import FAIRING, energy_of, spacing
from orbiframe_fitters.given_normals import with_normals
from orbiframe_fitters.smoothing_system import SmoothingSystem

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Of how many samples it is told what they are beyond the move: nobody asks.
_TOLD = np.arange(1)
# By so many times what the fixed samples lack others may move.
_WILD = 5.0


def pinned(basis: Basis, samples: Samples, coefficients: Floats, fairing: float | None) -> Floats:
    """The coefficients (size, d) of the nearest functions that meet the fixed samples.

    Each fixed sample is met at the foot of its value. What is added is 0 at all other samples, in the weighted mean
    square and with fairness between, and at the fixed ones what they lack; normals follow where they are known. Raises
    FitError for conditions that cannot be met together, with their rank and which of them.
    """
    chosen = np.flatnonzero(np.asarray(samples.fixed))
    samples = _at_feet(basis, samples, coefficients, chosen)
    lacking = np.zeros_like(samples.values)
    lacking[chosen] = samples.values[chosen] - basis.values(samples.take(chosen).points, coefficients)
    system = SmoothingSystem.of(basis, replace(samples, values=lacking))
    amount = FAIRING[energy_of(basis, samples).order] if fairing is None else fairing
    move = system.fit(amount, _TOLD)
    _require_calm(samples, lacking, basis.values(samples.points, move.coefficients), chosen)
    return with_normals(basis, samples, move.posterior, coefficients + move.coefficients)


def _require_calm(samples: Samples, lacking: Floats, move: Floats, chosen: Ints) -> None:
    """Raises FitError where other data must move far more than the fixed ones do: those pull against each other."""
    move = np.where(samples.weights[:, None] > 0, move, 0.0)
    size, most = (float(np.linalg.norm(part, axis=1).max(initial=0)) for part in (move, lacking))
    if size <= _WILD * most:
        return
    near = np.linalg.norm(samples.values - samples.values[int(np.linalg.norm(move, axis=1).argmax())], axis=1)[chosen]
    first, *others = np.argsort(near, kind="stable")[:2].tolist()
    named = " and ".join(str(number) for number in (first, *others))
    raise FitError(
        f"the surface would move by {size / most:.2g} times what the fixed points lack: so many functions cannot "
        f"follow fixed point {named}, which pull apart; move them, or raise the option size"
    )


def _at_feet(basis: Basis, samples: Samples, coefficients: Floats, chosen: Ints) -> Samples:
    """The samples with the chosen ones at the points of X where a surface is nearest to their values."""
    if samples.values.shape[1] != 3 or not isinstance(basis, DifferentiableBasis):
        return samples
    patch, x, part = samples.points.patch.copy(), samples.points.x.copy(), samples.take(chosen)
    feet, _ = foot_points(basis, coefficients, part.points, part.values, spacing(basis, samples))
    patch[chosen], x[chosen] = feet.patch, feet.x
    return replace(samples, points=Points(patch, x))
