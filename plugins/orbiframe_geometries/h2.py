"""The hyperbolic plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe import Geometry, GeometryError

Floats = NDArray[np.float64]
_FORM = np.array([1.0, -1.0, -1.0])
_SIGNS = np.outer(_FORM, _FORM)
# Geodesics are followed so far: cosh is still a float. Versines beyond the other number are the sinh of the distance.
_LONGEST, _LARGE = 700.0, 1e100


class H2(Geometry):
    """The sheet x0 > 0 of the hyperboloid x0^2 - x1^2 - x2^2 = 1, curvature -1 (section 1.2).

    Far from the origin x0^2 and x1^2 + x2^2 are large and nearly equal, so no formula subtracts them: (x1, x2) is the
    point, x0 follows from it, and differences come from the cross product of two points.
    """

    name = "h2"
    curvature = -1

    def project(self, x: ArrayLike) -> Floats:
        """x / sqrt(x0^2 - x1^2 - x2^2) for vectors (..., 3). Raises GeometryError outside the cone over H^2."""
        vectors = np.asarray(x, dtype=float)
        height, radius = vectors[..., 0], np.hypot(vectors[..., 1], vectors[..., 2])
        bad = np.flatnonzero(~(height > radius))
        if bad.size:
            raise GeometryError(
                f"vector {bad[0]} has x0 = {np.ravel(height)[bad[0]]:.6g} and |(x1, x2)| = "
                f"{np.ravel(radius)[bad[0]]:.6g}; a point of H^2 needs x0 > |(x1, x2)|: check the input"
            )
        return self.settle(vectors / np.sqrt((height - radius) * (height + radius))[..., None])

    def settle(self, x: ArrayLike) -> Floats:
        """x with x0 = sqrt(1 + x1^2 + x2^2)."""
        points = np.array(x, dtype=float)
        points[..., 0] = np.sqrt(1 + points[..., 1] ** 2 + points[..., 2] ** 2)
        return points

    def inner(self, x: ArrayLike, v: ArrayLike, w: ArrayLike) -> Floats:
        """(v1 w1 + v2 w2 + (x cross v)(x cross w)) / x0^2, the cross product being that of (x1, x2).

        On tangent vectors that is v1 w1 + v2 w2 - v0 w0, minus the form of the paper, of which nothing is left far out.
        """
        base, v, w = (np.asarray(a, dtype=float) for a in (x, v, w))
        height, across = base[..., 0], [_cross(base, a) / base[..., 0] for a in (v, w)]
        along = (v[..., 1] / height) * (w[..., 1] / height) + (v[..., 2] / height) * (w[..., 2] / height)
        return np.asarray(along + across[0] * across[1])

    def chord(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """y - x with y0 - x0 from the differences of (x1, x2)."""
        base, target = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        apart, along = target - base, target + base
        apart[..., 0] = np.sum(apart[..., 1:] * along[..., 1:], axis=-1) / along[..., 0]
        return np.asarray(apart)

    def versine(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """cosh d - 1 as a sum of positive terms, relative error about eps e^D at distance D from the origin.

        With v = y - x in the plane (x1, x2): (|v|^2 + (x cross v)^2) / (1 + x0 y0 + x . y), and where x . y < 0,
        a + b + a b - x . y with a = x0 - 1, b = y0 - 1. For the cross product x is the point nearer to the origin.
        """
        p, q = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        a, b = _height(p), _height(q)
        nearer = a <= b
        # Written out: sums over an axis of two are slow.
        u, v = q[..., 1] - p[..., 1], q[..., 2] - p[..., 2]
        cross = np.where(nearer, p[..., 1], q[..., 1]) * v - np.where(nearer, p[..., 2], q[..., 2]) * u
        dot = p[..., 1] * q[..., 1] + p[..., 2] * q[..., 2]
        whole = 1 + p[..., 0] * q[..., 0] + np.maximum(dot, 0.0)
        with np.errstate(over="ignore"):
            close = (u**2 + v**2 + cross**2) / whole
        # Beyond 88 the squares are too large for a float, and their quotients are not.
        close = np.where(np.isfinite(close), close, u * (u / whole) + v * (v / whole) + cross * (cross / whole))
        return np.asarray(np.where(dot >= 0, close, a + b + a * b - dot))

    def distance(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """2 asinh(sqrt((cosh d - 1) / 2))."""
        return np.asarray(2 * np.arcsinh(np.sqrt(self.versine(x, y) / 2)))

    def exp(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """cosh|v| x + sinh|v| v/|v|, with |v|^2 = (v1^2 + v2^2 + (x1 v2 - x2 v1)^2) / x0^2.

        Raises GeometryError where the length that rounding leaves of a vector is beyond all floats: far from the
        origin, a vector at x has an error of eps e^(2 D), of which eps e^D is seen along X.
        """
        base, velocity = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(v, dtype=float))
        speed = np.hypot(np.hypot(velocity[..., 1], velocity[..., 2]), _cross(base, velocity)) / base[..., 0]
        lost = np.flatnonzero(np.ravel(speed) > _LONGEST)
        if lost.size:
            raise GeometryError(
                f"vector {lost[0]} has the length {np.ravel(speed)[lost[0]]:.6g} at a point at distance "
                f"{np.arccosh(np.ravel(base[..., 0])[lost[0]]):.6g} from the origin; geodesics of H^2 end within "
                f"{_LONGEST:g}: use a frame near the point"
            )
        ratio = np.where(speed == 0, 1.0, np.sinh(speed) / np.where(speed == 0, 1.0, speed))
        return self.settle(np.cosh(speed)[..., None] * base + ratio[..., None] * velocity)

    def log(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """(d / sinh d) (y - x - c x) with c = cosh d - 1."""
        base = np.asarray(x, dtype=float)
        versine = self.versine(base, y)
        small = np.minimum(versine, _LARGE)
        sine = np.where(versine < _LARGE, np.sqrt(small * (small + 2)), versine)
        ratio = np.where(sine == 0, 1.0, self.distance(base, y) / np.where(sine == 0, 1.0, sine))
        tangent = ratio[..., None] * self.chord(base, y) - (ratio * versine)[..., None] * base
        tangent[..., 0] = np.sum(base[..., 1:] * tangent[..., 1:], axis=-1) / base[..., 0]
        return np.asarray(tangent)

    def turn(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """The Lorentz cross product: x cross v with the first entry negated."""
        return np.asarray(np.cross(np.asarray(x, dtype=float), np.asarray(v, dtype=float)) * -_FORM)

    def from_polar(self, radius: ArrayLike, angle: ArrayLike) -> Floats:
        """(cosh r, sinh r cos a, sinh r sin a)."""
        r, a = np.broadcast_arrays(np.asarray(radius, dtype=float), np.asarray(angle, dtype=float))
        return np.stack([np.cosh(r), np.sinh(r) * np.cos(a), np.sinh(r) * np.sin(a)], axis=-1)

    def point_defect(self, x: ArrayLike) -> Floats:
        """|x0 - sqrt(1 + x1^2 + x2^2)|; the lower sheet has a defect of at least 2."""
        points = np.asarray(x, dtype=float)
        return np.asarray(np.abs(points[..., 0] - np.sqrt(1 + points[..., 1] ** 2 + points[..., 2] ** 2)))

    def isometry_defect(self, g: ArrayLike) -> Floats:
        """Largest entry of g^T J g - J; at least 2 where g exchanges the two sheets."""
        matrix = np.asarray(g, dtype=float)
        form = np.swapaxes(matrix, -1, -2) @ (_FORM[:, None] * matrix) - np.diag(_FORM)
        swapped = np.where(matrix[..., 0, 0] < 0, 1 - matrix[..., 0, 0], 0.0)
        return np.asarray(np.maximum(np.abs(form).max(axis=(-1, -2)), swapped))

    def nearest_isometry(self, g: ArrayLike) -> Floats:
        """carry(x) times the orthogonal polar factor of the block (1, 2), where x is the image of the origin.

        The block is a rotation or reflection with singular values cosh d and 1, so its polar factor keeps full
        accuracy at any size of g.
        """
        matrix = np.asarray(g, dtype=float)
        left, _, right = np.linalg.svd(matrix[..., 1:, 1:])
        turned = np.zeros_like(matrix)
        turned[..., 0, 0] = 1.0
        turned[..., 1:, 1:] = left @ right
        return np.asarray(self.carry(self.settle(matrix[..., 0])) @ turned)

    def inverse(self, g: ArrayLike) -> Floats:
        """J g^T J."""
        return np.asarray(_SIGNS * np.swapaxes(np.asarray(g, dtype=float), -1, -2))


def _cross(x: Floats, v: Floats) -> Floats:
    """x1 v2 - x2 v1."""
    return np.asarray(x[..., 1] * v[..., 2] - x[..., 2] * v[..., 1])


def _height(x: Floats) -> Floats:
    """x0 - 1 without cancellation."""
    square = x[..., 1] ** 2 + x[..., 2] ** 2
    return np.asarray(square / (1 + np.sqrt(1 + square)))
