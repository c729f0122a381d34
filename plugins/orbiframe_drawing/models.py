"""Models: where the points of X come to lie in a picture, and as which curves its geodesics (sections 1.1 to 1.4)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe import Geometry, UsageError
from orbiframe_drawing.picture import Curve, circle

Floats = NDArray[np.float64]


# A geodesic on the hyperboloid or the sphere becomes cubics of at most this length; they are within 4e-4 of it.
_STEP = 0.6
# Flatter arcs, by their turn, are segments: their centres are too far away for floating point.
_STRAIGHT = 1e-7
# A point of the sphere is hidden from the eye from this depth on.
_HORIZON = 1e-9


class Model(ABC):
    """A picture of X: `place` takes points (..., 3) of X to the plane, (..., 2)."""

    geometry: Geometry

    @abstractmethod
    def place(self, x: ArrayLike) -> Floats:
        """The points (..., 2) in the picture of points (..., 3) of X."""

    @abstractmethod
    def geodesics(self, x: Floats, y: Floats) -> list[Curve]:
        """The pictures of the shortest geodesics from x[k] to y[k], (n, 3) each."""

    def boundary(self) -> tuple[Curve, ...]:
        """A closed path round the picture of X; empty where the picture fills the plane."""
        return ()

    @abstractmethod
    def points(self, p: Floats) -> Floats:
        """The points of X (n, 3) that are seen at points of the picture, (n, 2); nan where there is none."""

    @abstractmethod
    def front(self, corners: Floats, closed: bool) -> Floats:
        """The part towards the eye of a convex polygon, or of a chain of geodesics, with corners (n, 3): (m, 3)."""

    def geodesic(self, x: Floats, y: Floats) -> Curve:
        """The picture of the shortest geodesic from x to y, (3,) each."""
        return self.geodesics(x[None], y[None])[0]

    def paths(self, corners: Floats, closed: bool = True) -> list[list[Curve]]:
        """What is to be seen of polygons (n, m, 3) with geodesic sides, or of chains of geodesics: none or one each."""
        parts = [self.front(chain, closed) for chain in corners]
        parts = [np.concatenate([part, part[:1]]) if closed else part for part in parts if len(part) > 1]
        if not parts:
            return []
        sides = self.geodesics(np.concatenate([p[:-1] for p in parts]), np.concatenate([p[1:] for p in parts]))
        ends = np.cumsum([len(part) - 1 for part in parts])
        return [sides[end - len(part) + 1 : end] for part, end in zip(parts, ends, strict=True)]


@dataclass(frozen=True, eq=False)
class Chart(Model):
    """The projective model, in which geodesics are segments, or the conformal one, in which they are circular arcs.

    In the conformal model of H^2 the circles meet the unit circle at right angles; E^2 is itself in both.
    """

    geometry: Geometry
    name: str

    def place(self, x: ArrayLike) -> Floats:
        """See `Geometry.to_chart`."""
        return self.geometry.to_chart(self.name, x)

    def geodesics(self, x: Floats, y: Floats) -> list[Curve]:
        """Segments or arcs."""
        ends = np.stack([self.place(x), self.place(y)], axis=1)
        turn = np.zeros(len(ends))
        if self.name == "conformal":
            # The chords to and from a point of an arc make half the angle of the arc.
            middle = self.place(self.geometry.project(x + y))
            p, q = (middle - ends[:, 0]).T, (ends[:, 1] - middle).T
            turn = 2 * np.arctan2(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1])
            turn[np.abs(turn) < _STRAIGHT] = 0.0
        return [Curve(*given) for given in zip(ends, turn.tolist(), strict=True)]

    def front(self, corners: Floats, closed: bool) -> Floats:  # noqa: ARG002
        """All of it."""
        return corners

    def points(self, p: Floats) -> Floats:
        """See `Geometry.from_chart`."""
        inside = (p**2).sum(axis=1) < 1 if self.geometry.curvature < 0 else np.ones(len(p), dtype=np.bool_)
        x = self.geometry.from_chart(self.name, np.where(inside[:, None], p, 0.0))
        return np.where(inside[:, None], x, np.nan)

    def boundary(self) -> tuple[Curve, ...]:
        """The ideal circle of H^2."""
        return circle((0.0, 0.0), 1.0) if self.geometry.curvature < 0 else ()


@dataclass(frozen=True, eq=False)
class Solid(Model):
    """X itself in space, the hyperboloid or the sphere, seen from far away.

    elevation: of the eye above the plane x0 = 0, azimuth: the direction in that plane in which it stands; radians.
    From elevations above pi/4 no part of the hyperboloid hides another. height: where the hyperboloid is cut off.
    """

    geometry: Geometry
    elevation: float = 0.95
    azimuth: float = -0.5 * np.pi
    height: float = 8.0

    def place(self, x: ArrayLike) -> Floats:
        """Parallel projection."""
        return np.asarray(np.asarray(x, dtype=np.float64) @ self._axes[:2].T)

    def geodesics(self, x: Floats, y: Floats) -> list[Curve]:
        """Cubics with the right ends and tangents."""
        geometry = self.geometry
        velocity = geometry.log(x, y)
        counts = np.maximum(np.ceil(geometry.norm(x, velocity) / _STEP), 1).astype(np.intp)
        return [self._cubics(x[k], velocity[k], int(count)) for k, count in enumerate(counts)]

    def boundary(self) -> tuple[Curve, ...]:
        """The circle at which the hyperboloid is cut off; the outline of the sphere."""
        if self.geometry.curvature > 0:
            return circle((0.0, 0.0), 1.0)
        return (self.level(self.height),)

    def points(self, p: Floats) -> Floats:
        """Where the line of sight first meets the sphere, or the hyperboloid from above."""
        form = np.array([1.0, self.geometry.curvature, self.geometry.curvature])
        base, eye = p @ self._axes[:2], self._axes[2]
        a, b, c = (eye**2) @ form, (base * eye) @ form, (base**2) @ form - 1
        with np.errstate(invalid="ignore"):
            x = base + ((np.sqrt(b**2 - a * c) - b) / a)[:, None] * eye
        return np.where((x[:, :1] <= self.height) | (self.geometry.curvature > 0), x, np.nan)

    def front(self, corners: Floats, closed: bool) -> Floats:
        """Of a polygon or chain on the sphere, the part on the half towards the eye; the hyperboloid hides nothing."""
        depth = corners @ self._axes[2]
        seen = depth > _HORIZON
        if self.geometry.curvature < 0 or seen.all():
            return corners
        kept: list[Floats] = []
        for k in range(len(corners) if closed else len(corners) - 1):
            after = (k + 1) % len(corners)
            if seen[k]:
                kept.append(corners[k])
            if seen[k] != seen[after]:
                crossing = depth[k] * corners[after] - depth[after] * corners[k]
                kept.append(self.geometry.project(crossing if seen[k] else -crossing))
                if closed and seen[k]:
                    kept.append(self._horizon(corners))
        if not closed and seen[-1]:
            kept.append(corners[-1])
        return np.array(kept).reshape(-1, 3)

    def _horizon(self, corners: Floats) -> Floats:
        """The point of the outline of the sphere that is nearest to the middle of a polygon."""
        right, up = self._axes[:2] @ corners.mean(axis=0)
        return self.geometry.project(right * self._axes[0] + up * self._axes[1])

    def level(self, height: float) -> Curve:
        """The circle of X at x0 = height."""
        angles = np.linspace(0, 2 * np.pi, 13)
        radius = np.sqrt(abs(height**2 - 1))
        at = np.stack([np.full(13, height), radius * np.cos(angles), radius * np.sin(angles)], axis=1)
        along = np.stack([np.zeros(13), -radius * np.sin(angles), radius * np.cos(angles)], axis=1)
        return Curve(self._hermite(at, along * (4 / 3 * np.tan(np.pi / 24))))

    def _cubics(self, x: Floats, velocity: Floats, count: int) -> Curve:
        t = np.arange(count + 1)[:, None] / count
        at = self.geometry.exp(x, t * velocity)
        length = float(self.geometry.norm(x, velocity))
        if length == 0:
            return Curve(self._hermite(at, np.zeros_like(at)))
        # The speed at each stop: towards the point that lies as far beyond it again.
        beyond = self.geometry.exp(x, (t + 1 / count) * velocity)
        speed = self.geometry.log(at, beyond)
        return Curve(self._hermite(at, speed / 3))

    def _hermite(self, at: Floats, handle: Floats) -> Floats:
        """Control points (3 k + 1, 2) of the cubics through points of space with handles (k + 1, 3)."""
        inner = np.stack([at[:-1] + handle[:-1], at[1:] - handle[1:], at[1:]], axis=1).reshape(-1, 3)
        return self.place(np.concatenate([at[:1], inner]))

    @property
    def _axes(self) -> Floats:
        """Right, up and towards the eye, as rows."""
        c, s = np.cos(self.elevation), np.sin(self.elevation)
        u, v = np.cos(self.azimuth), np.sin(self.azimuth)
        return np.array([[0.0, -v, u], [c, -s * u, -s * v], [s, c * u, c * v]])


def model_of(geometry: Geometry, name: str | None = None) -> Model:
    """The model of a name: projective, conformal, hyperboloid (of H^2) or sphere (of S^2).

    None chooses the conformal model, and the sphere for S^2. Raises UsageError for a model that a geometry has not.
    """
    chosen = name or ("sphere" if geometry.curvature > 0 else "conformal")
    solid = {-1: "hyperboloid", 1: "sphere"}.get(geometry.curvature)
    if chosen == solid:
        return Solid(geometry) if geometry.curvature < 0 else Solid(geometry, elevation=0.75)
    if chosen not in ("projective", "conformal"):
        own = ["projective", "conformal", *([solid] if solid else [])]
        raise UsageError(f"{geometry.name} has no model '{chosen}'; its models are {', '.join(own)}")
    return Chart(geometry, chosen)
