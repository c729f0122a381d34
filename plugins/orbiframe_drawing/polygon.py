"""The polygon of a group as a polygon to draw: corners, and the letters of its sides with their arrows."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from orbiframe import Geometry, GeometryError, Group
from orbiframe.groups import PolygonGroup

Floats = NDArray[np.float64]

# The side of the letter F, which no isometry but the identity brings back: corners in a box from -1 to 1, and scale.
_MOTIF = np.array([(-4, -6), (-2, -6), (-2, -1), (2, -1), (2, 1), (-2, 1), (-2, 4), (4, 4), (4, 6), (-4, 6)]) / 6
_MOTIF_SIZE, _LARGEST_MOTIF = 0.34, 1.0
_ON_SIDE = 1e-7


@dataclass(frozen=True, eq=False)
class DrawnPolygon:
    """A polygon with geodesic sides: the fundamental polygon F of a group.

    corners: (n, 3), counterclockwise; letters: the letter of every side from corner k to corner k + 1, negative where
    its arrow runs clockwise; neighbours: (n, 3, 3), the element whose tile is on the other side of each; pieces: how
    many sides each letter takes up, more than one where a side is half of a great circle or a whole one; named: whether
    the letters are those of the word of the group, and are shown.
    """

    geometry: Geometry
    corners: Floats
    letters: tuple[int, ...]
    neighbours: Floats
    pieces: int = 1
    named: bool = True

    @cached_property
    def sides(self) -> Floats:
        """The pieces of the sides, [side, piece, end, coordinate]."""
        ends = np.stack([self.corners, np.roll(self.corners, -1, axis=0)], axis=1)
        return ends.reshape(len(self.letters), self.pieces, 2, 3)

    @property
    def mirrors(self) -> tuple[bool, ...]:
        """Which sides are mirrors: their letters occur once, and orientation is reversed across them."""
        count = Counter(map(abs, self.letters))
        reverses = self.geometry.parity(self.neighbours) < 0
        return tuple(bool(r) and count[abs(x)] == 1 for x, r in zip(self.letters, reverses, strict=True))

    @cached_property
    def middles(self) -> Floats:
        """The middle of every side, (n, 3)."""
        start, end = self.sides[:, 0, 0], self.sides[:, -1, 1]
        return self.geometry.project(start + end) if self.pieces == 1 else self.sides[:, self.pieces // 2, 0]

    @cached_property
    def circumradius(self) -> float:
        """The largest distance of a corner from the origin."""
        return float(self.geometry.distance(self.geometry.origin, self.corners).max())

    @cached_property
    def motif(self) -> Floats:
        """The corners (10, 3) of a letter F in the middle of the polygon."""
        near = self.geometry.distance(self.geometry.origin, np.concatenate([self.corners, self.middles]))
        size = _MOTIF_SIZE * min(float(near.min()), _LARGEST_MOTIF)
        return self.geometry.from_polar(size * np.hypot(*_MOTIF.T), np.arctan2(_MOTIF[:, 1], _MOTIF[:, 0]))


def polygon_of(group: Group) -> DrawnPolygon:
    """The fundamental polygon of a group; on the sphere also a lune, or half of it with a great circle for its side.

    Raises GeometryError for the trivial group, whose polygon is the whole sphere, and for groups without a polygon.
    """
    if isinstance(group, PolygonGroup):
        return DrawnPolygon(group.geometry, group.polygon.vertices, group.word.letters, group.polygon.pairings)
    elements = group.atlas().isometry[1:]
    if group.geometry.curvature < 1:
        raise GeometryError(f"the group of '{group.word}' has no polygon to draw; use a PolygonGroup")
    if not len(elements):
        raise GeometryError(
            f"the group of '{group.word}' has no polygon to draw: its polygon is the whole sphere; draw another group, "
            "such as that of abAB"
        )
    return _spherical_polygon(group, elements)


def _spherical_polygon(group: Group, elements: Floats) -> DrawnPolygon:
    """The polygon of the points of the sphere that are nearer to the origin than to all its images."""
    geometry = group.geometry
    sides = geometry.origin - elements[:, :, 0]
    sides /= np.linalg.norm(sides, axis=1, keepdims=True)
    if len(elements) == 1:
        return _half_sphere(group, elements, sides[0])
    corners = _corners(sides)
    if len(corners) == 2:
        return _lune(geometry, elements, sides, corners)
    corners = corners[np.argsort(np.arctan2(corners[:, 2], corners[:, 1]))]
    ends = np.abs(corners @ sides.T) < _ON_SIDE
    across = (ends & np.roll(ends, -1, axis=0)).argmax(axis=1)
    return DrawnPolygon(geometry, corners, _numbered(elements[across]), elements[across], named=False)


def _corners(sides: Floats) -> Floats:
    """The points on two sides and beyond none, (k, 3)."""
    first, second = np.triu_indices(len(sides), 1)
    meets = np.cross(sides[first], sides[second])
    size = np.linalg.norm(meets, axis=1, keepdims=True)
    meets = (meets / np.where(size > _ON_SIDE, size, 1.0))[size[:, 0] > _ON_SIDE]
    found = np.concatenate([meets, -meets])
    found = found[(found @ sides.T > -_ON_SIDE).all(axis=1)]
    return found[np.unique(np.round(found / _ON_SIDE), axis=0, return_index=True)[1]]


def _half_sphere(group: Group, elements: Floats, side: Floats) -> DrawnPolygon:
    """A half, whose border is one mirror, or two sides that the antipodal map glues."""
    turn = group.geometry.carry(side)
    quarters = turn @ group.geometry.from_polar(np.pi / 2, np.pi / 2 * np.arange(4)).T
    if np.allclose(elements[0], -np.eye(3)):
        return DrawnPolygon(group.geometry, quarters.T, (1, 1), elements[[0, 0]], pieces=2)
    return DrawnPolygon(group.geometry, quarters.T, (1,), elements, pieces=4, named=False)


def _lune(geometry: Geometry, elements: Floats, sides: Floats, corners: Floats) -> DrawnPolygon:
    """Two half great circles between antipodal points; their middles lie on the great circle between the two."""
    start, end = corners
    middles = np.cross(sides, start)
    middles *= np.sign(middles @ geometry.origin)[:, None]
    inside = (middles @ sides.T > -_ON_SIDE).all(axis=1)
    across = np.flatnonzero(inside)
    # Counterclockwise about the origin: start, the middle to the right of it, end, the other middle.
    turns = np.cross(start, middles[across]) @ geometry.origin
    across = across[np.argsort(-turns)][[0, -1]]
    ring = np.stack([start, middles[across[0]], end, middles[across[1]]])
    return DrawnPolygon(geometry, ring, _numbered(elements[across]), elements[across], pieces=2, named=False)


def _numbered(elements: Floats) -> tuple[int, ...]:
    """Numbers from 1 on for elements, alike for those that are inverse to one another."""
    inverse = np.swapaxes(elements, 1, 2)
    pairs = np.abs(elements[:, None] - inverse).max(axis=(2, 3)) < _ON_SIDE
    mate = np.where(pairs.any(axis=1), pairs.argmax(axis=1), np.arange(len(elements)))
    return tuple((np.minimum(mate, np.arange(len(elements))) + 1).tolist())
