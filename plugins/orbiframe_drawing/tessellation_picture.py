"""The picture of a tessellation: one lift of every face dark, its copies under the group light."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from orbiframe import UsageError
from orbiframe.triangulations import FaceCopies, Tessellation
from orbiframe_drawing.colours import GREY, INK, line_colour, tint
from orbiframe_drawing.models import Model, model_of
from orbiframe_drawing.page import WIDTH, Page
from orbiframe_drawing.picture import Item, Picture, Shape, chained
from orbiframe_drawing.tiles import disc_area

Floats = NDArray[np.float64]

_DARK, _TINT = line_colour(1), 0.13
# Shorter edges, in points, are left out far away, and a picture has about so many at most.
_SHORTEST, _MOST_EDGES = 1.3, 6000
_FAR_TOO_MANY = 500_000
# Widths of lines, in points, for edges of at least these lengths on the page.
_WIDTHS = ((14.0, 0.55), (7.0, 0.4), (3.0, 0.28), (0.0, 0.18))
_HOME_WIDTH = 0.8


def tessellation_picture(
    tessellation: Tessellation,
    *,
    model: str | None = None,
    radius: float | None = None,
    patch: int = 0,
    centre: Floats | None = None,
    width: float = WIDTH,
) -> Picture:
    """The lifts of the faces to X, those nearest to the middle dark: one of every face.

    model: projective, conformal (the default), hyperboloid, or sphere (the default for S^2); radius: of the disc that
    is filled, by default as far as edges can be told apart; patch, centre: the point of X/H in the middle of the
    picture, see `Tessellation.copies`. Edges are geodesics, whatever runs between their ends on the polyhedron.
    """
    chosen = model_of(tessellation.geometry, model)
    if radius is not None:
        _require_few(tessellation, radius)
    copies = list(tessellation.copies(_radius(tessellation) if radius is None else radius, patch, centre))
    return _TessellationPicture(copies, chosen, _half_width(copies, chosen), width).picture()


def _radius(tessellation: Tessellation) -> float:
    """As far as edges are not too short to be told apart, nor too many."""
    curvature, area = tessellation.geometry.curvature, tessellation.orbifold.area
    if curvature > 0:
        return float(np.pi)
    periods = max(_MOST_EDGES / tessellation.edge_count, 3.0)
    if curvature == 0:
        return float(1.5 * np.sqrt(min(periods, 12.0) * area))
    # A length l at the distance d has about WIDTH / 4 / cosh(d / 2)^2 times l on the page.
    told = np.arccosh(max(np.sqrt(WIDTH / 4 * tessellation.edge_length / _SHORTEST), 1.0)) * 2
    return float(max(min(told, np.arccosh(1 + periods * area / (2 * np.pi))), np.arccosh(1 + 3 * area / (2 * np.pi))))


def _require_few(tessellation: Tessellation, radius: float) -> None:
    edges = disc_area(tessellation.geometry.curvature, radius) / tessellation.orbifold.area * tessellation.edge_count
    if not 0 <= edges <= _FAR_TOO_MANY or not radius >= 0:
        raise UsageError(
            f"about {edges:.2g} edges lie in the disc of radius {radius:g}, and a picture shows at most "
            f"{_FAR_TOO_MANY}; take another radius"
        )


def _half_width(copies: list[FaceCopies], model: Model) -> float:
    """Half the width of a window round the dark faces and as much again, for models that fill the plane."""
    dark = np.concatenate([model.place(c.corners[c.home]).reshape(-1, 2) for c in copies])
    return 1.4 * float(np.abs(dark).max())


@dataclass(frozen=True, eq=False)
class _TessellationPicture:
    copies: list[FaceCopies]
    model: Model
    half_width: float
    width: float

    def picture(self) -> Picture:
        """The items in the order of drawing."""
        return self.page.picture([*self._faces(), *self._far_edges(), *self._home_edges(), *self._rim()])

    @cached_property
    def page(self) -> Page:
        return Page(self.model, self.half_width, self.width)

    def _faces(self) -> Iterator[Item]:
        paths = [path for c in self.copies for path in self.page.paths(c.corners[c.home])]
        yield Shape(paths, True, tint(_DARK, _TINT), clip=self.page.window)

    def _far_edges(self) -> Iterator[Item]:
        """The edges of the other copies, each once, the longer ones thicker."""
        ends = self._edges(home=False)
        at = self.page.place(ends)
        length = np.linalg.norm(at[:, 1] - at[:, 0], axis=1)
        seen = (np.abs(at).max(axis=2) <= self.width / 2).any(axis=1)
        above = np.inf
        for least, width in _WIDTHS:
            chosen = seen & (length >= max(least, _SHORTEST)) & (length < above)
            above = least
            yield self._lines(ends[chosen], GREY, width)

    def _home_edges(self) -> Iterator[Item]:
        yield self._lines(self._edges(home=True), _DARK, _HOME_WIDTH)

    def _lines(self, ends: Floats, colour: str, width: float) -> Shape:
        """Geodesics between points (n, 2, 3) in long strokes."""
        curves = [curve for path in self.page.paths(ends, closed=False) for curve in path]
        return Shape(chained(curves), stroke=colour, width=width, clip=self.page.window)

    def _edges(self, home: bool) -> Floats:
        """The edges of the copies at home or of the others, each once, (k, 2, 3)."""
        found = [np.stack([x, np.roll(x, -1, axis=1)], axis=2).reshape(-1, 2, 3) for x in self._corners(home)]
        ends = np.concatenate(found)
        middle = np.round(self.page.place(ends.sum(axis=1) / 2), 2)
        return ends[np.unique(middle, axis=0, return_index=True)[1]]

    def _corners(self, home: bool) -> list[Floats]:
        return [c.corners[c.home == home] for c in self.copies]

    def _rim(self) -> Iterator[Item]:
        yield Shape([self.page.window], True, stroke=INK, width=0.9)
