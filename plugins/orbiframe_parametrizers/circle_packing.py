"""Circle packing: radii at the vertices for which all angle sums are 2 pi, hence a metric of constant curvature."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe import MapError, Polyhedron
from orbiframe_parametrizers.advice import advice
from orbiframe_parametrizers.elimination import Successive

Floats = NDArray[np.float64]

_TOLERANCE = 1e-11
_ACCEPTED = 1e-9
_STEPS = 100
_HALVINGS = 40


@dataclass(frozen=True, eq=False)
class Packing:
    """Radii (V,) of a circle packing, its edge lengths (H,) r_i + r_j, corner angles (H,), and the Newton steps."""

    radii: Floats
    lengths: Floats
    angles: Floats
    steps: int


def packed(mesh: Polyhedron, curvature: int, *, without_face: int | None = None) -> Packing:
    """The tangential circle packing of a closed triangulation in the hyperbolic (-1) or Euclidean (0) plane.

    without_face: pack a sphere without that face in the Euclidean plane, its three corners having radius 1.

    Unknown u = ln tanh(r/2) (ln r in the plane), Newton on the convex energy whose gradient is 2 pi minus the angle
    sum; its Hessian is symmetric with positive off-diagonal weights. It exists and is unique (up to scale in the
    plane) for every triangulation of a closed surface with chi < 0 (chi = 0), orientable or not: Koebe, Andreev,
    Thurston; Bobenko and Springborn 2004. Raises MapError if 100 steps do not bring all angle sums to 2 pi.
    """
    law = PackingLaw(mesh, curvature, without_face)
    state = law.state(law.start)
    # Rounding: an angle sum of n terms carries about n eps; below that no step can help.
    tolerance = max(_TOLERANCE, 4e-16 * float(np.bincount(mesh.tail).max()))
    steps = 0
    while state.worst >= tolerance and steps < _STEPS:
        try:
            further = law.search(state, law.newton_direction(state))
        except MapError:  # singular equations
            break
        if further is None:
            break
        state, steps = further, steps + 1
    if not state.worst < _ACCEPTED:
        raise MapError(
            f"the circle packing stopped at an angle error of {state.worst:.1e}, {_ACCEPTED:.0e} is allowed; "
            f"{advice(mesh, digits=float(np.ptp(state.u)) / np.log(10))}"
        )
    radii = law.radii(state.u)
    return Packing(radii, radii[mesh.tail] + radii[mesh.head], state.angles.ravel(), steps)


@dataclass(frozen=True, eq=False)
class State:
    """Where the iteration stands: unknowns u (V,), corner angles (F, 3), 2 pi minus the angle sums (V,)."""

    u: Floats
    angles: Floats
    curvatures: Floats

    @property
    def worst(self) -> float:
        """The largest error of an angle sum."""
        return float(np.abs(self.curvatures).max())


class PackingLaw:
    """Angles of three mutually tangent circles and their derivatives, for one mesh and one curvature."""

    def __init__(self, mesh: Polyhedron, curvature: int, without_face: int | None = None) -> None:
        self.mesh = mesh
        self.curvature = curvature
        self.triangles = mesh.triangles
        self.count = len(mesh.vertices)
        self.missing = np.arange(mesh.face_count) == without_face
        self.fixed = np.zeros(self.count, dtype=np.bool_)
        self.fixed[self.triangles[self.missing]] = True
        once = np.flatnonzero(mesh.representative)
        self.edges = once, mesh.twin[once]
        self.systems = Successive()

    @property
    def start(self) -> Floats:
        """Equal radii; in the hyperbolic plane those for which the mean corner angle is right, hence the total area.

        Three equal circles have tan^2(theta/2) = sinh r / sinh 3r = 1 / (3 + 4 sinh^2 r).
        """
        if self.curvature == 0:
            return np.zeros(self.count)
        half_angle = np.pi * self.count / (3 * len(self.triangles))
        sinh = np.sqrt(np.tan(half_angle) ** -2 - 3) / 2
        return np.full(self.count, np.log(sinh / (1 + np.hypot(1, sinh))))

    def state(self, u: Floats) -> State:
        """The angles and their errors for given unknowns."""
        angles = self._angles(u)
        counted = np.where(self.missing[:, None], 0.0, angles)
        sums = np.bincount(self.triangles.ravel(), weights=counted.ravel(), minlength=self.count)
        return State(u, angles, np.where(self.fixed, 0.0, 2 * np.pi - sums))

    def radii(self, u: Floats) -> Floats:
        """The radii (V,) for the unknowns u."""
        return np.asarray(2 * np.arctanh(np.exp(u)) if self.curvature else np.exp(u))

    def _sine(self, length: Floats) -> Floats:
        return np.asarray(np.sinh(length)) if self.curvature else length

    def _angles(self, u: Floats) -> Floats:
        """Corner angles (F, 3): tan^2(theta_0 / 2) = sinh r1 sinh r2 / (sinh r0 sinh(r0 + r1 + r2))."""
        r = self.radii(u)[self.triangles]
        s = self._sine(r)
        whole = self._sine(r.sum(axis=1))
        return np.asarray(2 * np.arctan(np.sqrt(np.roll(s, -1, 1) * np.roll(s, -2, 1) / (s * whole[:, None]))))

    def newton_direction(self, state: State) -> Floats:
        """The step (V,) of Newton's method; 0 at fixed vertices."""
        coupling, diagonal = self.hessian(state)
        if self.curvature == 0 and not self.fixed.any():
            # Scale is free in the plane: the curvatures sum to zero, so holding one vertex changes nothing else.
            diagonal[0] += diagonal.mean()
        once, _ = self.edges
        edges = self.mesh.tail[once], self.mesh.head[once]
        return self.systems.solution(self.mesh, edges, -coupling, diagonal, -state.curvatures)

    def hessian(self, state: State) -> tuple[Floats, Floats]:
        """The derivatives of the curvatures: minus the entry at every edge, (E,), and the diagonal, (V,)."""
        angles = state.angles
        r = self.radii(state.u)[self.triangles]
        s = self._sine(r)
        opposite = self._sine(np.roll(r, -1, 1) + np.roll(r, -2, 1))
        area = np.roll(opposite, -1, 1) * np.roll(opposite, -2, 1) * np.sin(angles)
        ratio = np.where(self.missing[:, None], 0.0, opposite / area)
        versed = 2 * np.sin(angles / 2) ** 2
        cosine = np.cos(angles)
        to_next = (np.roll(s * versed, -1, 1) * ratio).ravel()
        own = s * ratio * (np.roll(cosine, -1, 1) + np.roll(cosine, -2, 1))
        once, twin = self.edges
        held = self.fixed[self.mesh.tail[once]] | self.fixed[self.mesh.head[once]]
        coupling = np.where(held, 0.0, to_next[once] + to_next[twin])
        diagonal = np.bincount(self.triangles.ravel(), weights=own.ravel(), minlength=self.count)
        return coupling, np.where(self.fixed, 1.0, diagonal)

    def search(self, state: State, step: Floats) -> State | None:
        """The state after the longest of 1, 1/2, 1/4, ... steps that is good, or None.

        Good: u < 0 (curvature -1), and the error falls or the slope of the energy keeps its sign.
        """
        slope = float(state.curvatures @ step)
        for halving in range(_HALVINGS):
            u = state.u + step / 2**halving
            if self.curvature and not u.max() < 0:
                continue
            trial = self.state(u)
            falls = np.linalg.norm(trial.curvatures) < np.linalg.norm(state.curvatures)
            if np.isfinite(trial.worst) and (falls or float(trial.curvatures @ step) * slope > 0):
                return trial
        return None
