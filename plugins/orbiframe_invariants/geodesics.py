"""Geodesics of X/H: distances, shortest paths, the exponential map, closed geodesics and triangles, in any atlas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe import Geometry, GeometryError, Group, Orbifold, Points
from orbiframe.orbifolds import Copies
from orbiframe.planes import PreciseIsometry
from orbiframe_invariants.closed_geodesics import axes, translation_lengths

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# A walk goes on by this much at most between two changes of frame, so that all numbers stay small.
_STRIDE = 1.0
_BEYOND = 1e-9
_MOST_PAIRS = 2_000_000


@dataclass(frozen=True, eq=False)
class Triangles:
    """Geodesic triangles of X/H, each lifted to X: corners (n, 3, 3), [triangle, corner, coordinate]."""

    geometry: Geometry
    corners: Floats

    @property
    def sides(self) -> Floats:
        """The length of the side from each corner to the next, (n, 3)."""
        return self.geometry.distance(self.corners, np.roll(self.corners, -1, axis=1))

    @property
    def angles(self) -> Floats:
        """The angle at each corner, in [0, pi], (n, 3)."""
        x = self.corners
        return np.abs(self.geometry.angle(x, np.roll(x, -1, axis=1), np.roll(x, -2, axis=1)))

    @property
    def areas(self) -> Floats:
        """The area of each triangle, (n,), positive where its corners run counterclockwise in the frame they are in.

        Gauss: curvature times area is the sum of the angles less pi.
        """
        x = self.corners
        return self.geometry.triangle_area(x[:, 0], x[:, 1], x[:, 2])


@dataclass(frozen=True, eq=False)
class ClosedGeodesic:
    """The shortest closed curve in a free homotopy class of X/H.

    geodesics: of X/H; length; one_sided: going round it reverses orientation; start: one of its points; velocity:
    (1, 3), the unit tangent vector there.
    """

    geodesics: Geodesics
    length: float
    one_sided: bool
    start: Points
    velocity: Floats

    def points(self, count: int) -> Points:
        """`count` points of the curve at equal distances; the first is its start."""
        share = self.length * np.arange(count) / count
        start = Points(np.repeat(self.start.patch, count), np.repeat(self.start.x, count, axis=0))
        return self.geodesics.exp(start, self.velocity * share[:, None])[0]


@dataclass(frozen=True, eq=False)
class Geodesics:
    """The metric of a surface X/H that an atlas gives, of a named group or found from a mesh.

    Points of X/H are given in the frames of patches, and so are tangent vectors, ambient (n, 3). Where several shortest
    paths join two points, one of them is taken.
    """

    orbifold: Orbifold

    @classmethod
    def of_group(cls, group: Group) -> Geodesics:
        """The metric of X/H for a group, with the domain of the group as the one patch."""
        word = group.word
        return cls(Orbifold(group.atlas(), word.euler_characteristic, word.orientable, group.area))

    @property
    def geometry(self) -> Geometry:
        """The plane of constant curvature that covers the surface."""
        return self.orbifold.geometry

    def distance(self, x: Points, y: Points) -> Floats:
        """The length of the shortest path on X/H, (n,): the least distance of x from a lift of y."""
        return self.geometry.distance(np.asarray(x.x), self.nearest_lift(x, y))

    def log(self, x: Points, y: Points) -> Floats:
        """The tangent vectors at x, in the frames of its patches, of shortest paths to y, (n, 3): exp(x, log) is y."""
        return self.geometry.log(np.asarray(x.x), self.nearest_lift(x, y))

    def between(self, x: Points, y: Points, t: ArrayLike) -> Points:
        """The points at the fractions t (n,) of shortest paths from x to y."""
        return self.exp(x, self.log(x, y) * np.asarray(t, dtype=float)[..., None])[0]

    def triangles(self, x: Points, y: Points, z: Points) -> Triangles:
        """The triangles with shortest paths from x to y and from x to z as sides.

        The third side is the geodesic that closes the triangle in X; only in a small triangle is it the shortest path.
        """
        corners = [np.asarray(x.x, dtype=float), self.nearest_lift(x, y), self.nearest_lift(x, z)]
        return Triangles(self.geometry, np.stack(corners, axis=1))

    def exp(self, x: Points, velocity: ArrayLike) -> tuple[Points, Floats]:
        """The ends of geodesics that leave points x with velocities (n, 3) and run for time 1; the velocities there.

        The walk goes from patch to patch, so that its rounding errors are those of the geodesic flow itself: eps e^d
        over the length d in H^2.
        """
        v = np.asarray(velocity, dtype=float)
        speed = self.geometry.norm(x.x, v)
        still = speed == 0
        ahead = np.where(still[:, None], self.geometry.frame(x.x)[..., 0], v)
        patch, flag = np.array(x.patch, dtype=np.intp), self.geometry.flag(x.x, ahead)
        left = np.array(speed)
        patch, flag = self._at_home(patch, flag)
        while (moving := np.flatnonzero(left > 0)).size:
            stride = np.minimum(left[moving], _STRIDE)
            moved = self.geometry.nearest_isometry(flag[moving] @ self.geometry.translation(stride))
            patch[moving], flag[moving] = self._at_home(patch[moving], moved)
            left[moving] -= stride
        return Points(patch, self.geometry.settle(flag[..., 0])), flag[..., 1] * speed[:, None]

    def home(self, x: Points) -> Points:
        """The same points of X/H, each in the frame of a patch within whose radius it lies."""
        patch, flag = self._at_home(np.array(x.patch, dtype=np.intp), self.geometry.carry(x.x))
        return Points(patch, self.geometry.settle(flag[..., 0]))

    def closed(self, deck: ArrayLike | PreciseIsometry, patch: int = 0) -> ClosedGeodesic:
        """The shortest closed curve in the class of a deck transformation, a matrix (3, 3), seen from a patch.

        In a named group `group.precise_element(word)` is the deck transformation of a loop, as a `PreciseIsometry`.
        Raises GeometryError for the identity and other isometries with a fixed point, whose loops can be contracted or
        run round a singular point.
        """
        precise = (
            deck if isinstance(deck, PreciseIsometry) else PreciseIsometry.of_matrix(self.geometry.curvature, deck)
        )
        precise = PreciseIsometry(
            precise.curvature, np.reshape(precise.a, 1), np.reshape(precise.b, 1), np.reshape(precise.reverses, 1)
        )
        length = float(translation_lengths(precise)[0])
        if not length > _BEYOND:
            raise GeometryError("a deck transformation with a fixed point has no closed geodesic; give a longer word")
        at, flag = self._at_home(np.array([patch]), _axis_flag(self.geometry, precise)[None])
        return ClosedGeodesic(self, length, bool(precise.reverses[0]), Points(at, flag[..., 0]), flag[..., 1])

    def nearest_lift(self, x: Points, y: Points) -> Floats:
        """The lift of y nearest to x, in the frame of the patch of x, (n, 3).

        Copies of the patch of y within |x| + m + |y| hold all lifts within m, for points |x| and |y| from the origins
        of their frames. So m grows until a lift is found that near.
        """
        x = Points(np.asarray(x.patch, dtype=np.intp), np.asarray(x.x, dtype=np.float64))
        y = self.home(y)
        found, reach = np.empty_like(y.x), np.full(len(y.x), 0.5 * self.orbifold.atlas.radius.max())
        waiting = np.arange(len(y.x))
        while len(waiting):
            start, end = (Points(p.patch[waiting], p.x[waiting]) for p in (x, y))
            lift, apart = self._nearest_within(start, end, reach[waiting])
            found[waiting] = lift
            near = apart <= reach[waiting]
            reach[waiting] = np.where(np.isfinite(apart), apart * (1 + _BEYOND), 2 * reach[waiting])
            waiting = waiting[~near]
        return found

    def _nearest_within(self, x: Points, y: Points, reach: Floats) -> tuple[Floats, Floats]:
        """Of the lifts of y in reach of x the nearest, (n, 3), and its distance; infinite where there is none."""
        origin, count = self.geometry.origin, self.orbifold.atlas.patch_count
        span = self.geometry.distance(origin, x.x) + reach + self.geometry.distance(origin, y.x)
        base, which = np.unique(x.patch, return_inverse=True)
        radii = np.zeros(len(base))
        np.maximum.at(radii, which, span * (1 + _BEYOND) + _BEYOND)
        copies = self.orbifold.copies(base, radii)
        copies = copies.take(np.argsort(copies.base * count + copies.patch, kind="stable"))
        key = copies.base * count + copies.patch
        first, last = (np.searchsorted(key, which * count + y.patch, side=side) for side in ("left", "right"))
        lift, apart = np.full_like(y.x, np.nan), np.full(len(y.x), np.inf)
        for part in np.array_split(np.arange(len(y.x)), 1 + int((last - first).sum()) // _MOST_PAIRS):
            self._take_nearest(part, first, last, copies, x, y, lift, apart)
        return lift, apart

    def _take_nearest(
        self, part: Ints, first: Ints, last: Ints, copies: Copies, x: Points, y: Points, lift: Floats, apart: Floats
    ) -> None:
        """Enter the nearest lifts of some of the points: those in the copies from first to last."""
        row, copy = _ragged(first[part], last[part])
        row = part[row]
        lifts = self.geometry.settle(self.geometry.act(copies.isometry[copy], y.x[row]))
        distance = self.geometry.distance(x.x[row], lifts)
        order = np.lexsort((distance, row))
        number, nearest = np.unique(row[order], return_index=True)
        lift[number], apart[number] = lifts[order[nearest]], distance[order[nearest]]

    def _at_home(self, patch: Ints, flag: Floats) -> tuple[Ints, Floats]:
        """Flags (n, 3, 3) carried from patch to patch until each lies within the radius of its patch."""
        atlas = self.orbifold.atlas
        while (out := np.flatnonzero(self._height(flag) > atlas.radius[patch] * (1 + _BEYOND))).size:
            step, nearer = self._step_home(patch[out], flag[out])
            go = out[nearer]
            flag[go] = self.geometry.inverse(atlas.isometry[step[nearer]]) @ flag[go]
            patch[go] = atlas.head[step[nearer]]
            for stuck in out[~nearer]:
                patch[stuck], flag[stuck] = self._found_home(int(patch[stuck]), flag[stuck])
            flag[out] = self.geometry.nearest_isometry(flag[out])
        return patch, flag

    def _step_home(self, patch: Ints, flag: Floats) -> tuple[Ints, Bools]:
        """The transition to the neighbour whose origin is nearest, and whether it is nearer than the origin itself."""
        row, step = self.orbifold.steps(patch)
        distance = self.geometry.distance(flag[row, :, 0], self.orbifold.atlas.isometry[step, :, 0])
        order = np.lexsort((distance, row))
        nearest = order[np.unique(row[order], return_index=True)[1]]
        return step[nearest], distance[nearest] < self._height(flag) * (1 - _BEYOND)

    def _found_home(self, patch: int, flag: Floats) -> tuple[int, Floats]:
        """The same by looking at all patches around: no neighbour is nearer, but some patch holds the point."""
        radius = self.orbifold.atlas.radius
        heads, isometries = self.orbifold.lifts(patch, float(self._height(flag)) + radius.max())
        beyond = self.geometry.distance(flag[:, 0], isometries[..., 0]) - radius[heads]
        best = int(np.argmin(beyond))
        if beyond[best] > _BEYOND * radius[heads[best]]:
            raise GeometryError(
                f"a point at the distance {self._height(flag):.6g} from the origin of patch {patch} lies in no patch; "
                "check the radii of the atlas"
            )
        return int(heads[best]), self.geometry.inverse(isometries[best]) @ flag

    def _height(self, flag: Floats) -> Floats:
        return self.geometry.distance(self.geometry.origin, flag[..., 0])


def _ragged(first: Ints, last: Ints) -> tuple[Ints, Ints]:
    """All pairs of a row and a number from first[row] up to, not with, last[row]."""
    count = last - first
    row = np.repeat(np.arange(len(count)), count)
    return row, np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)


def _axis_flag(geometry: Geometry, precise: PreciseIsometry) -> Floats:
    """The isometry that takes the origin to the nearest point of the axis, and (0, 1, 0) to the way things move there.

    For the antipodal map every great circle is an axis; the one through the origin in the direction (0, 1, 0).
    """
    k = geometry.curvature
    if k > 0:
        return np.eye(3)
    height, *normal = axes(precise)[0]
    foot = geometry.project(np.array([1 - k * height**2, *(-height * np.array(normal))]))
    along = geometry.turn(foot, np.array([k * height, *normal]))
    moved = geometry.log(foot, geometry.act(precise.matrix[0], foot))
    return geometry.flag(foot, along * np.sign(geometry.inner(foot, along, moved)))
