"""Page: a model of X at the size of a picture, in points about the middle of the window."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from orbiframe_drawing.models import Model
from orbiframe_drawing.picture import Curve, Item, Picture, Shape, polygon

Floats = NDArray[np.float64]

WIDTH = 400.0  # of the window, in points
MARGIN = 4.0
_SAMPLES = np.linspace(0, 1, 25)


@dataclass(frozen=True, eq=False)
class Page:
    """Where points of X and their geodesics come to lie on a page.

    model; half_width: of a square window, in units of the model, for those that fill the plane; width: of the window.
    """

    model: Model
    half_width: float
    width: float = WIDTH

    @cached_property
    def _box(self) -> tuple[Floats, float]:
        """The middle of what the window shows, and half its width, in units of the model."""
        boundary = self.model.boundary()
        if not boundary:
            return np.zeros(2), self.half_width
        points = np.concatenate([curve.at(_SAMPLES) for curve in boundary])
        low, high = points.min(axis=0), points.max(axis=0)
        return (low + high) / 2, float((high - low).max()) / 2

    @property
    def scale(self) -> float:
        """Points of the page for a unit of the model."""
        return self.width / 2 / self._box[1]

    @cached_property
    def window(self) -> tuple[Curve, ...]:
        """What is clipped to: the boundary of the model, or a square."""
        square = self.width / 2 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        return tuple(map(self.on_page, self.model.boundary())) or tuple(polygon(square))

    def on_page(self, curve: Curve) -> Curve:
        """A curve of the model on the page."""
        return curve.placed(self.scale, -self.scale * self._box[0])

    def place(self, x: Floats) -> Floats:
        """The places (..., 2) of points (..., 3) of X."""
        return np.asarray((self.model.place(x) - self._box[0]) * self.scale)

    def points(self, p: Floats) -> Floats:
        """The points (n, 3) of X at places (n, 2) of the page; nan where there is none."""
        return self.model.points(p / self.scale + self._box[0])

    def paths(self, corners: Floats, closed: bool = True) -> list[list[Curve]]:
        """What is seen of polygons (n, m, 3) with geodesic sides, or of chains of geodesics."""
        return [[self.on_page(curve) for curve in path] for path in self.model.paths(corners, closed)]

    def picture(self, items: Iterable[Item]) -> Picture:
        """A picture of the items, without shapes that have no path."""
        half = self.width / 2 + MARGIN
        heights = np.concatenate([curve.at(_SAMPLES)[:, 1] for curve in self.window])
        low, high = float(heights.min()) - MARGIN, float(heights.max()) + MARGIN
        kept = tuple(item for item in items if not isinstance(item, Shape) or len(item.paths))
        return Picture(kept, (-half, low, half, high))
