"""Harmonic energy: the sum of weights times squared distances over the edges of a map to X/H, and its minimiser."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array

from orbiframe import Geometry, MapError, Triangulation
from orbiframe.workers import chosen_solver
from orbiframe_parametrizers.elimination import Elimination, by_conjugate_gradients, factorised, solver_on

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_STEPS = 40
_PATIENCE, _LIMIT = 15, 100
_SHORT = 0.3
_DECREMENT = 1e-10
_SMALLEST_STEP = 1e-6
_LONGEST_STEP = 500.0  # in units of curvature


def minimised(start: Triangulation, weights: Floats) -> Floats:
    """The points (V, 3), each in the frame of its patch, that minimise sum w d^2 / 2 over the edges; by Newton.

    start: the group and the first guess; weights: (H,). Strictly convex in H^2 for positive weights, so that the
    minimum is unique, and an embedding (Colin de Verdiere 1991, Hass and Scott 2015); a linear system in E^2. Stops
    on the Newton decrement. Raises MapError if 40 steps do not suffice.
    """
    energy = HarmonicEnergy(start, weights)
    points = start.points
    value = energy.value(points)
    for _ in range(_STEPS):
        step, decrement = energy.newton_step(points)
        if decrement == 0:
            return points
        further = _search(energy, points, value, step, decrement)
        if further is None:
            break
        points, value = further
        if decrement < _DECREMENT * abs(value):
            return points
    raise MapError("the harmonic map did not converge; try map.weights = 'mean-value' or 'uniform'")


def _search(
    energy: HarmonicEnergy, points: Floats, value: float, step: Floats, decrement: float
) -> tuple[Floats, float] | None:
    """Points and energy after the longest of 1, 1/2, 1/4, ... steps with enough descent (Armijo), or None.

    The first of them is shorter where rounding of a nearly singular Hessian sends points farther than X has floats.

    None too where the energy is not convex, as happens with negative weights.
    """
    size = min(1.0, _LONGEST_STEP / max(float(np.linalg.norm(step, axis=1).max()), np.finfo(float).tiny))
    while decrement > 0 and size > _SMALLEST_STEP:
        trial = energy.moved(points, size * step)
        new = energy.value(trial)
        if new <= value - 1e-4 * size * decrement + 1e-13 * abs(value):
            return trial, new
        size /= 2
    return None


@dataclass(frozen=True, eq=False)
class Terms:
    """Gradient of d^2/2 at both ends (E, 2) each, and the three blocks of its Hessian (E, 2, 2)."""

    tail: Floats
    head: Floats
    tail_tail: Floats
    head_head: Floats
    tail_head: Floats


class HarmonicEnergy:
    """The sum of w d^2 / 2 over the edges as a function of the points, with its derivatives.

    start: the mesh and the group; weights: (H,), the same on both halfedges of an edge.
    """

    def __init__(self, start: Triangulation, weights: Floats) -> None:
        mesh, orbifold = start.polyhedron, start.orbifold
        self.geometry: Geometry = orbifold.geometry
        edges = np.flatnonzero(mesh.representative)
        self.tail, self.head = mesh.tail[edges], mesh.head[edges]
        # Most edges stay in their patch, where both ends are seen from one frame.
        self.crossing = np.flatnonzero(start.transition[edges])
        self.isometry = orbifold.atlas.isometry[start.transition[edges[self.crossing]]]
        self.weights = weights[edges]
        self.count = len(mesh.vertices)
        self.mesh = mesh
        every = np.arange(self.count)
        rows, columns = np.concatenate([self.tail, self.head, every]), np.concatenate([self.head, self.tail, every])
        self._by_row = np.argsort(rows, kind="stable")
        self._columns = columns[self._by_row]
        self._starts = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=self.count))])
        self._near: Callable[[Floats], Floats] | None = None
        self._moved = 0.0
        # Frames that all have one orientation make the Hessian nearly complex linear: see newton_step.
        self.complex = bool(orbifold.orientable and (self.geometry.parity(orbifold.atlas.isometry) > 0).all())

    def value(self, points: Floats) -> float:
        """The energy of points (V, 3)."""
        return float(self.weights @ self.geometry.distance(points[self.tail], self._heads(points)) ** 2) / 2

    def _heads(self, points: Floats) -> Floats:
        """The heads of the edges (E, 3), or vectors there (E, 3, n), seen from the patches of their tails."""
        seen = points[self.head]
        moved = seen[self.crossing].reshape(len(self.crossing), 3, -1)
        seen[self.crossing] = (self.isometry @ moved).reshape(seen[self.crossing].shape)
        return seen

    def moved(self, points: Floats, step: Floats) -> Floats:
        """The points after a step (V, 2), given in the frames at the points, along geodesics."""
        velocity = np.einsum("vij,vj->vi", self.geometry.frame(points), step)
        return self.geometry.exp(points, velocity)

    def terms(self, points: Floats) -> Terms:
        """The derivatives of every term, without those of the edges' common sum."""
        geometry = self.geometry
        here, there = points[self.tail], self._heads(points)
        frame = geometry.frame(points)
        at_tail = frame[self.tail]
        at_head = self._heads(frame)
        form = np.array([geometry.curvature, 1.0, 1.0])
        chord = geometry.chord(here, there)
        tail = -np.einsum("eia,ei->ea", at_tail, form * chord)
        head = np.einsum("eia,ei->ea", at_head, form * chord)
        versine = geometry.versine(here, there)
        first, second = _square_distance_derivatives(geometry, versine)
        a = (self.weights * first)[:, None, None]
        b = (self.weights * second)[:, None, None]
        diagonal = a * (1 - geometry.curvature * versine)[:, None, None] * np.eye(2)
        mixed = -np.einsum("eia,i,eib->eab", at_tail, form, at_head)
        return Terms(
            a[:, 0] * tail,
            a[:, 0] * head,
            diagonal + b * tail[:, :, None] * tail[:, None, :],
            diagonal + b * head[:, :, None] * head[:, None, :],
            a * mixed + b * tail[:, :, None] * head[:, None, :],
        )

    def newton_step(self, points: Floats, tolerance: float = 1e-5) -> tuple[Floats, float]:
        """The Newton step in the frames at the points, (V, 2), and the decrement g^T H^-1 g, to a relative tolerance.

        The real system of size 2V is solved by conjugate gradients. The preconditioner is the complex linear part of
        the Hessian, one Hermitian system of size V, four times cheaper to factor than the real one; without a
        complex structure (nonorientable) the real matrix itself is factored. After a short step
        the factors serve the next one too, if few iterations suffice.
        """
        terms = self.terms(points)
        right, hessian = -self.gradient(terms).ravel(), self.hessian(terms)
        found = False
        if self._near is not None and self._moved < _SHORT:
            answer, found = by_conjugate_gradients(hessian, right, self._near, tolerance=tolerance, steps=_PATIENCE)
        if not found:
            self._near = self._hermitian_solver(terms) if self.complex else self._real_solver(hessian)
            answer, _ = by_conjugate_gradients(hessian, right, self._near, tolerance=tolerance, steps=_LIMIT)
        self._moved = float(np.abs(answer).max())
        return answer.reshape(-1, 2), float(right @ answer)

    def gradient(self, terms: Terms) -> Floats:
        """The gradient in the frames at the points, (V, 2)."""
        ends = np.concatenate([self.tail, self.head])
        parts = np.concatenate([terms.tail, terms.head])
        return np.stack([np.bincount(ends, weights=part, minlength=self.count) for part in parts.T], axis=1)

    def hessian(self, terms: Terms) -> bsr_array[Any]:
        """The Hessian (2V, 2V), with rows in the order of the vertices."""
        turned = np.swapaxes(terms.tail_head, 1, 2)
        blocks = np.concatenate([terms.tail_head, turned, self._diagonal(terms)])
        return bsr_array((blocks[self._by_row], self._columns, self._starts), shape=(2 * self.count, 2 * self.count))

    def _diagonal(self, terms: Terms) -> Floats:
        """The blocks (V, 2, 2) on the diagonal.

        In E^2 translations change nothing: a tiny shift makes the matrix definite and leaves the step as it is.
        """
        ends = np.concatenate([self.tail, self.head])
        parts = np.concatenate([terms.tail_tail, terms.head_head]).reshape(-1, 4)
        sums = [np.bincount(ends, weights=parts[:, k], minlength=self.count) for k in (0, 1, 3)]
        shift = 1e-10 * float(np.abs(parts).mean()) if self.geometry.curvature == 0 else 0.0
        return np.stack([sums[0] + shift, sums[1], sums[1], sums[2] + shift], axis=1).reshape(-1, 2, 2)

    def _real_solver(self, hessian: bsr_array[Any]) -> Callable[[Floats], Floats]:
        """Solves with the Hessian itself."""
        chosen = chosen_solver()
        if chosen is not None:
            return chosen(hessian.tocsc())
        elimination = Elimination.of(self.mesh)
        order, place = ((2 * k[:, None] + np.arange(2)).ravel() for k in (elimination.order, elimination.place))
        factors = factorised(hessian.tocsr()[order][:, order].tocsc())
        return lambda r: np.asarray(factors.solve(r[order])[place])

    def _hermitian_solver(self, terms: Terms) -> Callable[[Floats], Floats]:
        """Solves with the complex linear part of the Hessian."""
        diagonal = np.trace(self._diagonal(terms), axis1=1, axis2=2) / 2
        solve = solver_on(self.mesh, (self.tail, self.head), _complex_part(terms.tail_head), diagonal)
        return lambda r: np.ascontiguousarray(solve(r.view(np.complex128))).view(np.float64)


def _complex_part(blocks: Floats) -> NDArray[np.complex128]:
    """Each block [[p, q], [r, s]] read as the complex number ((p + s) + i (r - q)) / 2, (E,)."""
    real, imaginary = blocks[:, 0, 0] + blocks[:, 1, 1], blocks[:, 1, 0] - blocks[:, 0, 1]
    return np.asarray((real + 1j * imaginary) / 2)


def _square_distance_derivatives(geometry: Geometry, c: Floats) -> tuple[Floats, Floats]:
    """First and second derivative of d^2/2 as a function of the versine c."""
    if geometry.curvature == 0:
        return np.ones_like(c), np.zeros_like(c)
    small = c < 1e-3
    safe = np.where(small, 1.0, c)
    sinh = np.sqrt(safe * (safe + 2))
    d = 2 * np.arcsinh(np.sqrt(safe / 2))
    first = np.where(small, 1 - c / 3 + 2 * c**2 / 15 - 2 * c**3 / 35, d / sinh)
    exact = (1 - d * (1 + safe) / sinh) / sinh**2
    return first, np.where(small, -1 / 3 + 4 * c / 15 - 6 * c**2 / 35 + 32 * c**3 / 315, exact)
