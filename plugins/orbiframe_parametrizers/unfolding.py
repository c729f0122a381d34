"""Unfolding: from a first guess far away, even all vertices in one point, to the neighbourhood of a harmonic map."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import Triangulation
from orbiframe_parametrizers.harmonic_energy import HarmonicEnergy

Floats = NDArray[np.float64]

_STEPS = 60
_DECREMENT = 1e-6
_TOLERANCE = 1e-2
_HALVINGS = 20


def unfolded(start: Triangulation, weights: Floats) -> Floats:
    """Points (V, 3) near the minimum of sum w d^2 / 2 over the edges, for positive weights (H,), by Newton's method.

    The steps are solved to two digits. Stops where the decrement is 1e-6 of the energy, or where rounding lets no
    step lower the energy further: far from the origin points have an error of eps e^d and more, so a map that needs
    all digits has to move to patches.
    """
    energy, points = HarmonicEnergy(start, weights), start.points
    value = energy.value(points)
    for _ in range(_STEPS):
        step, decrement = energy.newton_step(points, _TOLERANCE)
        if not decrement > _DECREMENT * value:
            return points
        for halving in range(_HALVINGS):
            trial = energy.moved(points, step / 2**halving)
            new = energy.value(trial)
            if new < value:
                break
        else:
            return points
        points, value = trial, new
    return points
