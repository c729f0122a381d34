"""Shape energy: how far the triangles of a map to X/H are from given shapes, and its minimiser."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array

from orbiframe import Triangulation
from orbiframe_parametrizers.elimination import Elimination, factorised

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_STEPS = 60
_DECREMENT = 1e-9
_SMALLEST_STEP = 1e-9


def reshaped(start: Triangulation, target: Floats, area: float) -> Triangulation:
    """The map with the points where the shape energy is least, from a map without a fold; by Newton's method.

    The Hessian of every triangle is made positive semidefinite. The energy is infinite where a triangle collapses, so
    that no step of the line search, which only goes down, ends in a fold. See `ShapeEnergy`.
    """
    energy = ShapeEnergy(start, target, area)
    points = start.points
    value = energy.value(points)
    for _ in range(_STEPS):
        step, decrement = energy.newton_step(points)
        size = 1.0
        while size > _SMALLEST_STEP:
            trial = energy.moved(points, size * step)
            new = energy.value(trial)
            if new < value - 1e-4 * size * decrement:
                break
            size /= 2
        else:
            break
        points, value = trial, new
        if decrement < _DECREMENT * value:
            break
    return replace(start, points=points)


class ShapeEnergy:
    """The mean over the triangles of (a/b + b/a)/2 times ((r + 1/r)/2)^t, as a function of the points.

    a and b are the singular values of the map from the wished triangle to the one in X, and r its change of area
    against the mean change, t the weight of the areas; 1 where every triangle has its shape. Hormann and Greiner (2000)
    for t = 0, which sees angles only, Degener, Meseth and Klein (2003) for t > 0. With the chords of X in place of its
    geodesics, which agree for small triangles, the first factor is S / D: S the sum of the wished cotangents times the
    versines of the opposite sides, D the determinant of the three corners, positive exactly without a fold.
    start: the map (its points are not used); target: (F, 3, 2); area: t. Triangles count by their wished area.
    """

    def __init__(self, start: Triangulation, target: Floats, area: float) -> None:
        mesh, orbifold = start.polyhedron, start.orbifold
        self.geometry = orbifold.geometry
        self.triangles = mesh.triangles
        self.isometry = orbifold.atlas.isometry[_corner_transitions(start)]
        self.sign = start.face_signs
        self.cotangents, wished = _cotangents_and_areas(target)
        self.weights = wished / wished.sum()
        self.wished = 2 * self.weights * orbifold.area
        self.area = area
        self.elimination = Elimination.of(mesh)
        self.count = len(mesh.vertices)

    def value(self, points: Floats) -> float:
        """The energy of points (V, 3); infinite for a map with a fold."""
        stretch, volume = self._stretch_and_volume(self._lifts(points))
        if not (volume > 0).all():
            return np.inf
        return float(self.weights @ (stretch * self._density(volume)[0]))

    def moved(self, points: Floats, step: Floats) -> Floats:
        """The points after a step (V, 2), given in the frames at the points, along geodesics."""
        velocity = np.einsum("vij,vj->vi", self.geometry.frame(points), step)
        return self.geometry.settle(self.geometry.exp(points, velocity))

    def newton_step(self, points: Floats) -> tuple[Floats, float]:
        """The Newton step in the frames at the points, (V, 2), and the decrement g^T H^-1 g."""
        gradients, hessians = self.terms(points)
        place = self.elimination.place[self.triangles]
        rows = (2 * place[:, :, None] + np.arange(2)).reshape(-1, 6)
        right = -np.bincount(rows.ravel(), weights=gradients.ravel(), minlength=2 * self.count)
        step = factorised(self._matrix(rows, _semidefinite(hessians))).solve(right)
        return step.reshape(-1, 2)[self.elimination.place], float(right @ step)

    def terms(self, points: Floats) -> tuple[Floats, Floats]:
        """Gradient (F, 6) and Hessian (F, 6, 6) of every term in the frames at its three corners."""
        lifts = self._lifts(points)
        stretch, volume = self._stretch_and_volume(lifts)
        frames = self.isometry @ self.geometry.frame(points)[self.triangles]
        ds, dds = self._stretch_terms(lifts, frames)
        dv, ddv = self._volume_terms(lifts, frames, volume)
        g, first, second = self._density(volume)
        outer = np.einsum("fi,fj->fij", ds, dv)
        gradient = g[:, None] * ds + (stretch * first)[:, None] * dv
        hessian = (
            g[:, None, None] * dds
            + (stretch * first)[:, None, None] * ddv
            + first[:, None, None] * (outer + np.swapaxes(outer, 1, 2))
            + (stretch * second)[:, None, None] * np.einsum("fi,fj->fij", dv, dv)
        )
        return self.weights[:, None] * gradient, self.weights[:, None, None] * hessian

    def _lifts(self, points: Floats) -> Floats:
        return self.geometry.act(self.isometry, points[self.triangles])

    def _stretch_and_volume(self, x: Floats) -> tuple[Floats, Floats]:
        """S and D of every triangle (F,), without cancellation."""
        a, b, c = x[:, 0], x[:, 1], x[:, 2]
        sides = np.stack([self.geometry.versine(*pair) for pair in ((b, c), (c, a), (a, b))], axis=1)
        cross = np.cross(self.geometry.chord(a, b), self.geometry.chord(a, c))
        return (self.cotangents * sides).sum(axis=1), self.sign * np.einsum("fi,fi->f", a, cross)

    def _density(self, volume: Floats) -> tuple[Floats, Floats, Floats]:
        """((r + 1/r)/2)^t / D with its first and second derivative in D."""
        r = volume / self.wished
        with np.errstate(all="ignore"):
            mean = (r + 1 / r) / 2
            slope, bend = (1 - 1 / r**2) / (2 * mean), 1 / (r**3 * mean)
            factor = mean**self.area / volume
            # Logarithmic derivative in r of factor, and the derivative of that.
            rate = self.area * slope - 1 / r
            change = self.area * (bend - slope**2) + 1 / r**2
        return factor, factor * rate / self.wished, factor * (rate**2 + change) / self.wished**2

    def _stretch_terms(self, x: Floats, frames: Floats) -> tuple[Floats, Floats]:
        """Gradient and Hessian of S; the versine is a bilinear function of its two points but for constants."""
        form = np.array([self.geometry.curvature, 1.0, 1.0])
        gradient, hessian = np.zeros((len(x), 3, 2)), np.zeros((len(x), 3, 2, 3, 2))
        for i, j, k in ((1, 2, 0), (2, 0, 1), (0, 1, 2)):
            weight = self.cotangents[:, k]
            chord = form * self.geometry.chord(x[:, i], x[:, j])
            gradient[:, i] -= weight[:, None] * np.einsum("fia,fi->fa", frames[:, i], chord)
            gradient[:, j] += weight[:, None] * np.einsum("fia,fi->fa", frames[:, j], chord)
            flat = weight * (1 - self.geometry.curvature * self.geometry.versine(x[:, i], x[:, j]))
            hessian[:, i, :, i] += flat[:, None, None] * np.eye(2)
            hessian[:, j, :, j] += flat[:, None, None] * np.eye(2)
            mixed = -weight[:, None, None] * np.einsum("fia,i,fib->fab", frames[:, i], form, frames[:, j])
            hessian[:, i, :, j], hessian[:, j, :, i] = mixed, np.swapaxes(mixed, 1, 2)
        return gradient.reshape(-1, 6), hessian.reshape(-1, 6, 6)

    def _volume_terms(self, x: Floats, frames: Floats, volume: Floats) -> tuple[Floats, Floats]:
        """Gradient and Hessian of D, which is linear in each point; along a geodesic x'' = -K x |x'|^2."""
        gradient, hessian = np.zeros((len(x), 3, 2)), np.zeros((len(x), 3, 2, 3, 2))
        bend = -self.geometry.curvature * volume[:, None, None] * np.eye(2)
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            # The normal of the chords is that of the two points, up to rounding, where the first is differentiated.
            normal = self.sign[:, None] * self._normal(x[:, i], x[:, j], x[:, k])
            gradient[:, i] = np.einsum("fia,fi->fa", frames[:, i], normal)
            hessian[:, i, :, i] = bend
            turned = np.cross(frames[:, i, :, :, None], frames[:, j, :, None, :], axis=1)
            mixed = self.sign[:, None, None] * np.einsum("fiab,fi->fab", turned, x[:, k])
            hessian[:, i, :, j], hessian[:, j, :, i] = mixed, np.swapaxes(mixed, 1, 2)
        return gradient.reshape(-1, 6), hessian.reshape(-1, 6, 6)

    def _normal(self, x: Floats, y: Floats, z: Floats) -> Floats:
        """y x z for the derivative of det(x, y, z) along tangent vectors at x, by chords as far as they are small."""
        to_y, to_z = self.geometry.chord(x, y), self.geometry.chord(x, z)
        return np.asarray(np.cross(to_y, to_z) + np.cross(x, to_z) + np.cross(to_y, x))

    def _matrix(self, rows: Ints, blocks: Floats) -> csc_array[Any]:
        """The sum of the blocks (F, 6, 6), shifted a little: on E^2 and S^2 some isometries change nothing."""
        size = 2 * self.count
        every = np.arange(size)
        diagonal = np.bincount(rows.ravel(), weights=np.einsum("fii->fi", blocks).ravel(), minlength=size)
        row = np.append(np.repeat(rows, 6, axis=1).ravel(), every)
        column = np.append(np.tile(rows, (1, 6)).ravel(), every)
        data = np.append(blocks.ravel(), 1e-10 * diagonal + 1e-14 * diagonal.mean())
        return coo_array((data, (row, column)), shape=(size, size)).tocsc()


def target_cotangents(target: Floats) -> Floats:
    """The cotangents of the angles of wished triangles, (F, 3), those of the corners 0, 1 and 2."""
    return _cotangents_and_areas(target)[0]


def _cotangents_and_areas(target: Floats) -> tuple[Floats, Floats]:
    after = np.roll(target, -1, axis=1) - target
    before = np.roll(target, 1, axis=1) - target
    double = after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0]
    return (after * before).sum(axis=-1) / double, double[:, 0] / 2


def _semidefinite(matrices: Floats) -> Floats:
    values, vectors = np.linalg.eigh(matrices)
    return np.asarray((vectors * np.maximum(values, 0.0)[:, None, :]) @ np.swapaxes(vectors, 1, 2))


def _corner_transitions(triangulation: Triangulation) -> Ints:
    """The transition from the frame of the first corner of each triangle to that of each corner, (F, 3)."""
    t = triangulation.transition.reshape(-1, 3)
    inverse = triangulation.orbifold.atlas.inverse
    return np.stack([np.zeros_like(t[:, 0]), t[:, 0], inverse[t[:, 2]]], axis=1)
