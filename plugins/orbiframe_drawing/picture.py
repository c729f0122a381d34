"""Picture: line drawings as plain data, in points of 1/72 inch with the second axis up, before any file format."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Bytes = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Curve:
    """A segment, a circular arc, or a chain of cubic Bezier curves in the plane.

    points: (2, 2), the ends of a segment or arc, or (3 k + 1, 2), the control points of k cubics; turn: the angle of an
    arc, positive counterclockwise, in (-2 pi, 2 pi); 0 for a segment and for cubics.
    """

    points: Floats
    turn: float = 0.0

    @property
    def centre(self) -> Floats:
        """The centre of an arc, (2,)."""
        start, end = self.points
        across = np.array([start[1] - end[1], end[0] - start[0]])
        return np.asarray((start + end) / 2 + across / (2 * np.tan(self.turn / 2)))

    @property
    def radius(self) -> float:
        """The radius of an arc; infinite for a segment."""
        chord = float(np.linalg.norm(self.points[-1] - self.points[0]))
        return chord / abs(2 * np.sin(self.turn / 2)) if self.turn else np.inf

    @property
    def reversed(self) -> Curve:
        """The same curve, run through the other way."""
        return Curve(self.points[::-1], -self.turn)

    def placed(self, scale: float, shift: Floats) -> Curve:
        """The curve scaled about the origin and moved."""
        return Curve(self.points * scale + shift, self.turn)

    def at(self, t: ArrayLike) -> Floats:
        """Points (n, 2) at parameters in [0, 1], in equal shares of the arc or of the cubics."""
        s = np.asarray(t, dtype=np.float64)
        start, end = self.points[0], self.points[-1]
        if len(self.points) > 2:
            return self._cubic(s)
        if not self.turn:
            return np.asarray(start + s[:, None] * (end - start))
        angle, arm = s * self.turn, start - self.centre
        turned = np.stack([-arm[1:] * np.sin(angle), arm[:1] * np.sin(angle)], axis=-1).reshape(-1, 2)
        return np.asarray(self.centre + np.cos(angle)[:, None] * arm + turned)

    def _cubic(self, s: Floats) -> Floats:
        count = (len(self.points) - 1) // 3
        piece = np.minimum((s * count).astype(np.intp), count - 1)
        u = (s * count - piece)[:, None]
        a, b, c, d = (self.points[3 * piece + k] for k in range(4))
        return np.asarray((1 - u) ** 3 * a + 3 * u * (1 - u) ** 2 * b + 3 * u**2 * (1 - u) * c + u**3 * d)


@dataclass(frozen=True, eq=False)
class Shape:
    """Paths of one style. Each path is a chain of curves, every one from the end of the one before.

    closed: paths are outlines; fill, stroke: colours like "#0072b2", None for none; width: of the stroke; dash: lengths
    of dashes and gaps; opacity: of fill and stroke; clip: a closed path outside which nothing is drawn, empty for none.
    """

    paths: Sequence[Sequence[Curve]]
    closed: bool = False
    fill: str | None = None
    stroke: str | None = None
    width: float = 0.7
    dash: tuple[float, ...] = ()
    opacity: float = 1.0
    clip: tuple[Curve, ...] = ()

    def placed(self, scale: float, shift: Floats) -> Shape:
        """The shape scaled about the origin and moved; widths stay."""
        paths = [[curve.placed(scale, shift) for curve in path] for path in self.paths]
        return replace(self, paths=paths, clip=tuple(curve.placed(scale, shift) for curve in self.clip))


@dataclass(frozen=True, eq=False)
class Label:
    """A text in italics with its middle at a place (2,); size: of the font in points; halo: white round the letters."""

    text: str
    place: Floats
    size: float = 11.0
    colour: str = "#000000"
    halo: bool = False

    def placed(self, scale: float, shift: Floats) -> Label:
        """The label moved; its size stays."""
        return replace(self, place=self.place * scale + shift)


@dataclass(frozen=True, eq=False)
class Raster:
    """An image of colours (h, w, 4) from the top row down, in the box (left, bottom, right, top)."""

    colours: Bytes
    box: tuple[float, float, float, float]

    def placed(self, scale: float, shift: Floats) -> Raster:
        """The image scaled about the origin and moved."""
        left, bottom, right, top = (np.reshape(self.box, (2, 2)) * scale + shift).ravel()
        return replace(self, box=(float(left), float(bottom), float(right), float(top)))


Item = Shape | Label | Raster


@dataclass(frozen=True, eq=False)
class Picture:
    """Items in the order in which they are drawn, in the box (left, bottom, right, top)."""

    items: tuple[Item, ...]
    box: tuple[float, float, float, float]

    @property
    def size(self) -> tuple[float, float]:
        """Width and height."""
        left, bottom, right, top = self.box
        return right - left, top - bottom

    @property
    def shapes(self) -> list[Shape]:
        """The items that are shapes."""
        return [item for item in self.items if isinstance(item, Shape)]

    @property
    def labels(self) -> list[Label]:
        """The items that are labels."""
        return [item for item in self.items if isinstance(item, Label)]

    def placed(self, scale: float, shift: Floats) -> Picture:
        """The picture scaled about the origin and moved; widths of lines and sizes of texts stay."""
        left, bottom, right, top = (np.reshape(self.box, (2, 2)) * scale + shift).ravel()
        items = tuple(item.placed(scale, shift) for item in self.items)
        return Picture(items, (float(left), float(bottom), float(right), float(top)))

    def padded(self, margin: float) -> Picture:
        """The same picture with a margin round it."""
        left, bottom, right, top = self.box
        return Picture(self.items, (left - margin, bottom - margin, right + margin, top + margin))


def beside(pictures: Iterable[Picture], gap: float = 18.0) -> Picture:
    """Pictures in a row from left to right, in the middle of one height."""
    given = list(pictures)
    height = max(picture.size[1] for picture in given)
    items: list[Item] = []
    right = -gap
    for picture in given:
        low = (height - picture.size[1]) / 2
        placed = picture.placed(1.0, np.array([right + gap - picture.box[0], low - picture.box[1]]))
        items.extend(placed.items)
        right = placed.box[2]
    return Picture(tuple(items), (0.0, 0.0, right, height))


def chained(curves: Iterable[Curve]) -> list[list[Curve]]:
    """Curves joined end to start into few long paths; a curve may be run through the other way."""
    given = list(curves)
    ends = [tuple(map(_spot, (curve.points[0], curve.points[-1]))) for curve in given]
    at: dict[tuple[int, int], list[int]] = {}
    for k, spots in enumerate(ends):
        for spot in spots:
            at.setdefault(spot, []).append(k)
    free, paths = [True] * len(given), []
    for first in range(len(given)):
        path, here, k = [], ends[first][0], first if free[first] else -1
        while k >= 0:
            free[k] = False
            forward = ends[k][0] == here
            path.append(given[k] if forward else given[k].reversed)
            here = ends[k][1] if forward else ends[k][0]
            k = next((other for other in at[here] if free[other]), -1)
        if path:
            paths.append(path)
    return paths


def _spot(point: Floats) -> tuple[int, int]:
    """A point to a hundredth of a point of the page, which is as fine as files are."""
    return round(100 * float(point[0])), round(100 * float(point[1]))


def circle(centre: ArrayLike, radius: float) -> tuple[Curve, Curve]:
    """A circle as two half turns."""
    middle, arm = np.asarray(centre, dtype=np.float64), np.array([radius, 0.0])
    ends = np.stack([middle + arm, middle - arm])
    return Curve(ends, np.pi), Curve(ends[::-1], np.pi)


def polyline(points: ArrayLike) -> list[Curve]:
    """Segments from point to point, (n, 2)."""
    given = np.asarray(points, dtype=np.float64)
    return [Curve(given[k : k + 2]) for k in range(len(given) - 1)]


def polygon(points: ArrayLike) -> list[Curve]:
    """The segments of a closed polygon, (n, 2)."""
    given = np.asarray(points, dtype=np.float64)
    return polyline(np.concatenate([given, given[:1]]))


def arrowhead(tip: Floats, direction: Floats, length: float, colour: str) -> Shape:
    """A filled arrowhead round a point, (2,), in the direction of a vector (2,)."""
    ahead = direction / np.linalg.norm(direction)
    aside = np.array([-ahead[1], ahead[0]])
    corners = [tip + length * (x * ahead + y * aside) for x, y in ((0.55, 0), (-0.45, 0.42), (-0.2, 0), (-0.45, -0.42))]
    return Shape([polygon(corners)], closed=True, fill=colour)
