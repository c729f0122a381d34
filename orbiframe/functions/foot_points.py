"""Foot points: where on a surface the point lies that is nearest to a given one, by Newton's method in X."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.orbifolds.atlas import Points
from orbiframe.orbifolds.orbifold import Orbifold

Floats = NDArray[np.float64]

# Where the Hessian of the squared distance is flatter than this share of that of a plane, it is taken as a plane's.
_FLAT = 0.05


def foot_step(jets: Floats, targets: Floats, longest: Floats | float) -> Floats:
    """One step of Newton's method from the points of a surface to the feet of targets, in the frames of X, (n, 2).

    jets: (6 or more, n, 3), values and covariant derivatives S, S1, S2, S11, S12, S22; targets: (n, 3); longest: how
    long a step may be in space, (n,) or one number. The half squared distance has the gradient -S_i (p - S) and the
    Hessian S_i S_j - S_ij (p - S); where that is not safely positive, without its second term (Gauss and Newton).
    """
    gap, slope = targets - jets[0], jets[1:3]
    plane = [_dot(slope[0], slope[0]), _dot(slope[0], slope[1]), _dot(slope[1], slope[1])]
    bent = [a - _dot(gap, second) for a, second in zip(plane, jets[3:6], strict=True)]
    area = plane[0] * plane[2] - plane[1] ** 2
    safe = (bent[0] > 0) & (bent[0] * bent[2] - bent[1] ** 2 > _FLAT * area)
    a, b, c = (np.where(safe, x, y) for x, y in zip(bent, plane, strict=True))
    right = _dot(slope[0], gap), _dot(slope[1], gap)
    determinant = np.maximum(a * c - b * b, np.finfo(float).tiny)
    step = np.stack([c * right[0] - b * right[1], a * right[1] - b * right[0]], axis=1) / determinant[:, None]
    length = np.linalg.norm(step[:, :1] * slope[0] + step[:, 1:] * slope[1], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        shortened = step * np.minimum(1.0, longest / np.maximum(length, np.finfo(float).tiny))[:, None]
    return np.where(np.isfinite(shortened).all(axis=1)[:, None], shortened, 0.0)


def moved(orbifold: Orbifold, points: Points, step: Floats) -> Points:
    """Points carried along geodesics of X by tangent vectors in their frames, (n, 2), and into the nearest patches."""
    geometry = orbifold.geometry
    x = geometry.settle(geometry.exp(points.x, np.einsum("nij,nj->ni", geometry.frame(points.x), step)))
    return orbifold.settled(Points(points.patch, x))


def foot_points(
    basis: DifferentiableBasis, coefficients: Floats, points: Points, targets: Floats, longest: float, steps: int = 4
) -> tuple[Points, Floats]:
    """The feet of targets (n, 3) found from starting points, and their distances (n,); never farther than the start.

    longest: how long a step may be in space. A step that comes no nearer is taken to a quarter, or not at all.
    """
    points = Points(np.array(points.patch), np.array(points.x))
    active = np.arange(len(targets))
    jets = basis.jets(points, coefficients, 2)
    distance = np.linalg.norm(targets - jets[0], axis=1)
    for _ in range(steps):
        step = foot_step(jets, targets[active], longest)
        gained = np.zeros(len(active))
        for share in (1.0, 0.25):
            left = np.flatnonzero(gained == 0)
            here = Points(points.patch[active[left]], points.x[active[left]])
            trial = moved(basis.orbifold, here, share * step[left])
            there = basis.jets(trial, coefficients, 2)
            new = np.linalg.norm(targets[active[left]] - there[0], axis=1)
            better = np.flatnonzero(new < distance[active[left]])
            chosen = active[left[better]]
            gained[left[better]] = 1 - new[better] / distance[chosen]
            points.patch[chosen], points.x[chosen] = trial.patch[better], trial.x[better]
            jets[:, left[better]], distance[chosen] = there[:, better], new[better]
        going = np.flatnonzero(gained > 1e-6)
        active, jets = active[going], jets[:, going]
        if not len(active):
            break
    return points, distance


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("ni,ni->n", a, b))
