"""The tiles of a group that a picture shows: elements with the shortest ways to them from tile to tile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from orbiframe import Group, UsageError
from orbiframe_drawing.polygon import DrawnPolygon

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

MOST_TILES = 20_000
# No two middles of tiles are as near; far out they are known less well than near the origin.
_SAME_PLACE = 1e-3


@dataclass(frozen=True, eq=False)
class Tiles:
    """Elements g of a group, whose tiles g F are drawn: nearest first, the identity before all.

    elements: (n, 3, 3); length: (n,), how many sides one crosses from F to g F, the word length of g in the side
    pairings; first: (n, m), by which of the m sides of F a shortest way may start.
    """

    elements: Floats
    length: Ints
    first: Bools


def tiles_within(group: Group, polygon: DrawnPolygon, radius: float) -> Tiles:
    """The tiles that meet the disc of a radius about the origin. Raises UsageError for too many."""
    if not radius >= 0:
        raise UsageError(f"a radius of {radius} was asked for; give a length that is not negative")
    estimate = disc_area(group.geometry.curvature, radius) / group.area
    if estimate > MOST_TILES:
        raise UsageError(
            f"about {estimate:.2g} tiles meet the disc of radius {radius:g}, and a picture shows at most {MOST_TILES}; "
            "take a smaller radius"
        )
    return _with_words(polygon, group.tiles(radius))


def nearest_tiles(group: Group, polygon: DrawnPolygon, count: int) -> Tiles:
    """The tiles with the nearest centres, at most so many, all or none of those at one distance."""
    if not 1 <= count <= MOST_TILES:
        raise UsageError(f"{count} tiles were asked for; a picture shows 1 to {MOST_TILES}")
    geometry = group.geometry
    radius = _radius_of_area(geometry.curvature, count * group.area)
    found = group.tiles(radius)
    distance = geometry.distance(geometry.origin, found[:, :, 0])
    # All tiles with centres within the radius are there, but not all of those beyond.
    whole = int((distance <= radius).sum())
    ends = np.append(np.flatnonzero(np.diff(distance[:whole]) > _SAME_PLACE) + 1, whole)
    return _with_words(polygon, found[: ends[ends <= count].max()])


def disc_area(curvature: int, radius: float) -> float:
    """The area of a disc in the plane of curvature 1, 0 or -1."""
    if curvature == 0:
        return float(np.pi * radius**2)
    if curvature > 0:
        return float(2 * np.pi * (1 - np.cos(min(radius, np.pi))))
    return float(2 * np.pi * (np.cosh(min(radius, 700.0)) - 1))


def _radius_of_area(curvature: int, area: float) -> float:
    if curvature == 0:
        return float(np.sqrt(area / np.pi))
    if curvature > 0:
        return float(np.pi)
    return float(np.arccosh(1 + area / (2 * np.pi)))


def _with_words(polygon: DrawnPolygon, elements: Floats) -> Tiles:
    """Lengths and first sides, by a walk from tile to tile across all sides."""
    pairings = polygon.neighbours
    length, first = np.full(len(elements), -1), np.zeros((len(elements), len(pairings)), dtype=np.bool_)
    centres = cKDTree(elements[:, :, 0])
    level, steps = np.array([0]), 0
    length[0] = 0
    while len(level):
        steps += 1
        beyond = elements[level, None] @ pairings
        gap, found = map(np.asarray, centres.query(beyond[..., 0], distance_upper_bound=_SAME_PLACE))
        rows, sides = np.nonzero(np.isfinite(gap))
        target = found[rows, sides]
        ahead = (length[target] < 0) | (length[target] == steps)
        rows, sides, target = rows[ahead], sides[ahead], target[ahead]
        length[target] = steps
        starts = np.eye(len(pairings), dtype=np.bool_)[sides] if steps == 1 else first[level[rows]]
        np.logical_or.at(first, target, starts)
        level = np.unique(target)
    return Tiles(elements, length, first)
