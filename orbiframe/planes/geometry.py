"""Geometry: a plane of constant curvature in the paper's linear model (sections 1.2 to 1.4)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.errors import GeometryError
from orbiframe.planes.motion import Motion, find_motion

Floats = NDArray[np.float64]


class Geometry(ABC):
    """The sphere, the Euclidean plane or the hyperbolic plane as a surface X in R^3.

    Points are rows (..., 3), leading axes broadcast: S^2 is |x| = 1, E^2 is x0 = 1, H^2 is x0^2 - x1^2 - x2^2 = 1 with
    x0 > 0. Isometries are matrices (..., 3, 3) that act on column vectors from the left. Tangent vectors are ambient,
    (..., 3). Angles are radians, lengths are in units of curvature +1 or -1 (E^2: free).

    >>> import numpy as np
    >>> from orbiframe import Registry
    >>> h2 = Registry.discover().load("geometry", "h2")()
    >>> step = h2.translation(0.75)
    >>> there = h2.act(step @ step, h2.origin)
    >>> print(round(float(h2.distance(h2.origin, there)), 12))
    1.5
    >>> h2.classify(step), h2.classify(h2.rotation(0.3))
    ('translation', 'rotation')
    """

    name: str
    curvature: int

    # ---- what a geometry supplies -------------------------------------------------------------------------------

    @abstractmethod
    def project(self, x: ArrayLike) -> Floats:
        """The point of X on the ray of a vector x (..., 3): S^2 x/|x|, E^2 x/x0, H^2 x/sqrt(x0^2 - x1^2 - x2^2)."""

    @abstractmethod
    def settle(self, x: ArrayLike) -> Floats:
        """A point of X that has drifted by rounding, put back: H^2 and E^2 recompute x0 from (x1, x2), S^2 scales."""

    @abstractmethod
    def inner(self, x: ArrayLike, v: ArrayLike, w: ArrayLike) -> Floats:
        """The Riemannian scalar product (...) of tangent vectors v and w at x, to as many digits as these have.

        A vector at distance D from the origin of H^2 that is known to eps of its largest entry has an error of eps e^D.
        """

    @abstractmethod
    def versine(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """The smooth distance function c: 1 - cos d (S^2), d^2/2 (E^2), cosh d - 1 (H^2), without cancellation."""

    @abstractmethod
    def chord(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """The ambient difference y - x (..., 3), without cancellation where (x1, x2) determines x0."""

    @abstractmethod
    def distance(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Geodesic distance (...) without cancellation at small distances."""

    @abstractmethod
    def exp(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """The end of the geodesic that leaves x with velocity v and runs for time 1, (..., 3)."""

    @abstractmethod
    def log(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """The tangent vector v at x with exp(x, v) = y of least length, (..., 3)."""

    @abstractmethod
    def turn(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """The tangent vector v at x turned by +90 degrees; at the origin (0, 1, 0) becomes (0, 0, 1)."""

    @abstractmethod
    def from_polar(self, radius: ArrayLike, angle: ArrayLike) -> Floats:
        """The point at distance `radius` from the origin (1, 0, 0) in direction `angle`, (..., 3)."""

    @abstractmethod
    def point_defect(self, x: ArrayLike) -> Floats:
        """How far x (..., 3) is from satisfying the equation of X, (...)."""

    @abstractmethod
    def isometry_defect(self, g: ArrayLike) -> Floats:
        """How far a matrix (..., 3, 3) is from an isometry of X, (...): largest entry of the violated identities."""

    @abstractmethod
    def nearest_isometry(self, g: ArrayLike) -> Floats:
        """The isometry next to a matrix (..., 3, 3) that is one up to rounding; keeps its orientation."""

    @abstractmethod
    def inverse(self, g: ArrayLike) -> Floats:
        """The inverse of an isometry (..., 3, 3) in closed form, without a linear solve."""

    # ---- what follows from it -----------------------------------------------------------------------------------

    @property
    def origin(self) -> Floats:
        """The point (1, 0, 0)."""
        return np.array([1.0, 0.0, 0.0])

    @final
    def act(self, g: ArrayLike, x: ArrayLike) -> Floats:
        """g x for isometries (..., 3, 3) and points (..., 3), leading axes broadcast."""
        moved = np.einsum("...ij,...j->...i", np.asarray(g, dtype=float), np.asarray(x, dtype=float))
        return np.asarray(moved)

    @final
    def norm(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """Length (...) of tangent vectors v at x."""
        return np.asarray(np.sqrt(np.maximum(self.inner(x, v, v), 0.0)))

    @final
    def frame(self, x: ArrayLike) -> Floats:
        """Two orthonormal tangent vectors at x as columns, (..., 3, 2); the second is the first turned by +90 degrees.

        The frame ((0, 1, 0), (0, 0, 1)) of the origin, carried along the geodesic to x. On the half of S^2 with x0 < 0
        it comes from the frame of the antipode, so that no small number is ever divided by.
        """
        x0, x1, x2 = np.moveaxis(np.asarray(x, dtype=float), -1, 0)
        k, side = self.curvature, np.copysign(1.0, x0)
        share = k / (1 + np.abs(x0))
        mixed = -share * x1 * x2
        first = np.stack([-k * side * x1, 1 - share * x1**2, mixed], axis=-1)
        second = np.stack([-k * x2, side * mixed, side * (1 - share * x2**2)], axis=-1)
        return np.stack([first, second], axis=-1)

    @final
    def carry(self, x: ArrayLike) -> Floats:
        """The isometry (..., 3, 3) that takes the origin to x and the frame of the origin to `frame(x)`."""
        points = np.asarray(x, dtype=float)
        return np.concatenate([points[..., None], self.frame(points)], axis=-1)

    @final
    def flag(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """The isometry that takes the origin to x and the direction (0, 1, 0) to that of the tangent vector v at x."""
        base, velocity = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(v, dtype=float))
        ahead = velocity / self.norm(base, velocity)[..., None]
        return np.stack([base, ahead, self.turn(base, ahead)], axis=-1)

    @final
    def translation(self, length: ArrayLike, angle: ArrayLike = 0.0) -> Floats:
        """The isometry that moves the origin by `length` in direction `angle` and that line in itself, (..., 3, 3)."""
        distance, direction = np.broadcast_arrays(np.asarray(length, dtype=float), np.asarray(angle, dtype=float))
        sine, half = (self.from_polar(distance * s, 0.0)[..., 1] for s in (1.0, 0.5))
        u = np.stack([np.cos(direction), np.sin(direction)], axis=-1)
        g = np.zeros((*distance.shape, 3, 3))
        g[..., 0, 0] = self.from_polar(distance, 0.0)[..., 0]
        g[..., 1:, 0] = sine[..., None] * u
        g[..., 0, 1:] = -self.curvature * g[..., 1:, 0]
        shrink = 2 * self.curvature * half**2
        g[..., 1:, 1:] = np.eye(2) - shrink[..., None, None] * u[..., :, None] * u[..., None, :]
        return g

    @final
    def rotation(self, angle: ArrayLike) -> Floats:
        """The rotation about the origin by `angle`, counterclockwise, (..., 3, 3)."""
        return _fixing_origin(np.cos(angle), np.sin(angle), 1.0)

    @final
    def reflection(self, angle: ArrayLike = 0.0) -> Floats:
        """The reflection in the line through the origin of direction `angle`, (..., 3, 3)."""
        return _fixing_origin(np.cos(2 * np.asarray(angle)), np.sin(2 * np.asarray(angle)), -1.0)

    @final
    def glide(self, length: ArrayLike, angle: ArrayLike = 0.0) -> Floats:
        """The glide reflection along the line through the origin of direction `angle`; on S^2 a rotary reflection."""
        return self.translation(length, angle) @ self.reflection(angle)

    @final
    def parabolic(self, amount: float, angle: float = 0.0) -> Floats:
        """The ideal transformation of H^2 that fixes the ideal point (1, cos angle, sin angle), (3, 3).

        It moves the origin along the horocycle by the length `amount`. Raises GeometryError in S^2 and E^2, which have
        no ideal points.
        """
        if self.curvature >= 0:
            raise GeometryError(f"{self.name} has no ideal points and no ideal transformations; use H^2")
        ideal = np.array([1.0, np.cos(angle), np.sin(angle)])
        across = np.array([0.0, -np.sin(angle), np.cos(angle)])
        form = np.diag([1.0, -1.0, -1.0])
        step = amount * (np.outer(across, form @ ideal) - np.outer(ideal, form @ across))
        return np.asarray(np.eye(3) + step + step @ step / 2)

    @final
    def parity(self, g: ArrayLike) -> Floats:
        """+1 where an isometry (..., 3, 3) keeps orientation, -1 where it reverses it, (...)."""
        matrix = np.asarray(g, dtype=float)
        normal = np.cross(matrix[..., 1], matrix[..., 2])
        # In H^2 the normal is +-(x0, -x1, -x2) for x = g(origin): its first entry has the sign without cancellation.
        height = np.sum(matrix[..., 0] * normal, axis=-1) if self.curvature > 0 else normal[..., 0]
        return np.copysign(1.0, height)

    @final
    def motion(self, g: ArrayLike, tolerance: float = 1e-9) -> Motion:
        """What kind of isometry the matrix g (3, 3) is, with its angle, length, fixed point and axis."""
        matrix = np.asarray(g, dtype=float)
        return find_motion(self.curvature, matrix, self.inverse(matrix), int(self.parity(matrix)), tolerance)

    @final
    def classify(self, g: ArrayLike, tolerance: float = 1e-9) -> str:
        """The kind of an isometry g (3, 3): one of the names of `Motion.kind`."""
        return self.motion(g, tolerance).kind

    @final
    def geodesic(self, x: ArrayLike, y: ArrayLike, t: ArrayLike) -> Floats:
        """The point at fraction t of the shortest geodesic from x to y, (..., 3); t (...) broadcasts."""
        return self.exp(x, np.asarray(t, dtype=float)[..., None] * self.log(x, y))

    @final
    def angle(self, x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Floats:
        """The angle (...) at x from the geodesic to y to the geodesic to z, counterclockwise, in (-pi, pi]."""
        base, first, second = np.asarray(x, dtype=float), self.log(x, y), self.log(x, z)
        return np.asarray(np.arctan2(self.inner(base, self.turn(base, first), second), self.inner(base, first, second)))

    @final
    def triangle_area(self, x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Floats:
        """Area (...) of the geodesic triangle x, y, z: positive if counterclockwise, without cancellation.

        tan(A/2) = det(x, y - x, z - x) / (4 - K (c_xy + c_yz + c_zx)) with the versine c and curvature K; in E^2 the
        same with A/2 in place of its tangent. On S^2 the result lies in (-2 pi, 2 pi].
        """
        volume = np.sum(np.asarray(x) * np.cross(self.chord(x, y), self.chord(x, z)), axis=-1)
        versines = self.versine(x, y) + self.versine(y, z) + self.versine(z, x)
        whole = 4 - self.curvature * versines
        return np.asarray(2 * np.arctan2(volume, whole) if self.curvature else volume / 2)

    @final
    def to_chart(self, model: str, x: ArrayLike) -> Floats:
        """Plane coordinates (..., 2) of points x (..., 3) in a model.

        "projective": straight lines stay straight (H^2 Klein, S^2 gnomonic, which sees x and -x as one);
        "conformal": angles are kept (H^2 Poincare, S^2 stereographic from (-1, 0, 0)). E^2 is itself in both.
        """
        points = np.asarray(x, dtype=float)
        shift = _chart_shift(model) * (self.curvature != 0)
        return np.asarray(points[..., 1:] / (shift + points[..., :1]))

    @final
    def from_chart(self, model: str, p: ArrayLike) -> Floats:
        """Points of X (..., 3) from plane coordinates p (..., 2) in a model; the inverse of `to_chart`.

        In S^2 the projective model gives the points with x0 > 0. Raises GeometryError for p outside the unit disc of
        H^2.
        """
        plane = np.asarray(p, dtype=float)
        square = np.sum(plane**2, axis=-1)
        if self.curvature < 0 and (bad := np.flatnonzero(~(square < 1))).size:
            radius = np.sqrt(np.ravel(square)[bad[0]])
            raise GeometryError(f"point {bad[0]} has radius {radius:.6g}; points of H^2 have radius < 1 in its discs")
        if not _chart_shift(model) or not self.curvature:
            return self.project(np.concatenate([np.ones_like(plane[..., :1]), plane], axis=-1))
        bend = (self.curvature * square)[..., None]
        return self.settle(np.concatenate([1 - bend, 2 * plane], axis=-1) / (1 + bend))


def _fixing_origin(cosine: ArrayLike, sine: ArrayLike, parity: float) -> Floats:
    c, s = np.asarray(cosine, dtype=float), np.asarray(sine, dtype=float)
    g = np.zeros((*c.shape, 3, 3))
    g[..., 0, 0] = 1
    g[..., 1, 1], g[..., 1, 2] = c, -parity * s
    g[..., 2, 1], g[..., 2, 2] = s, parity * c
    return g


def _chart_shift(model: str) -> int:
    if model not in ("projective", "conformal"):
        raise GeometryError(f"no model '{model}'; the models are projective and conformal")
    return int(model == "conformal")
