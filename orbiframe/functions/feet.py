"""Foot points: where on a surface the point lies that is nearest to a given one, by Newton's method in X."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.orbifolds.atlas import Points
from orbiframe.orbifolds.orbifold import Orbifold

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Where the Hessian of the squared distance is flatter than this share of that of a plane, it is taken as a plane's.
_FLAT = 0.05
# A target farther away than this share of the longest step may have found the wrong side of a ridge.
_FAR = 0.1
# A point that came nearer by less than this share of its distance is at the foot, and so is one whose next step would
# gain less than that share: a step of length s at distance d gains s^2 / (2 d).
_GAINED, _GAIN = 1e-6, 1e-8
# Whether a step minds the curvature of the surface, and how much of it is taken.
_TRIALS = ((True, 1.0), (False, 1.0), (False, 0.25))


def foot_step(jets: Floats, targets: Floats, longest: Floats | float, *, bent: bool = True) -> Floats:
    """One step of Newton's method from the points of a surface to the feet of targets, in the frames of X, (n, 2).

    jets: (6 or more, n, 3), values and covariant derivatives S, S1, S2, S11, S12, S22; targets: (n, 3); longest: how
    long a step may be in space, (n,) or one number. The half squared distance has the gradient -S_i (p - S) and the
    Hessian S_i S_j - S_ij (p - S); where that is not safely positive, and unless `bent`, without its second term (Gauss
    and Newton).
    """
    gap, slope = targets - jets[0], jets[1:3]
    plane = [_dot(slope[0], slope[0]), _dot(slope[0], slope[1]), _dot(slope[1], slope[1])]
    a, b, c = _safe(plane, [x - _dot(gap, second) for x, second in zip(plane, jets[3:6], strict=True)], bent)
    right = _dot(slope[0], gap), _dot(slope[1], gap)
    determinant = np.maximum(a * c - b * b, np.finfo(float).tiny)
    with np.errstate(all="ignore"):  # what is no number is no step
        step = np.stack([c * right[0] - b * right[1], a * right[1] - b * right[0]], axis=1) / determinant[:, None]
        length = np.linalg.norm(step[:, :1] * slope[0] + step[:, 1:] * slope[1], axis=1)
        shortened = step * np.minimum(1.0, longest / np.maximum(length, np.finfo(float).tiny))[:, None]
    return np.where(np.isfinite(shortened).all(axis=1)[:, None], shortened, 0.0)


def _safe(plane: list[Floats], curved: list[Floats], bent: bool) -> list[Floats]:
    """The Hessian of a curved surface where it is positive, else that of its tangent plane."""
    area = plane[0] * plane[2] - plane[1] ** 2
    safe = (curved[0] > 0) & (curved[0] * curved[2] - curved[1] ** 2 > _FLAT * area) & bent
    return [np.where(safe, x, y) for x, y in zip(curved, plane, strict=True)]


def around(jets: Floats, radius: Floats | float, count: int = 8) -> Floats:
    """Tangent vectors in the frames of X, (count, n, 2), to points evenly round each point of a surface, so far off."""
    slope = jets[1:3]
    first = np.sqrt(np.maximum(_dot(slope[0], slope[0]), np.finfo(float).tiny))
    mixed = _dot(slope[0], slope[1]) / first
    second = np.sqrt(np.maximum(_dot(slope[1], slope[1]) - mixed**2, 1e-6 * first**2))
    angle = 2 * np.pi * np.arange(count)[:, None] / count
    v = radius * np.sin(angle) / second
    return np.stack([(radius * np.cos(angle) - mixed * v) / first, v], axis=2)


def moved(orbifold: Orbifold, points: Points, step: Floats) -> Points:
    """Points carried along geodesics of X by tangent vectors in their frames, (n, 2), and into the nearest patches.

    Vectors longer than the unit of length, in E^2 than the root of the area, are cut to it: no step of Newton means so
    much, and numbers stay near the origin. A vector that is not finite moves nothing.
    """
    geometry = orbifold.geometry
    longest = 1.0 if geometry.curvature else float(np.sqrt(orbifold.area))
    length = np.hypot(step[:, :1], step[:, 1:])
    step = np.where(np.isfinite(length), step * (longest / np.maximum(length, longest)), 0.0)
    x = geometry.settle(geometry.exp(points.x, np.einsum("nij,nj->ni", geometry.frame(points.x), step)))
    return orbifold.settled(Points(points.patch, x))


class FootPoints(NamedTuple):
    """The feet of targets, their distances (n,), and the jets of the surface there, (6, n, 3)."""

    points: Points
    distance: Floats
    jets: Floats


def foot_points(
    basis: DifferentiableBasis, coefficients: Floats, points: Points, targets: Floats, longest: float, steps: int = 4
) -> tuple[Points, Floats]:
    """The feet of targets (n, 3) found from starting points, and their distances (n,); never farther than the start.

    longest: how long a step may be in space. Where a step of Newton's comes no nearer, one of Gauss and Newton's is
    tried, and a quarter of it. Targets that are still far may have their foot beyond a ridge: they look for it round
    about, and begin anew.
    """
    return feet_of(basis, coefficients, points, targets, longest, steps)[:2]


def feet_of(
    basis: DifferentiableBasis,
    coefficients: Floats,
    points: Points,
    targets: Floats,
    longest: float,
    steps: int = 4,
    jets: Floats | None = None,
) -> FootPoints:
    """The same with jets; jets: (6, n, 3), those at the starting points where they are known already."""
    begin = Points(np.array(points.patch), np.array(points.x))
    found = _Search(basis, coefficients, begin, np.asarray(targets), longest, jets)
    found.descend(np.arange(len(targets)), steps)
    far = np.flatnonzero(found.distance > _FAR * longest)
    found.descend(found.elsewhere(far), steps)
    return FootPoints(found.points, found.distance, found.jets)


class _Search:
    """Points on their way to the feet of targets; `points`, `jets` and `distance` change."""

    def __init__(
        self,
        basis: DifferentiableBasis,
        coefficients: Floats,
        points: Points,
        targets: Floats,
        longest: float,
        jets: Floats | None = None,
    ) -> None:
        self.basis, self.coefficients, self.targets, self.longest = basis, coefficients, targets, longest
        self.points = points
        self.jets = basis.jets(points, coefficients, 2) if jets is None else jets.copy()
        self.distance = np.linalg.norm(targets - self.jets[0], axis=1)

    def descend(self, active: Ints, steps: int) -> None:
        """Newton's method for some of the points, until they come no nearer."""
        for _ in range(steps):
            if not len(active):
                return
            before, left = self.distance[active], active
            for bent, share in _TRIALS:
                step = share * foot_step(self.jets[:, left], self.targets[left], self.longest, bent=bent)
                if bent:
                    there = self._arrived(left, step)
                    left, step = left[~there], step[~there]
                left = left[~self._tried(left, step)]
            active = active[self.distance[active] < before * (1 - _GAINED)]

    def elsewhere(self, far: Ints) -> Ints:
        """Those of some points that are nearer to their targets at one of eight places about them, and go there."""
        found = np.zeros(len(far), dtype=np.bool_)
        for step in around(self.jets[:, far], self.longest / 2) if len(far) else ():
            found |= self._tried(far, step)
        return far[found]

    def _arrived(self, active: Ints, step: Floats) -> Bools:
        """Those of some points that a step of Newton's would bring no nearer that counts."""
        way = step[:, :1] * self.jets[1, active] + step[:, 1:] * self.jets[2, active]
        return np.asarray(np.linalg.norm(way, axis=1) <= np.sqrt(2 * _GAIN) * self.distance[active])

    def _tried(self, active: Ints, step: Floats) -> Bools:
        """Some of the points moved where that comes nearer; which of them."""
        trial = moved(self.basis.orbifold, Points(self.points.patch[active], self.points.x[active]), step)
        jets = self.basis.jets(trial, self.coefficients, 2)
        distance = np.linalg.norm(self.targets[active] - jets[0], axis=1)
        better = distance < self.distance[active]
        chosen = active[better]
        self.points.patch[chosen], self.points.x[chosen] = trial.patch[better], trial.x[better]
        self.jets[:, chosen], self.distance[chosen] = jets[:, better], distance[better]
        return np.asarray(better)


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("ni,ni->n", a, b))
