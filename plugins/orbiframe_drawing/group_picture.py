"""The picture of a group: its tiles coloured by element, and the fundamental polygon with labelled sides."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import Group, UsageError
from orbiframe.words import text_of
from orbiframe_drawing.colours import GREY, INK, PAPER, line_colour, mixed, tint
from orbiframe_drawing.file import require_picture_file, save_picture
from orbiframe_drawing.function_image import Function, function_image
from orbiframe_drawing.models import Chart, Model, Solid, model_of
from orbiframe_drawing.page import WIDTH, Page
from orbiframe_drawing.picture import Curve, Item, Label, Picture, Shape, arrowhead, chained, circle
from orbiframe_drawing.polygon import DrawnPolygon, polygon_of
from orbiframe_drawing.tiles import Tiles, nearest_tiles, tiles_within

Floats = NDArray[np.float64]

# Half of a window in E^2 in circumradii of F; tiles of H^2 are drawn from this size in points on, so many of them.
_WINDOW, _SMALLEST, _COUNTS = 2.2, 4.0, (450, 1800)
_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
# Widths of lines go with the square root of the size of a tile on the page, from the thickest, of large tiles, on.
_LARGE, _THICK, _THIN, _CLASSES = 120.0, 1.0, 0.12, 6
_DOT = 2.4  # radius of a point in F
# Tints of tiles, stronger for odd lengths, and how fast they fade with the length.
_TINTS, _FADE = (0.30, 0.52), 0.93
# The hyperboloid is cut off so many times as high as the corners of F are.
_RIM = 1.3
_MOTIF_LEAST = 9.0  # points; smaller tiles show no motif


def draw_group(
    path: str | Path,
    group: Group,
    *,
    model: str | None = None,
    radius: float | None = None,
    tiles: int | None = None,
    motif: bool | None = None,
    function: Function | None = None,
    points: Floats | None = None,
) -> None:
    """Write the picture of a group to a .svg, .png or .pdf file; for the options see `group_picture`.

    model, radius or tiles, motif, function, points: what is drawn. Raises UsageError for another suffix, FormatError
    for a file that cannot be written.
    """
    require_picture_file(Path(path))
    picture = group_picture(
        group, model=model, radius=radius, tiles=tiles, motif=motif, function=function, points=points
    )
    save_picture(picture, path)


def group_picture(
    group: Group,
    *,
    model: str | None = None,
    radius: float | None = None,
    tiles: int | None = None,
    motif: bool | None = None,
    function: Function | None = None,
    points: Floats | None = None,
) -> Picture:
    """The tiling of X by a group, with the labelled fundamental polygon in the middle.

    A tile has the colour of the side of F that one crosses first on a shortest way to it, the mean where there is a
    choice, in a stronger and a weaker tint for odd and even lengths of the way. Sides that are glued have one colour
    and one letter, and arrows that are laid upon one another.

    model: projective, conformal (the default), hyperboloid, or sphere (the default for S^2); radius: draw the tiles
    that meet this disc about the origin, or tiles: at most so many, the nearest; motif: a letter F in every tile shows
    which elements reverse orientation, by default where there are some; function: values (n,) of an invariant function
    at points (n, 3) of X, drawn as colours instead of those of the tiles; points: (k, 3) of X,
    drawn with their images in all tiles.

    Raises UsageError for a model that the geometry has not, and for too many tiles.
    """
    if radius is not None and tiles is not None:
        raise UsageError("a radius and a number of tiles are given; give one of them")
    polygon, chosen = polygon_of(group), model_of(group.geometry, model)
    # Where all tiles beside one another are mirror images, the two tints show it.
    reverses = not group.word.orientable and not any(polygon.mirrors)
    with_motif = (reverses and function is None) if motif is None else motif
    if isinstance(chosen, Solid):
        chosen = replace(chosen, height=_RIM * float(np.cosh(polygon.circumradius)))
    if radius is not None:
        shown = tiles_within(group, polygon, radius)
    elif tiles is None and isinstance(chosen, Solid) and group.geometry.curvature < 0:
        shown = tiles_within(group, polygon, float(np.arccosh(chosen.height)))
    else:
        shown = _default_tiles(group, polygon) if tiles is None else nearest_tiles(group, polygon, tiles)
    return GroupPicture(polygon, shown, chosen, with_motif, function, points).picture()


def _default_tiles(group: Group, polygon: DrawnPolygon) -> Tiles:
    """As many as fill the window, or in H^2 as far as tiles can be told apart."""
    curvature, radius = group.geometry.curvature, polygon.circumradius
    if curvature == 0:
        return tiles_within(group, polygon, np.sqrt(2) * _WINDOW * radius)
    if curvature > 0:
        return tiles_within(group, polygon, np.pi)
    # A tile at the distance d has about WIDTH / 2 / cosh(d / 2)^2 times its circumradius on the page.
    far = 2 * np.arccosh(np.sqrt(max(WIDTH / 2 * radius / _SMALLEST, 1.0)))
    count = 2 * np.pi * (np.cosh(far) - 1) / group.area
    return nearest_tiles(group, polygon, int(np.clip(count, *_COUNTS)))


@dataclass(frozen=True, eq=False)
class GroupPicture:
    """What the picture of a group is made of."""

    polygon: DrawnPolygon
    tiles: Tiles
    model: Model
    motif: bool = False
    function: Function | None = None
    points: Floats | None = None

    def picture(self) -> Picture:
        """The items in the order of drawing."""
        return self.page.picture(
            [*self._background(), *self._tiles(), *self._sides(), *self._rim(), *self._orbits(), *self._labels()]
        )

    @cached_property
    def page(self) -> Page:
        """The model on the page."""
        return Page(self.model, _WINDOW * float(np.linalg.norm(self.model.place(self.polygon.corners), axis=1).max()))

    def _background(self) -> Iterator[Item]:
        if self.function is not None:
            yield function_image(self.function, self.page.points, self.page.width / 2)

    @cached_property
    def _corners(self) -> Floats:
        """The corners of all tiles, (n, m, 3)."""
        return np.asarray(np.einsum("kij,mj->kmi", self.tiles.elements, self.polygon.corners))

    @cached_property
    def _sizes(self) -> Floats:
        """The extent of every tile on the page, in points."""
        at = self.page.place(self._corners)
        return np.asarray((at.max(axis=1) - at.min(axis=1)).max(axis=1))

    @cached_property
    def _widths(self) -> Floats:
        """The width of the lines of every tile, of few different ones."""
        share = np.sqrt(np.minimum(self._sizes / _LARGE, 1.0))
        steps = np.round(share * _CLASSES) / _CLASSES
        return np.asarray(np.maximum(_THICK * steps, _THIN))

    def _tiles(self) -> Iterator[Item]:
        fills = [self._fill(k) for k in range(len(self._corners))]
        styles = list(zip(fills, self._widths.tolist(), strict=True))
        for fill, width in sorted(set(styles), key=lambda style: (-style[1], style[0])):
            chosen = [k for k, style in enumerate(styles) if style == (fill, width)]
            shade = None if self.function is not None else fill
            paths = self.page.paths(self._corners[chosen])
            yield Shape(paths, True, shade, INK, width, clip=self.page.window)
        if self.motif:
            elements = self.tiles.elements[self._sizes > _MOTIF_LEAST]
            motifs = np.einsum("kij,mj->kmi", elements, self.polygon.motif)
            whole = [np.array_equal(self.model.front(motif, True), motif) for motif in motifs]
            yield Shape(self.page.paths(motifs[whole]), True, fill=INK, opacity=0.55, clip=self.page.window)

    def _fill(self, tile: int) -> str:
        """Paper for F; the colours of the first sides for the others, stronger and weaker in turn."""
        length, first = int(self.tiles.length[tile]), np.flatnonzero(self.tiles.first[tile])
        if length == 0:
            return PAPER
        colour = mixed([line_colour(abs(self.polygon.letters[side])) for side in first])
        return tint(colour, _TINTS[length % 2] * _FADE**length)

    def _sides(self) -> Iterator[Item]:
        """The sides of F, thick and in the colours of their letters, with arrows but on mirrors."""
        for letter, pieces, mirror in zip(self.polygon.letters, self.polygon.sides, self.polygon.mirrors, strict=True):
            curves = chained(curve for path in self.page.paths(pieces, closed=False) for curve in path)
            yield Shape(curves, stroke="#ffffff", width=4.2)
            yield Shape(curves, stroke=self._colour(letter), width=2.4)
            if curves and self.polygon.named and not mirror:
                yield self._arrow(curves[0], letter)
        # A whole great circle has no corner: its pieces only make it up.
        ends = (
            self.polygon.corners[:: self.polygon.pieces] if len(self.polygon.letters) > 1 else self.polygon.corners[:0]
        )
        corners = [x for x in ends if len(self.model.front(x[None], False))]
        dots = [circle(self.page.place(corner), 2.2) for corner in corners]
        yield Shape(dots, True, fill=INK)

    def _colour(self, letter: int) -> str:
        """The colour of a side; none of its own over a function."""
        return line_colour(abs(letter)) if self.function is None else INK

    def _arrow(self, side: list[Curve], letter: int) -> Shape:
        """The arrow of a side; on the hyperboloid away from the middle, where a side turns sharply."""
        way = side[len(side) // 2]
        at = 0.0 if len(side) % 2 == 0 else 0.5
        if isinstance(self.model, Solid) and self.polygon.geometry.curvature < 0:
            at = 0.34 if letter > 0 else 0.66
        before, after = way.at([max(at - 1e-3, 0.0), at + 1e-3])
        tip = way.at([at])[0]
        return arrowhead(tip, float(np.sign(letter)) * (after - before), self._letter_size, self._colour(letter))

    @cached_property
    def _letter_size(self) -> float:
        """The size of letters, smaller where a polygon has many sides."""
        corners = self.page.place(self.polygon.corners)
        side = float(np.linalg.norm(corners - np.roll(corners, -1, axis=0), axis=1).min())
        return float(np.clip(side / 4, 7.0, 14.0))

    def _rim(self) -> Iterator[Item]:
        if self.model.boundary():
            yield Shape([self.page.window], True, stroke=INK, width=1.0)
            if isinstance(self.model, Solid) and self.polygon.geometry.curvature < 0:
                heights = np.cosh(np.arange(1.0, np.arccosh(self.model.height)))
                levels = [[self.page.on_page(self.model.level(float(height)))] for height in heights]
                yield Shape(levels, stroke=GREY, width=0.4, dash=(2.0, 2.5))
        elif isinstance(self.model, Chart):
            yield Shape([self.page.window], True, stroke=INK, width=0.6)

    def _orbits(self) -> Iterator[Item]:
        """The images of the points, as dots that shrink with the tiles."""
        given = np.zeros((0, 3)) if self.points is None else self.points
        size = np.maximum(_DOT * np.minimum(self._sizes / self._sizes[0], 1.0), _THIN)
        images = np.einsum("kij,mj->kmi", self.tiles.elements, given)
        seen = [[x for x in row if len(self.model.front(x[None], False))] for row in images]
        dots = [circle(self.page.place(x), r) for row, r in zip(seen, size, strict=True) for x in row]
        yield Shape(dots, True, fill=INK, clip=self.page.window)

    def _labels(self) -> Iterator[Item]:
        """Letters inside F, beside the middles of their sides."""
        centre = self.page.place(self.polygon.geometry.origin)
        for letter, middle in zip(self.polygon.letters, self.polygon.middles, strict=True):
            if not self.polygon.named or not len(self.model.front(middle[None], False)):
                continue
            at = self.page.place(middle)
            inward = (centre - at) / np.linalg.norm(centre - at)
            size = self._letter_size
            name = text_of(abs(letter)).translate(_SUBSCRIPTS)
            yield Label(name, at + 1.15 * size * inward, size, self._colour(letter), halo=self.function is not None)
