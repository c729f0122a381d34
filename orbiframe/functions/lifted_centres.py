"""Lifted centres: every image of a centre that reaches a patch of X/H, in the frame of that patch.

Each centre walks outward from patch to patch and leaves its place in every one that it reaches. Only its place is
carried from frame to frame, three numbers and no isometry, and the walk ends where the centre reaches no further.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.orbifolds.atlas import Atlas, Points
from orbiframe.orbifolds.orbifold import Orbifold

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Two images in one patch are one if they agree to this: H acts freely, so others lie a systole apart.
_SAME_PLACE = 1e-6
# How much farther than the radius of its patch a point may lie and still count as within, for rounding.
_ROUNDING = 1 + 1e-9


@dataclass(frozen=True, eq=False)
class Images:
    """Lifts of centres in the frame of one patch: the centre of each, (k,), increasing, and its place, (k, 3)."""

    column: Ints
    x: Floats


@dataclass(frozen=True, eq=False)
class LiftedCentres:
    """Centres with their supports, (N,) versines, and their lifts seen from every patch: found once, and kept.

    A lift is seen from a patch if it reaches the disc of the patch. None that reaches a point is missing if the point
    lies in a triangle that has a corner in its patch, as all points of a triangulation do: a geodesic from the centre
    to the point runs through triangles that the centre reaches, and the discs of all their corners contain them.
    """

    orbifold: Orbifold
    centres: Points
    support: Floats

    def seen_from(self, patches: Ints, radii: Floats) -> list[Images]:
        """The images that reach discs about the origins of some patches, at least of these radii, patch by patch.

        Discs that are larger than their patch cost a walk of their own, with a margin as wide as the largest.
        """
        radius = self.orbifold.atlas.radius
        if (radii <= radius[patches] * _ROUNDING).all():
            images, start = self._kept
        else:
            disc = radius.copy()
            np.maximum.at(disc, patches, radii)
            images, start = self._walked(disc, radius + disc[patches].max())
        spans = zip(start[patches], start[patches + 1], strict=True)
        return [Images(images.column[low:high], images.x[low:high]) for low, high in spans]

    @cached_property
    def _kept(self) -> tuple[Images, Ints]:
        """The images that reach the disc of each patch."""
        atlas = self.orbifold.atlas
        passed = atlas.radius.copy()
        # A point near a patch, but beyond its triangles, is seen from there through a neighbour with a larger disc.
        np.maximum.at(passed, atlas.tail[1:], atlas.radius[atlas.head[1:]])
        return self._walked(atlas.radius, passed)

    def _walked(self, disc: Floats, passed: Floats) -> tuple[Images, Ints]:
        """The images that reach discs of some radii (P,), by patches, and where each patch begins.

        passed: (P,), the walk goes on from a patch while a disc of this radius is reached.
        """
        atlas = self.orbifold.atlas
        reach = np.minimum(np.sqrt(self.support / 2), 1.0 if atlas.geometry.curvature > 0 else np.inf)
        start = np.ascontiguousarray(self.centres.x), self.centres.patch.astype(np.int32), reach
        discs = _half_sine(atlas, disc * _ROUNDING), _half_sine(atlas, passed * _ROUNDING)
        patch, column, x = _leave_images(atlas.geometry.curvature, *_entries(atlas), *start, *discs)
        order = np.argsort(patch, kind="stable")
        begins = np.searchsorted(patch[order], np.arange(atlas.patch_count + 1))
        return Images(column[order].astype(np.intp), x[order]), begins


def _half_sine(atlas: Atlas, distance: Floats) -> Floats:
    """sin(d/2), d/2 or sinh(d/2), which is sqrt(versine / 2); 1 from pi on in S^2."""
    if atlas.geometry.curvature > 0:
        return np.asarray(np.sin(np.minimum(distance, np.pi) / 2))
    return np.asarray(np.sinh(distance / 2) if atlas.geometry.curvature < 0 else distance / 2)


def _entries(atlas: Atlas) -> tuple[Ints, NDArray[np.int32], Floats]:
    """The ways out of every patch: where those of a patch begin, the patches they lead to, and what a place becomes."""
    order = 1 + np.argsort(atlas.head[1:], kind="stable")
    begins = np.searchsorted(atlas.head[order], np.arange(atlas.patch_count + 1))
    return begins, atlas.tail[order].astype(np.int32), np.ascontiguousarray(atlas.isometry[order])


@compiled(inline=True)
def _within(curvature, x0, x1, x2, a, b):  # type: ignore[no-untyped-def]
    """Whether the distance from the origin is at most that of half-sine a plus that of half-sine b."""
    if curvature > 0 and a * a + b * b >= 1:
        return True
    total = a * np.sqrt(1 - curvature * b * b) + b * np.sqrt(1 - curvature * a * a)
    # (x1^2 + x2^2) / (2 (1 + x0)) is the square of the half-sine in S^2 and H^2; on the far half of S^2 (1 - x0) / 2.
    square = (1 - x0) / 2 if curvature > 0 and x0 < 0 else (x1 * x1 + x2 * x2) / (2 * (1 + x0))
    return square <= total * total


@compiled
def _leave_images(curvature, begins, leads, moves, x, patch, reach, disc, passed):  # type: ignore[no-untyped-def]
    """Breadth first from each centre: the patch, the centre and the place of every image that reaches a disc."""
    found_patch, found_column = np.empty(1024, dtype=np.int32), np.empty(1024, dtype=np.int32)
    found_x, count = np.empty((1024, 3)), 0
    # The places in one patch are linked: `first` in each patch, then `following`; -1 ends the list.
    first = np.full(len(begins) - 1, -1, dtype=np.int32)
    following, here = np.empty(256, dtype=np.int32), np.empty(256, dtype=np.int32)
    place = np.empty((256, 3))
    for m in range(len(x)):
        here[0], following[0], first[patch[m]] = patch[m], -1, 0
        place[0, 0], place[0, 1], place[0, 2] = x[m, 0], x[m, 1], x[m, 2]
        done, size = 0, 1
        while done < size:
            p, x0, x1, x2 = here[done], place[done, 0], place[done, 1], place[done, 2]
            done += 1
            if _within(curvature, x0, x1, x2, reach[m], disc[p]):
                if count == len(found_patch):
                    found_patch, found_column = _doubled(found_patch), _doubled(found_column)
                    found_x = _doubled_rows(found_x)
                found_patch[count], found_column[count] = p, m
                found_x[count, 0], found_x[count, 1], found_x[count, 2] = x0, x1, x2
                count += 1
            for t in range(begins[p], begins[p + 1]):
                g, q = moves[t], leads[t]
                y0 = g[0, 0] * x0 + g[0, 1] * x1 + g[0, 2] * x2
                y1 = g[1, 0] * x0 + g[1, 1] * x1 + g[1, 2] * x2
                y2 = g[2, 0] * x0 + g[2, 1] * x1 + g[2, 2] * x2
                if curvature < 0:
                    y0 = np.sqrt(1 + y1 * y1 + y2 * y2)
                elif curvature == 0:
                    y0 = 1.0
                if not _within(curvature, y0, y1, y2, reach[m], passed[q]):
                    continue
                same = _SAME_PLACE * (1 + abs(y0))
                k = first[q]
                while k >= 0:
                    z = place[k]
                    if abs(z[1] - y1) < same and abs(z[2] - y2) < same and abs(z[0] - y0) < same:
                        break
                    k = following[k]
                if k >= 0:
                    continue
                if size == len(here):
                    here, following, place = _doubled(here), _doubled(following), _doubled_rows(place)
                here[size], following[size], first[q] = q, first[q], size
                place[size, 0], place[size, 1], place[size, 2] = y0, y1, y2
                size += 1
        for k in range(size):
            first[here[k]] = -1
    return found_patch[:count], found_column[:count], found_x[:count]


@compiled
def _doubled(values):  # type: ignore[no-untyped-def]
    """Room for twice as many values."""
    larger = np.empty(2 * len(values), dtype=values.dtype)
    for k in range(len(values)):
        larger[k] = values[k]
    return larger


@compiled
def _doubled_rows(values):  # type: ignore[no-untyped-def]
    """Room for twice as many rows."""
    larger = np.empty((2 * len(values), values.shape[1]))
    for k in range(len(values)):
        for c in range(values.shape[1]):
            larger[k, c] = values[k, c]
    return larger
