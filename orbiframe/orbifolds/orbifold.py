"""Orbifold X/H: a geometry, an atlas, and the lifts of patches within a radius."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.components.one_line import one_line
from orbiframe.orbifolds.atlas import Atlas, Points
from orbiframe.planes.geometry import Geometry

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Two copies of one patch are one if their origins agree to this: H acts freely, so others lie a systole apart.
_SAME_PLACE = 1e-6


@dataclass(frozen=True, eq=False)
class Copies:
    """Copies of patch frames, each seen from a frame of its own: copy k is the frame of `patch[k]` seen from base[k].

    base: (k,), the number of the frame that sees it; patch: (k,); isometry: (k, 3, 3), takes coordinates in the frame
    of the copy to coordinates in the frame that sees it.
    """

    base: Ints
    patch: Ints
    isometry: Floats

    __repr__ = one_line

    def take(self, chosen: Ints | Bools) -> Copies:
        """Some of the copies."""
        return Copies(self.base[chosen], self.patch[chosen], self.isometry[chosen])


@dataclass(frozen=True, eq=False)
class Orbifold:
    """X/H, a closed surface or orbifold: its patches, its Euler characteristic, whether it is orientable, its area.

    area: 2 pi |euler_characteristic| in S^2 and H^2 (Gauss-Bonnet), the area of a fundamental domain in E^2.

    >>> import numpy as np
    >>> from orbiframe import fit
    >>> orbifold = fit("dataset:three_crosscaps", size=60).surface.orbifold
    >>> orbifold.euler_characteristic, orbifold.orientable, round(orbifold.area / np.pi, 12)
    (-1, False, 2.0)
    """

    atlas: Atlas
    euler_characteristic: int | Fraction
    orientable: bool
    area: float

    __repr__ = one_line

    @property
    def geometry(self) -> Geometry:
        """The plane of constant curvature that covers the surface."""
        return self.atlas.geometry

    def lifts(self, patch: int, radius: float) -> tuple[Ints, Floats]:
        """Every copy of a patch frame whose origin lies within `radius` of the origin of the frame of `patch`.

        Returns the patch of each copy, (k,), and the isometry from its frame to the frame of `patch`, (k, 3, 3), each
        once; the first is the patch itself with the identity. Found by walking from patch to patch, see `copies`.
        """
        found = self.copies(np.array([patch]), np.array([radius]))
        return found.patch, found.isometry

    def copies(self, patches: ArrayLike, radii: ArrayLike) -> Copies:
        """The lifts of many patches at once: those of patches[i] within radii[i] have base i and stand together.

        The walk goes from a copy g to its neighbours g h, h a transition, as long as their origins stay within the
        radius plus the radius of their patch. That finds every copy if X is tiled by polygons, one about the origin of
        each copy and within the radius of its patch, and a transition joins any two polygons with a common side: the
        geodesic from origin to origin runs through a chain of neighbours that all come as near. (Where it runs through
        a corner, one beside it does not.) In S^2 no distance exceeds pi, and a large radius visits the whole finite
        group.
        """
        base, reach = np.asarray(patches, dtype=np.intp), np.asarray(radii, dtype=np.float64)
        origin = self.geometry.origin
        levels = []
        for level in self._walk(base, reach):
            levels.append(level.take(self.geometry.distance(origin, level.isometry[:, :, 0]) <= reach[level.base]))
        found = Copies(*(np.concatenate([getattr(x, name) for x in levels]) for name in ("base", "patch", "isometry")))
        return found.take(np.argsort(found.base, kind="stable"))

    def settled(self, points: Points) -> Points:
        """The same points of X/H, each in the frame of a patch to whose origin no neighbouring one is nearer.

        Points that have been moved on X and left their patch walk from patch to patch, downhill.
        """
        patch, x = np.array(points.patch, dtype=np.intp), np.array(points.x, dtype=np.float64)
        far = np.flatnonzero(self.geometry.distance(self.geometry.origin, x) > self.atlas.radius[patch])
        while len(far):
            parent, step = self.steps(patch[far])
            place = self.geometry.act(self.atlas.isometry[self.atlas.inverse[step]], x[far[parent]])
            away = self.geometry.distance(self.geometry.origin, place)
            order = np.lexsort((away, parent))
            best = order[np.unique(parent[order], return_index=True)[1]]
            far = far[parent[best]]
            nearer = away[best] < self.geometry.distance(self.geometry.origin, x[far]) * (1 - 1e-9)
            far, best = far[nearer], best[nearer]
            patch[far], x[far] = self.atlas.head[step[best]], self.geometry.settle(place[best])
        return Points(patch, x)

    def _walk(self, patches: Ints, reach: Floats) -> Iterator[Copies]:
        """Breadth first, level by level: a neighbour lies in the level itself, the one before or the next."""
        level = Copies(np.arange(len(patches)), patches, np.tile(np.eye(3), (len(patches), 1, 1)))
        before = level.take(np.zeros(0, dtype=np.intp))
        while len(level.base):
            yield level
            before, level = level, self._next_level(before, level, reach)

    def _next_level(self, before: Copies, level: Copies, reach: Floats) -> Copies:
        """The neighbours of a level that come within reach and are new."""
        atlas = self.atlas
        parent, step = self.steps(level.patch)
        place = np.einsum("kij,kj->ki", level.isometry[parent], atlas.isometry[step, :, 0])
        limit = reach[level.base[parent]] + atlas.radius[atlas.head[step]]
        near = self.geometry.distance(self.geometry.origin, place) <= limit
        parent, step, place = parent[near], step[near], place[near]
        base, patch = level.base[parent], atlas.head[step]
        known = len(before.base) + len(level.base)
        new = _first_seen(
            np.concatenate([before.base, level.base, base]) * atlas.patch_count
            + np.concatenate([before.patch, level.patch, patch]),
            np.concatenate([before.isometry[:, :, 0], level.isometry[:, :, 0], place]),
        )
        new = new[new >= known] - known
        return Copies(base[new], patch[new], level.isometry[parent[new]] @ atlas.isometry[step[new]])

    def steps(self, patch: Ints) -> tuple[Ints, Ints]:
        """All pairs of an index into `patch` (n,) and a transition that leaves that patch."""
        leaving = np.argsort(self.atlas.tail, kind="stable")
        start = np.searchsorted(self.atlas.tail[leaving], np.arange(self.atlas.patch_count + 1))
        count = start[patch + 1] - start[patch]
        parent = np.repeat(np.arange(len(patch)), count)
        within = np.arange(len(parent)) - np.repeat(np.cumsum(count) - count, count)
        return parent, leaving[start[patch[parent]] + within]


def _first_seen(kind: Ints, place: Floats) -> Ints:
    """The rows that are the first of their kind at their place, in order; kind: (n,), place: (n, 3)."""
    run = kind
    for value in place.T:
        run = _runs(run, value)
    first = np.unique(run, return_index=True)[1]
    return np.sort(first)


def _runs(kind: Ints, value: Floats) -> Ints:
    """Numbers of runs of equal kind and of values without a gap; robust where rounding would cut a fixed grid."""
    order = np.lexsort((value, kind))
    cut = (np.diff(kind[order]) != 0) | (np.diff(value[order]) > _SAME_PLACE)
    run = np.empty(len(kind), dtype=np.intp)
    run[order] = np.concatenate([[0], np.cumsum(cut)])[: len(kind)]
    return run
