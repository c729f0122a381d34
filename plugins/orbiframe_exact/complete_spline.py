"""Complete splines: quintic splines from 0 to 1 by their ends, the slopes there, and values at their knots."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

DEGREE = 5
# Neighbouring intervals differ by this factor at most.
_RATIO = 2.01


def full_knots(breaks: Floats) -> Floats:
    """All knots of the splines with simple knots at the breaks 0, ..., 1, those at the ends six times."""
    return np.concatenate([np.zeros(DEGREE), breaks, np.ones(DEGREE)])


def sites(breaks: Floats) -> Floats:
    """Where values are given besides those at the ends: inner breaks, middles of the first and last interval.

    As many as make, with two ends and two slopes, the number of functions; two intervals at least.
    """
    middles = (breaks[:-1] + breaks[1:])[[0, -1]] / 2
    return np.sort(np.concatenate([breaks[1:-1], middles]))


def abscissae(breaks: Floats) -> Floats:
    """The ends and the sites, in order."""
    return np.concatenate([[0.0], sites(breaks), [1.0]])


def operator(breaks: Floats) -> Floats:
    """From control points to the data f(0), f'(0), f(sites), f'(1), f(1), square."""
    knots = full_knots(breaks)
    values = BSpline.design_matrix(abscissae(breaks), knots, DEGREE).toarray()
    slopes = BSpline(knots, np.eye(len(knots) - DEGREE - 1), DEGREE).derivative()(np.array([0.0, 1.0]))
    return np.concatenate([values[:1], slopes[:1], values[1:-1], slopes[1:], values[-1:]])


def data(values: Floats, slopes: Floats) -> Floats:
    """The data of a spline from its values and slopes at the abscissae, (n, 3)."""
    return np.concatenate([values[:1], slopes[:1], values[1:-1], slopes[-1:], values[-1:]])


def evaluate(breaks: Floats, poles: Floats, at: Floats, derivative: int = 0) -> Floats:
    """The spline, or a derivative, at parameters (n,)."""
    return np.asarray(BSpline(full_knots(breaks), poles, DEGREE)(at, nu=derivative))


def evaluate_grid(breaks: tuple[Floats, Floats], poles: Floats, s: Floats, t: Floats, nu: tuple[int, int]) -> Floats:
    """A tensor product, or a derivative, on a grid of parameters, (n_s, n_t, 3)."""
    rows = evaluate(breaks[0], poles, s, nu[0])
    return np.swapaxes(evaluate(breaks[1], np.swapaxes(rows, 0, 1), t, nu[1]), 0, 1)


def bisected(breaks: Floats, wanted: Bools) -> Floats:
    """The breaks with some intervals halved, and others until neighbours differ by a factor of two at most."""
    return graded(np.sort(np.concatenate([breaks, ((breaks[:-1] + breaks[1:]) / 2)[wanted]])))


def sharing(at: Floats, weight: Floats, share: float, most: int) -> Floats:
    """Breaks at halves of halves, so that no interval holds more than a share of the weight (n,) at parameters (n,).

    An interval is halved so often at most.
    """
    order = np.argsort(at)
    at, upto = at[order], np.concatenate([[0.0], np.cumsum(weight[order])])
    breaks = np.array([0.0, 1.0])
    for _ in range(most):
        held = np.diff(upto[np.searchsorted(at, breaks, side="right")])
        if not (held > share * upto[-1]).any():
            break
        breaks = np.sort(np.concatenate([breaks, ((breaks[:-1] + breaks[1:]) / 2)[held > share * upto[-1]]]))
    return graded(breaks)


def graded(breaks: Floats) -> Floats:
    """The breaks with intervals halved until neighbours differ by a factor of two at most."""
    while (wanted := _too_long(breaks)).any():
        breaks = np.sort(np.concatenate([breaks, ((breaks[:-1] + breaks[1:]) / 2)[wanted]]))
    return breaks


def _too_long(breaks: Floats) -> Bools:
    length = np.diff(breaks)
    wanted = np.zeros(len(length), dtype=np.bool_)
    wanted[:-1] |= length[:-1] > _RATIO * length[1:]
    wanted[1:] |= length[1:] > _RATIO * length[:-1]
    return wanted


def holding(breaks: Floats, at: Floats) -> Bools:
    """The intervals that hold some of the parameters."""
    found = np.zeros(len(breaks) - 1, dtype=np.bool_)
    found[np.clip(np.searchsorted(breaks, at) - 1, 0, len(found) - 1)] = True
    return found


def refined(breaks: Floats, finer: Floats, poles: Floats) -> Floats:
    """The control points (n, ...) of a spline with more breaks: the same function, by values at Greville's points."""
    if len(finer) == len(breaks):
        return poles
    knots = full_knots(finer)
    at = np.array([knots[n + 1 : n + 1 + DEGREE].mean() for n in range(len(knots) - DEGREE - 1)])
    values = evaluate(breaks, poles, at)
    matrix = BSpline.design_matrix(at, knots, DEGREE).toarray()
    return np.asarray(np.linalg.solve(matrix, values.reshape(len(at), -1)).reshape(len(at), *poles.shape[1:]))
