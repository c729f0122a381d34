"""Sliding fit: the data slide along the surface to their foot points, and only distances along normals count."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import Basis, DifferentiableBasis, Samples
from orbiframe.functions import StartedFit, StartedFitter
from orbiframe_fitters.energy import FAIRING
from orbiframe_fitters.few_samples import few_samples
from orbiframe_fitters.least_squares import linear_fit, require_not_negative
from orbiframe_fitters.pinned import pinned
from orbiframe_fitters.slide import Slide
from orbiframe_fitters.sliding_data import Schedule

Floats = NDArray[np.float64]

# By the order of the energy; each entry holds until the next, the last one for all further steps. Points of a smooth
# surface are on both sides of a fit, so that what its curvature adds to the equations averages out, but for a tenth.
_SCHEDULES = {
    2: (Schedule(1e-4, 1e-2, 1e-3), Schedule(1e-4, 5e-3, 1e-3)),
    3: (Schedule(1e-4, 1e-3, 0.0, 0.1), Schedule(1e-6, 1e-4, 0.0, 0.1)),
}
# Between creases flat facets are flat in any parametrization, so that very little fairness is enough; beside curved
# ones more damping and some pull keep parameters from gliding away.
_FLAT = (Schedule(1e-5, 1e-3, 0.0), Schedule(1e-6, 1e-3, 0.0))
_CURVED = (Schedule(1e-5, 1e-2, 1e-4), Schedule(1e-6, 1e-2, 1e-4))


class Sliding(StartedFitter):
    """Squared distance minimisation (Pottmann, Leopoldseder and Hofer, 2002), from the linear least squares fit on.

    A datum v of weight w is near the surface if its foot point f is near, whatever its parameters are. Every step finds
    the feet by Newton's method in X and minimises the sum of w ((1 - t) (n . (S(f) - v))^2 + t |S(f) - v|^2) and the
    fairing, with the normal n at f and t = d / (d + rho) for the distance d and the smaller radius of curvature rho:
    Gauss and Newton's method, exact to second order. Between points of a smooth surface, which lie on both sides, d is
    counted a tenth. Fairness is measured in the metric of the surface as it is. Only
    three coordinates make a surface: other values, and functions without derivatives, are fitted by least squares.
    Fixed samples take no part; then the surface moves, as little as all samples and fairness allow, until it meets them
    and has their normals.

    fairing: how strongly ripples are damped, as in `least-squares`; by default that of each step, less than there,
    because far fewer conditions are set; steps: at most so many, and as many again while each takes off a sixth of the
    distance; it stops by itself when the distance falls no more.

    Raises UsageError for an option out of range, and what `least-squares` raises.
    """

    def __init__(self, *, fairing: float | None = None, steps: int = 5) -> None:
        require_not_negative("sliding", fairing=fairing, steps=steps)
        self.fairing = fairing
        self.steps = steps

    def fit_started(self, basis: Basis, samples: Samples) -> StartedFit:
        """The coefficients (size, d), and those of the linear fit; see the class. What is pinned begins at itself."""
        if samples.fixed is not None and samples.fixed.any():
            free = samples.take(np.flatnonzero(~samples.fixed))
            known = free.normals is not None and np.isfinite(free.normals).any()
            found = self.fit(basis, replace(free, fixed=None, normals=free.normals if known else None))
            met = pinned(basis, samples, found, self.fairing)
            return StartedFit(met, met)
        few = few_samples(basis, samples)
        first = linear_fit(basis, samples, self.fairing, few.fair)
        if samples.values.shape[1] != 3 or not isinstance(basis, DifferentiableBasis):
            return StartedFit(first.coefficients, first.coefficients)
        schedules = self._schedules(basis, samples, first.fairing)
        slide = Slide(basis, few.data, schedules, few.fair)
        found = slide.from_start(first.coefficients, self.steps)
        if few.data is not samples and self.steps:
            found = slide.with_all(found, samples, schedules[min(self.steps, len(schedules)) - 1])
        return StartedFit(first.coefficients, found)

    def _schedules(self, basis: Basis, samples: Samples, fairing: float) -> tuple[Schedule, ...]:
        """Those of the order of the energy, or the fairing that is given or that noise asks for."""
        order = min(samples.order, 2 if basis.smoothness < 2 else 3)
        schedules = _SCHEDULES[order]
        if samples.still is not None:
            schedules = _FLAT if samples.still.all() else _CURVED
        if self.fairing is None and fairing <= FAIRING[order]:
            return schedules
        return tuple(schedule._replace(fairing=fairing) for schedule in schedules)
