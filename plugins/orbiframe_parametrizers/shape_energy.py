"""Shape energy: how far the triangles of a map to X/H are from given shapes, and its minimiser."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array

from orbiframe import MapError, Triangulation
from orbiframe_parametrizers.elimination import Elimination, factorised
from orbiframe_parametrizers.second_order import SecondOrder, turning_angle

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_STEPS = 60
_DECREMENT = 1e-9
_SMALLEST_STEP = 1e-9
_LONGEST_MOVE = 1.0
_CORNERS = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


def reshaped(start: Triangulation, target: Floats, area: float) -> Triangulation:
    """The map with its points where the shape energy is least, from a map without a fold; by Newton's method.

    The Hessian of every triangle is made positive semidefinite. The energy is infinite where a triangle collapses, and
    steps only go down, so that none ends in a fold. target: (F, 3, 2) and area: see `ShapeEnergy`.
    """
    energy = ShapeEnergy(start, target, area)
    points = start.points
    value = energy.value(points)
    for _ in range(_STEPS):
        try:
            step, decrement = energy.newton_step(points)
        except (MapError, np.linalg.LinAlgError):
            break  # rounding: what has been reached is still without a fold
        further = _searched(energy, points, value, step, decrement)
        if further is None:
            break
        points, value = further
        if decrement < _DECREMENT * value:
            break
    return replace(start, points=points)


def _searched(
    energy: ShapeEnergy, points: Floats, value: float, step: Floats, decrement: float
) -> tuple[Floats, float] | None:
    """Points and energy after the longest of the steps 1, 1/2, 1/4, ... with enough descent, or None."""
    size = min(1.0, _LONGEST_MOVE / max(float(np.abs(step).max()), np.finfo(float).tiny))
    while size > _SMALLEST_STEP:
        trial = energy.moved(points, size * step)
        new = energy.value(trial)
        if new < value - 1e-4 * size * decrement:
            return trial, new
        size /= 2
    return None


class ShapeEnergy:
    """The mean over the triangles of (a/b + b/a)/2 times ((r + 1/r)/2)^t, as a function of the points.

    a and b are the singular values of the map from the wished triangle to the one in X, and r its change of area
    against the mean change; t weighs the areas. 1 where every triangle has its shape. Hormann and Greiner (2000) for
    t = 0, which sees angles only; Degener, Meseth and Klein (2003) for t > 0. In X the first factor is S / A: A the
    area in X, S the sum of the cotangents of the wished angles times the squares of the opposite sides in X, over 4.
    In H^2 and E^2 it is at least 1, because A is at most the area of the Euclidean triangle with the same sides.
    start: the map (its points are not used); target: (F, 3, 2), the wished triangles; area: t. Triangles count by
    their wished areas.
    """

    def __init__(self, start: Triangulation, target: Floats, area: float) -> None:
        mesh, orbifold = start.polyhedron, start.orbifold
        self.geometry = orbifold.geometry
        self.triangles = mesh.triangles
        self.isometry = orbifold.atlas.isometry[start.corner_transitions]
        self.sign = start.face_signs
        self.cotangents, wished = cotangents_and_areas(target)
        self.weights = wished / wished.sum()
        self.wished = self.weights * orbifold.area
        self.area = area
        self.elimination = Elimination.of(mesh)
        self.count = len(mesh.vertices)

    def value(self, points: Floats) -> float:
        """The energy of points (V, 3); infinite for a map with a fold."""
        x = self.geometry.act(self.isometry, points[self.triangles])
        area = self.sign * self.geometry.triangle_area(x[:, 0], x[:, 1], x[:, 2])
        if not (area > 0).all():
            return np.inf
        squares = np.stack([self.geometry.distance(x[:, j], x[:, k]) ** 2 for _, j, k in _CORNERS], axis=1)
        stretch = (self.cotangents * squares).sum(axis=1) / 4
        return float(self.weights @ (stretch * self._density(area)[0]))

    def moved(self, points: Floats, step: Floats) -> Floats:
        """The points after a step (V, 2), given in the frames at the points, along geodesics."""
        velocity = np.einsum("vij,vj->vi", self.geometry.frame(points), step)
        return self.geometry.settle(self.geometry.exp(points, velocity))

    def newton_step(self, points: Floats) -> tuple[Floats, float]:
        """The Newton step in the frames at the points, (V, 2), and the decrement g^T H^-1 g."""
        terms = self.terms(points)
        place = self.elimination.place[self.triangles]
        rows = (2 * place[:, :, None] + np.arange(2)).reshape(-1, 6)
        right = -np.bincount(rows.ravel(), weights=terms.gradient.ravel(), minlength=2 * self.count)
        step = factorised(self._matrix(rows, _semidefinite(terms.hessian))).solve(right)
        return step.reshape(-1, 2)[self.elimination.place], float(right @ step)

    def terms(self, points: Floats) -> SecondOrder:
        """The share of every triangle (F,), with derivatives in the frames at its three corners (6 coordinates)."""
        x = self.geometry.act(self.isometry, points[self.triangles])
        frames = self.isometry @ self.geometry.frame(points)[self.triangles]
        versines = [self._versine(x, frames, j, k) for _, j, k in _CORNERS]
        squares = [side.through(*half_square(self.geometry.curvature, side.value)) for side in versines]
        stretch = sum_of([square.times(c / 2) for square, c in zip(squares, self.cotangents.T, strict=True)])
        area = self._area(x, frames, versines)
        return (stretch * area.through(*self._density(area.value))).times(self.weights)

    def _density(self, area: Floats) -> tuple[Floats, Floats, Floats]:
        """((r + 1/r)/2)^t / A with its first and second derivative in A."""
        r = area / self.wished
        mean = (r + 1 / r) / 2
        slope, bend = (1 - 1 / r**2) / (2 * mean), 1 / (r**3 * mean)
        factor = mean**self.area / area
        # The logarithmic derivative in r, and the derivative of that.
        rate = self.area * slope - 1 / r
        change = self.area * (bend - slope**2) + 1 / r**2
        return factor, factor * rate / self.wished, factor * (rate**2 + change) / self.wished**2

    def _versine(self, x: Floats, frames: Floats, i: int, j: int) -> SecondOrder:
        """The versine of corners i and j; along a geodesic a point has x'' = -K x |x'|^2."""
        curvature = self.geometry.curvature
        form = np.array([curvature, 1.0, 1.0])
        value, chord = self.geometry.versine(x[:, i], x[:, j]), form * self.geometry.chord(x[:, i], x[:, j])
        gradient, hessian = _nothing(len(x))
        gradient[:, i] = -np.einsum("fia,fi->fa", frames[:, i], chord)
        gradient[:, j] = np.einsum("fia,fi->fa", frames[:, j], chord)
        hessian[:, i, :, i] = hessian[:, j, :, j] = (1 - curvature * value)[:, None, None] * np.eye(2)
        mixed = -np.einsum("fia,i,fib->fab", frames[:, i], form, frames[:, j])
        hessian[:, i, :, j], hessian[:, j, :, i] = mixed, np.swapaxes(mixed, 1, 2)
        return SecondOrder(value, gradient.reshape(-1, 6), hessian.reshape(-1, 6, 6))

    def _area(self, x: Floats, frames: Floats, versines: list[SecondOrder]) -> SecondOrder:
        """The signed area: tan(A/2) = D / (4 - K (c_12 + c_20 + c_01)); D/2 in E^2. See `Geometry.triangle_area`."""
        determinant = self._determinant(x, frames)
        curvature = self.geometry.curvature
        if curvature == 0:
            return determinant.times(self.sign / 2)
        whole = sum_of(versines).times(np.full(len(x), -float(curvature)))
        whole = replace(whole, value=4 + whole.value)
        return turning_angle(determinant.times(self.sign), whole).times(np.full(len(x), 2.0))

    def _determinant(self, x: Floats, frames: Floats) -> SecondOrder:
        """The determinant of the three corners, linear in each."""
        to_1, to_2 = self.geometry.chord(x[:, 0], x[:, 1]), self.geometry.chord(x[:, 0], x[:, 2])
        value = np.einsum("fi,fi->f", x[:, 0], np.cross(to_1, to_2))
        gradient, hessian = _nothing(len(x))
        for i, j, k in _CORNERS:
            gradient[:, i] = np.einsum("fia,fi->fa", frames[:, i], self._cross(x[:, i], x[:, j], x[:, k]))
            hessian[:, i, :, i] = -self.geometry.curvature * value[:, None, None] * np.eye(2)
            turned = np.cross(frames[:, i, :, :, None], frames[:, j, :, None, :], axis=1)
            mixed = np.einsum("fiab,fi->fab", turned, x[:, k])
            hessian[:, i, :, j], hessian[:, j, :, i] = mixed, np.swapaxes(mixed, 1, 2)
        return SecondOrder(value, gradient.reshape(-1, 6), hessian.reshape(-1, 6, 6))

    def _cross(self, x: Floats, y: Floats, z: Floats) -> Floats:
        """y x z as a sum of products of chords from x, without cancellation where the three are close together."""
        to_y, to_z = self.geometry.chord(x, y), self.geometry.chord(x, z)
        return np.asarray(np.cross(to_y, to_z) + np.cross(x, to_z - to_y))

    def _matrix(self, rows: Ints, blocks: Floats) -> csc_array[Any]:
        """The sum of the blocks (F, 6, 6), shifted a little: on E^2 and S^2 some motions change nothing."""
        size = 2 * self.count
        every = np.arange(size)
        diagonal = np.bincount(rows.ravel(), weights=np.einsum("fii->fi", blocks).ravel(), minlength=size)
        row = np.append(np.repeat(rows, 6, axis=1).ravel(), every)
        column = np.append(np.tile(rows, (1, 6)).ravel(), every)
        data = np.append(blocks.ravel(), 1e-10 * diagonal)
        return coo_array((data, (row, column)), shape=(size, size)).tocsc()


def cotangents_and_areas(triangles: Floats) -> tuple[Floats, Floats]:
    """The cotangents (F, 3) of the angles and the areas (F,) of triangles in the plane, (F, 3, 2)."""
    after = np.roll(triangles, -1, axis=1) - triangles
    before = np.roll(triangles, 1, axis=1) - triangles
    double = after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0]
    return (after * before).sum(axis=-1) / double, double[:, 0] / 2


def half_square(curvature: int, c: Floats) -> tuple[Floats, Floats, Floats]:
    """Half the squared distance as a function of the versine c, with its two derivatives."""
    if curvature == 0:
        return c, np.ones_like(c), np.zeros_like(c)
    t = -curvature * c
    small = np.abs(t) < 1e-3
    safe = np.where(small, -0.5 * curvature, t)
    sine_square = np.abs(safe * (safe + 2))
    d = 2 * (np.arcsinh(np.sqrt(safe / 2)) if curvature < 0 else np.arcsin(np.sqrt(-safe / 2)))
    first = d / np.sqrt(sine_square)
    second = (1 - first * (1 + safe)) / sine_square
    value = np.where(small, c * (1 - t / 6 + 2 * t**2 / 45 - t**3 / 70), d**2 / 2)
    first = np.where(small, 1 - t / 3 + 2 * t**2 / 15 - 2 * t**3 / 35, first)
    series = curvature * (1 / 3 - 4 * t / 15 + 6 * t**2 / 35 - 32 * t**3 / 315)
    return value, first, np.where(small, series, second)


def sum_of(terms: list[SecondOrder]) -> SecondOrder:
    """The sum of several functions."""
    total = terms[0]
    for term in terms[1:]:
        total = total + term
    return total


def _nothing(count: int) -> tuple[Floats, Floats]:
    return np.zeros((count, 3, 2)), np.zeros((count, 3, 2, 3, 2))


def _semidefinite(matrices: Floats) -> Floats:
    values, vectors = np.linalg.eigh(matrices)
    return np.asarray((vectors * np.maximum(values, 0.0)[:, None, :]) @ np.swapaxes(vectors, 1, 2))
