"""The cell of a group as a polygon to draw: corners, and the letters of its sides with their arrows."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import GeometryError
from orbiframe.geometry import Geometry
from orbiframe.group import Group
from orbiframe.polygon_group import PolygonGroup

Floats = NDArray[np.float64]

# The side of the letter F, which no isometry but the identity brings back: corners in a box from -1 to 1, and scale.
_MOTIF = np.array([(-4, -6), (-2, -6), (-2, -1), (2, -1), (2, 1), (-2, 1), (-2, 4), (4, 4), (4, 6), (-4, 6)]) / 6
_MOTIF_SIZE, _LARGEST_MOTIF = 0.34, 1.0


@dataclass(frozen=True, eq=False)
class Cell:
    """A polygon with geodesic sides: the fundamental polygon F of a group.

    corners: (n, 3), counterclockwise; letters: the letter of every side from corner k to corner k + 1, negative where
    its arrow runs clockwise; pieces: how many sides each letter takes up, more than one where a side is half of a great
    circle.
    """

    geometry: Geometry
    corners: Floats
    letters: tuple[int, ...]
    pieces: int = 1

    @cached_property
    def sides(self) -> Floats:
        """The pieces of the sides, [side, piece, end, coordinate]."""
        ends = np.stack([self.corners, np.roll(self.corners, -1, axis=0)], axis=1)
        return ends.reshape(len(self.letters), self.pieces, 2, 3)

    @property
    def mirrors(self) -> tuple[bool, ...]:
        """Which sides are mirrors: their letters occur once."""
        count = Counter(map(abs, self.letters))
        return tuple(count[abs(letter)] == 1 for letter in self.letters)

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
        """The corners (10, 3) of a letter F in the middle of the cell."""
        near = self.geometry.distance(self.geometry.origin, np.concatenate([self.corners, self.middles]))
        size = _MOTIF_SIZE * min(float(near.min()), _LARGEST_MOTIF)
        return self.geometry.from_polar(size * np.hypot(*_MOTIF.T), np.arctan2(_MOTIF[:, 1], _MOTIF[:, 0]))


def cell_of(group: Group) -> Cell:
    """The fundamental polygon of a group, or half the sphere as a polygon whose two sides are half circles.

    Raises GeometryError for the trivial group, whose cell is the whole sphere, and for groups without a polygon.
    """
    if isinstance(group, PolygonGroup):
        return Cell(group.geometry, group.polygon.vertices, group.word.letters)
    if group.geometry.curvature > 0 and not group.word.orientable:
        quarter = group.geometry.from_polar(np.pi / 2, np.pi / 2 * np.arange(4))
        return Cell(group.geometry, quarter, group.word.standard.letters, pieces=2)
    raise GeometryError(
        f"the group of '{group.word}' has no polygon to draw: its cell is the whole sphere; draw another group, such "
        "as that of abAB"
        if group.geometry.curvature > 0
        else f"the group of '{group.word}' has no polygon to draw; use a PolygonGroup"
    )
