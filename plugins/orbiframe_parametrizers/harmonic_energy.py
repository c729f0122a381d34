"""Harmonic energy: the sum of weights times squared distances over the edges of a map to X/H, and its minimiser."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.linalg import LinearOperator, cg

from orbiframe import Geometry, MapError, Triangulation
from orbiframe_parametrizers.elimination import elimination_order, factorised

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_STEPS = 40
_DECREMENT = 1e-10


def minimised(start: Triangulation, weights: Floats) -> Floats:
    """The points (V, 3), each in the frame of its patch, that minimise sum w d^2 / 2 over the edges; by Newton.

    start: the group and the first guess; weights: (H,). Strictly convex in H^2 for positive weights, so that the
    minimum is unique, and an embedding (Colin de Verdiere 1991, Hass and Scott 2015); a linear system in E^2. Stops
    on the Newton decrement. Raises MapError if 40 steps do not suffice.
    """
    energy = _Energy(start, weights)
    points = start.points
    value = energy.value(points)
    for _ in range(_STEPS):
        step, decrement = energy.newton_step(points)
        if not decrement > 0:
            if decrement == 0:
                return points
            break  # not convex: negative weights
        size = 1.0
        while size > 1e-6:
            trial = energy.moved(points, size * step)
            new = energy.value(trial)
            if new <= value - 1e-4 * size * decrement + 1e-13 * abs(value):
                break
            size /= 2
        else:
            break
        points, value = trial, new
        if decrement < _DECREMENT * abs(value):
            return points
    raise MapError("the harmonic map did not converge; try map.weights = 'mean-value' or 'uniform'")


@dataclass(frozen=True, eq=False)
class _Terms:
    """Gradient of d^2/2 at both ends (E, 2) each, and the three blocks of its Hessian (E, 2, 2)."""

    tail: Floats
    head: Floats
    tail_tail: Floats
    head_head: Floats
    tail_head: Floats


class _Energy:
    def __init__(self, start: Triangulation, weights: Floats) -> None:
        mesh, orbifold = start.polyhedron, start.orbifold
        self.geometry: Geometry = orbifold.geometry
        edges = np.flatnonzero(mesh.representative)
        self.tail, self.head = mesh.tail[edges], mesh.head[edges]
        self.isometry = orbifold.atlas.isometry[start.transition[edges]]
        self.weights = weights[edges]
        self.count = len(mesh.vertices)
        self.order = elimination_order(mesh.vertices, self.tail, self.head)
        self.place = np.empty(self.count, dtype=np.intp)
        self.place[self.order] = np.arange(self.count)
        # Frames that all have one orientation make the Hessian nearly complex linear: see newton_step.
        self.complex = bool(orbifold.orientable and (np.linalg.det(orbifold.atlas.isometry) > 0).all())

    def value(self, points: Floats) -> float:
        far = self.geometry.act(self.isometry, points[self.head])
        return float(self.weights @ self.geometry.distance(points[self.tail], far) ** 2) / 2

    def moved(self, points: Floats, step: Floats) -> Floats:
        velocity = np.einsum("vij,vj->vi", self.geometry.frame(points), step)
        return self.geometry.exp(points, velocity)

    def terms(self, points: Floats) -> _Terms:
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
        return _Terms(
            a[:, 0] * tail,
            a[:, 0] * head,
            diagonal + b * tail[:, :, None] * tail[:, None, :],
            diagonal + b * head[:, :, None] * head[:, None, :],
            a * mixed + b * tail[:, :, None] * head[:, None, :],
        )

    def newton_step(self, points: Floats) -> tuple[Floats, float]:
        """The Newton step in the frames at the points, (V, 2), and the decrement g^T H^-1 g.

        The real system of size 2V is solved by conjugate gradients. The preconditioner is the complex linear part of
        the Hessian, one Hermitian system of size V, four times cheaper to factor than the real one; without a
        complex structure (nonorientable) the real matrix itself is factored.
        """
        terms = self.terms(points)
        gradient = np.zeros((self.count, 2))
        for axis in range(2):
            gradient[:, axis] = np.bincount(self.tail, weights=terms.tail[:, axis], minlength=self.count)
            gradient[:, axis] += np.bincount(self.head, weights=terms.head[:, axis], minlength=self.count)
        right = -gradient[self.order].ravel()
        hessian = self._real(terms)
        if self.complex:
            factor = factorised(self._hermitian(terms))

            def precondition(r: Floats) -> Floats:
                return np.ascontiguousarray(factor.solve(r.view(np.complex128))).view(np.float64)
        else:
            factor = factorised(hessian.tocsc())
            precondition = factor.solve
        size = 2 * self.count
        solve = LinearOperator((size, size), matvec=lambda r: precondition(r.ravel()), dtype=np.float64)
        answer, _ = cg(hessian.tocsr(), right, rtol=1e-8, maxiter=100, M=solve)
        step = np.empty((self.count, 2))
        step[self.order] = answer.reshape(-1, 2)
        return step, float(right @ answer)

    def _blocks(self, terms: _Terms) -> tuple[Ints, Ints, Floats]:
        i, j = self.place[self.tail], self.place[self.head]
        turned = np.swapaxes(terms.tail_head, 1, 2)
        blocks = np.concatenate([terms.tail_tail, terms.head_head, terms.tail_head, turned])
        return np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i]), blocks

    def _shift(self, blocks: Floats) -> float:
        """In E^2 translations change nothing: a tiny shift makes the matrix definite and leaves the step as it is."""
        return 1e-10 * float(np.abs(blocks).mean()) if self.geometry.curvature == 0 else 0.0

    def _real(self, terms: _Terms) -> coo_array:
        i, j, blocks = self._blocks(terms)
        axis = np.arange(2)
        rows = (2 * i)[:, None, None] + axis[:, None] + 0 * axis
        columns = (2 * j)[:, None, None] + 0 * axis[:, None] + axis
        size = 2 * self.count
        every = np.arange(size)
        data = np.append(blocks.ravel(), np.full(size, self._shift(blocks)))
        place = (np.append(rows.ravel(), every), np.append(columns.ravel(), every))
        return coo_array((data, place), shape=(size, size))

    def _hermitian(self, terms: _Terms) -> coo_array:
        """Each block [[p, q], [r, s]] read as the complex number ((p + s) + i (r - q)) / 2."""
        i, j, blocks = self._blocks(terms)
        data = (blocks[:, 0, 0] + blocks[:, 1, 1]) / 2 + 0.5j * (blocks[:, 1, 0] - blocks[:, 0, 1])
        every = np.arange(self.count)
        data = np.append(data, np.full(self.count, self._shift(blocks)))
        place = (np.append(i, every), np.append(j, every))
        return coo_array((data, place), shape=(self.count, self.count)).tocsc()


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
