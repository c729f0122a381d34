"""Harmonic energy: the sum of weights times squared distances over the edges of a map to X/H, and its minimiser."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import LinearOperator, cg

from orbiframe import Geometry, MapError, Triangulation
from orbiframe_parametrizers.elimination import Elimination, factorised

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_STEPS = 40
_DECREMENT = 1e-10
_SMALLEST_STEP = 1e-6


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

    None too where the energy is not convex, as happens with negative weights.
    """
    size = 1.0
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
        self.isometry = orbifold.atlas.isometry[start.transition[edges]]
        self.weights = weights[edges]
        self.count = len(mesh.vertices)
        self.elimination = Elimination.of(mesh)
        # Frames that all have one orientation make the Hessian nearly complex linear: see newton_step.
        self.complex = bool(orbifold.orientable and (self.geometry.parity(orbifold.atlas.isometry) > 0).all())

    def value(self, points: Floats) -> float:
        """The energy of points (V, 3)."""
        far = self.geometry.act(self.isometry, points[self.head])
        return float(self.weights @ self.geometry.distance(points[self.tail], far) ** 2) / 2

    def moved(self, points: Floats, step: Floats) -> Floats:
        """The points after a step (V, 2), given in the frames at the points, along geodesics."""
        velocity = np.einsum("vij,vj->vi", self.geometry.frame(points), step)
        return self.geometry.exp(points, velocity)

    def terms(self, points: Floats) -> Terms:
        """The derivatives of every term, without those of the edges' common sum."""
        geometry = self.geometry
        here, there = points[self.tail], geometry.act(self.isometry, points[self.head])
        frame = geometry.frame(points)
        at_tail = frame[self.tail]
        at_head = self.isometry @ frame[self.head]
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

    def newton_step(self, points: Floats, tolerance: float = 1e-8) -> tuple[Floats, float]:
        """The Newton step in the frames at the points, (V, 2), and the decrement g^T H^-1 g, to a relative tolerance.

        The real system of size 2V is solved by conjugate gradients. The preconditioner is the complex linear part of
        the Hessian, one Hermitian system of size V, four times cheaper to factor than the real one; without a
        complex structure (nonorientable) the real matrix itself is factored.
        """
        terms = self.terms(points)
        right = -self.gradient(terms)[self.elimination.order].ravel()
        hessian = self.hessian(terms)
        solve = self._hermitian_solver(terms) if self.complex else factorised(hessian).solve
        shape = (2 * self.count, 2 * self.count)
        inverse = LinearOperator(shape, matvec=lambda r: solve(r.ravel()), dtype=np.float64)
        answer, _ = cg(hessian.tocsr(), right, rtol=tolerance, maxiter=100, M=inverse)
        return answer.reshape(-1, 2)[self.elimination.place], float(right @ answer)

    def gradient(self, terms: Terms) -> Floats:
        """The gradient in the frames at the points, (V, 2)."""
        ends = np.concatenate([self.tail, self.head])
        parts = np.concatenate([terms.tail, terms.head])
        return np.stack([np.bincount(ends, weights=part, minlength=self.count) for part in parts.T], axis=1)

    def _shift(self, blocks: Floats) -> float:
        """In E^2 translations change nothing: a tiny shift makes the matrix definite and leaves the step as it is."""
        return 1e-10 * float(np.abs(blocks).mean()) if self.geometry.curvature == 0 else 0.0

    def hessian(self, terms: Terms) -> csc_array[Any]:
        """The Hessian (2V, 2V) in elimination order."""
        i, j = self.elimination.place[self.tail], self.elimination.place[self.head]
        turned = np.swapaxes(terms.tail_head, 1, 2)
        blocks = np.concatenate([terms.tail_tail, terms.head_head, terms.tail_head, turned])
        row, column = np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i])
        axis = np.arange(2)
        rows = np.broadcast_to((2 * row)[:, None, None] + axis[:, None], blocks.shape)
        columns = np.broadcast_to((2 * column)[:, None, None] + axis, blocks.shape)
        every = np.arange(2 * self.count)
        data = np.append(blocks.ravel(), np.full(2 * self.count, self._shift(blocks)))
        place = (np.append(rows.ravel(), every), np.append(columns.ravel(), every))
        return coo_array((data, place), shape=(2 * self.count, 2 * self.count)).tocsc()

    def _hermitian_solver(self, terms: Terms) -> Callable[[Floats], Floats]:
        """Solves with the complex linear part of the Hessian, on vectors (2V,) in elimination order."""
        ends = np.concatenate([self.tail, self.head])
        blocks = np.concatenate([terms.tail_tail, terms.head_head])
        traces = (blocks[:, 0, 0] + blocks[:, 1, 1]) / 2
        diagonal = np.bincount(ends, weights=traces, minlength=self.count) + self._shift(blocks)
        matrix = self.elimination.matrix(self.tail, self.head, _complex_part(terms.tail_head), diagonal)
        factors = factorised(matrix)
        return lambda r: np.ascontiguousarray(factors.solve(r.view(np.complex128))).view(np.float64)


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
