"""Vertex scaling: factors at the vertices that make the metric of the mesh hyperbolic, in its conformal class."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe import MapError, Polyhedron
from orbiframe_parametrizers.elimination import Successive
from orbiframe_parametrizers.flips import Flippable

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_TOLERANCE = 1e-10
_STEPS = 60
_HALVINGS = 30


@dataclass(frozen=True, eq=False)
class Scaling:
    """A hyperbolic metric on a flipped triangulation: lengths (H,), corner angles (H,), and the Newton steps."""

    triangulation: Flippable
    lengths: Floats
    angles: Floats
    steps: int


def scaled(mesh: Polyhedron, sides: Floats | None = None) -> Scaling:
    """The hyperbolic metric that is discretely conformal to the mesh: sinh(l/2) = exp((u_i + u_j)/2) L_ij.

    sides: (H,), edge lengths that take the place of those in space, where another metric is meant.

    Newton on the convex energy whose gradient is 2 pi minus the angle sum. The triangulation is first made Delaunay in
    the metric of the mesh, and after every change of u again by Ptolemy flips, which stay in the conformal class; with
    them the solution exists and is unique for every mesh with chi < 0 (Gu, Guo, Luo, Sun, Wu 2018; Springborn 2019;
    Gillespie, Springborn, Crane 2021).
    Raises MapError where it stalls in rounding.
    """
    lengths = mesh.edge_lengths if sides is None else sides
    area = _area(lengths.reshape(-1, 3))
    chi = len(mesh.vertices) - mesh.edge_count + mesh.face_count
    if not (lengths.min() > 0 and area > 0):
        raise MapError("vertex scaling needs edges of positive length; weld coincident vertices first")
    start = Flippable(mesh, lengths * np.sqrt(2 * np.pi * abs(chi) / area) / 2)
    start.make_delaunay(flat=True)
    state = _State(start)
    tolerance = max(_TOLERANCE, 4e-16 * float(np.bincount(mesh.tail).max()))
    systems = Successive()
    for step in range(_STEPS):
        if state.worst < tolerance:
            return Scaling(state.triangulation, state.lengths, state.angles.ravel(), step)
        further = _searched(state, _direction(state, systems))
        if further is None:
            break
        state = further
    raise MapError(f"vertex scaling stopped at an angle error of {state.worst:.1e}; use circle packing instead")


def _area(sides: Floats) -> float:
    """The area of all triangles with given sides (F, 3), by Heron's formula in the stable order of Kahan."""
    c, b, a = np.sort(sides, axis=1).T
    square = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))
    return float(np.sqrt(np.maximum(square, 0.0)).sum() / 4)


class _State:
    """A Delaunay triangulation with its lengths, angles (F, 3) and 2 pi minus the angle sums (V,)."""

    def __init__(self, triangulation: Flippable) -> None:
        self.triangulation = triangulation
        self.lengths = 2 * np.arcsinh(triangulation.x)
        sides = self.lengths.reshape(-1, 3)
        self.angles = _corner_angles(sides)
        sums = np.bincount(triangulation.tail, weights=self.angles.ravel(), minlength=len(triangulation.start.vertices))
        self.curvatures = 2 * np.pi - sums

    @property
    def worst(self) -> float:
        return float(np.abs(self.curvatures).max())


def _corner_angles(sides: Floats) -> Floats:
    """Angles (F, 3) at the corners of hyperbolic triangles; side k runs from corner k to corner k + 1.

    tan^2(theta_0 / 2) = sinh(s - b) sinh(s - c) / (sinh s sinh(s - a)) with a opposite; s - a as (b + c - a) / 2.
    """
    following, opposite, before = sides, np.roll(sides, -1, 1), np.roll(sides, -2, 1)
    with np.errstate(all="ignore"):
        half = sides.sum(axis=1, keepdims=True) / 2
        top = np.sinh((opposite + before - following) / 2) * np.sinh((opposite + following - before) / 2)
        bottom = np.sinh(half) * np.sinh((following + before - opposite) / 2)
        return np.asarray(2 * np.arctan(np.sqrt(top / bottom)))


def _direction(state: _State, systems: Successive) -> Floats:
    """The Newton step (V,): minus the inverse Hessian times the curvatures."""
    triangles = state.triangulation.triangles
    sides = state.lengths.reshape(-1, 3)
    angles = state.angles
    cosines, opposite = np.cos(angles), np.roll(sides, -1, 1)
    area = np.sinh(sides) * np.sinh(np.roll(sides, -2, 1)) * np.sin(angles)
    to_opposite = np.sinh(opposite) / area
    growth = np.tanh(sides / 2)
    count = len(state.curvatures)
    diagonal = np.zeros(count)
    ends, values = [], []
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        # The angle at corner a by its opposite side (b, c) and by the sides (a, b) and (c, a).
        by_opposite = to_opposite[:, a] * growth[:, b]
        by_next = -cosines[:, b] * to_opposite[:, a] * growth[:, a]
        by_last = -cosines[:, c] * to_opposite[:, a] * growth[:, c]
        diagonal -= np.bincount(triangles[:, a], weights=by_next + by_last, minlength=count)
        ends.append((triangles[:, a], triangles[:, b]))
        values.append(-(by_opposite + by_next))
    i, j = (np.concatenate(part) for part in zip(*ends, strict=True))
    entries: Floats = np.concatenate(values).astype(np.float64)
    right = np.asarray(-state.curvatures, dtype=np.float64)
    # A flipped edge is fill in the order of another triangulation, so what is factored has an order of its own.
    mesh = state.triangulation.mesh() if len(state.triangulation.log) else state.triangulation.start
    return systems.solution(mesh, (i, j), entries, diagonal, right)


def _searched(state: _State, step: Floats) -> _State | None:
    """The first of the steps 1, 1/2, 1/4, ... that makes the error fall or keeps the sign of the slope."""
    slope = float(state.curvatures @ step)
    size = min(1.0, 4.0 / max(float(np.abs(step).max()), 1e-300))
    for _ in range(_HALVINGS):
        trial = _State(state.triangulation.scaled(size * step))
        if np.isfinite(trial.curvatures).all():
            falls = np.linalg.norm(trial.curvatures) < np.linalg.norm(state.curvatures)
            if falls or float(trial.curvatures @ step) * slope > 0:
                return trial
        size /= 2
    return None
