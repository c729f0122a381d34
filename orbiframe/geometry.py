"""Geometry: a plane of constant curvature in the paper's linear model (sections 1.2 to 1.4)."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


class Geometry(ABC):
    """The sphere, the Euclidean plane or the hyperbolic plane as a surface X in R^3.

    Points are rows (..., 3), leading axes broadcast: S^2 is |x| = 1, E^2 is x0 = 1, H^2 is x0^2 - x1^2 - x2^2 = 1 with
    x0 > 0. Isometries are matrices (..., 3, 3) that act on column vectors from the left. Tangent vectors are ambient,
    (..., 3). Angles are radians, lengths are in units of curvature +1 or -1 (E^2: free).
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
    def inner(self, v: ArrayLike, w: ArrayLike) -> Floats:
        """The Riemannian scalar product (...) of tangent vectors at one point; positive definite on tangent vectors."""

    @abstractmethod
    def versine(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """The smooth distance function c: 1 - cos d (S^2), d^2/2 (E^2), cosh d - 1 (H^2), without cancellation."""

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

    def act(self, g: ArrayLike, x: ArrayLike) -> Floats:
        """g x for isometries (..., 3, 3) and points (..., 3), leading axes broadcast."""
        return np.einsum("...ij,...j->...i", np.asarray(g, dtype=float), np.asarray(x, dtype=float))
