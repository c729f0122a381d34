"""Pictures as SVG text, with circular arcs as arcs; the same picture gives the same bytes."""

from __future__ import annotations

import base64
import struct
import zlib
from collections.abc import Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from orbiframe_drawing.picture import Curve, Item, Label, Picture, Raster, Shape

Floats = NDArray[np.float64]

# In points: coordinates are rounded to this many decimals, and flatter arcs than this become segments.
_DECIMALS = 2
_FLAT = 0.03


def svg_text(picture: Picture) -> str:
    """The picture as one SVG document."""
    left, _, _, top = picture.box
    # The second axis of a page goes down.
    page = _Page(np.array([left, top]))
    width, height = (_number(length) for length in picture.size)
    body = [page.item(item) for item in picture.items]
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}pt" height="{height}pt" '
        f'viewBox="0 0 {width} {height}" stroke-linejoin="round" stroke-linecap="round">'
    )
    clips = [f'<clipPath id="clip{n}"><path d="{data}"/></clipPath>' for data, n in page.clips.items()]
    defined = [f"<defs>{''.join(clips)}</defs>"] if clips else []
    paper = f'<rect width="{width}" height="{height}" fill="#fff"/>'
    return "\n".join([head, *defined, paper, *body, "</svg>", ""])


class _Page:
    """The coordinates of a page, and the clip paths that its items use."""

    def __init__(self, corner: Floats) -> None:
        self.corner = corner
        self.clips: dict[str, int] = {}

    def item(self, item: Item) -> str:
        if isinstance(item, Shape):
            return self._shape(item)
        return self._label(item) if isinstance(item, Label) else self._raster(item)

    def _shape(self, shape: Shape) -> str:
        style = [f'fill="{shape.fill or "none"}"']
        if shape.stroke:
            style.append(f'stroke="{shape.stroke}" stroke-width="{_number(shape.width)}"')
        if shape.dash:
            style.append(f'stroke-dasharray="{" ".join(map(_number, shape.dash))}"')
        if shape.opacity < 1:
            style.append(f'opacity="{_number(shape.opacity)}"')
        if shape.clip:
            number = self.clips.setdefault(self._path(shape.clip, True), len(self.clips))
            style.append(f'clip-path="url(#clip{number})"')
        data = "".join(self._path(path, shape.closed) for path in shape.paths)
        return f'<path {" ".join(style)} d="{data}"/>'

    def _label(self, label: Label) -> str:
        x, y = self._down(label.place)
        halo = ' stroke="#fff" stroke-width="3" paint-order="stroke"' if label.halo else ""
        return (
            f'<text x="{_number(x)}" y="{_number(y + 0.33 * label.size)}" font-size="{_number(label.size)}" '
            f'font-family="DejaVu Serif, Times New Roman, serif" font-style="italic" text-anchor="middle" '
            f'fill="{label.colour}"{halo}>{escape(label.text)}</text>'
        )

    def _raster(self, raster: Raster) -> str:
        left, bottom, right, top = raster.box
        x, y = self._down(np.array([left, top]))
        data = base64.b64encode(_png(raster.colours)).decode("ascii")
        return (
            f'<image x="{_number(x)}" y="{_number(y)}" width="{_number(right - left)}" '
            f'height="{_number(top - bottom)}" href="data:image/png;base64,{data}"/>'
        )

    def _path(self, path: Sequence[Curve], closed: bool) -> str:
        """Relative commands, from rounded point to rounded point, so that rounding does not add up."""
        here = np.round(self._down(path[0].points[0]), _DECIMALS)
        parts = ["M" + _pair(here)]
        for curve in path:
            stops = np.round(self._down(curve.points), _DECIMALS)
            parts.append(_command(curve, here, stops))
            here = stops[-1]
        return "".join(parts) + ("z" if closed else "")

    def _down(self, points: Floats) -> Floats:
        return np.asarray((points - self.corner) * [1.0, -1.0])


def _command(curve: Curve, here: Floats, stops: Floats) -> str:
    step = stops[-1] - here
    if len(stops) > 2:
        return "c" + " ".join(_pair(stop - base) for stop, base in _relative(here, stops))
    if curve.turn and curve.radius * (1 - np.cos(curve.turn / 2)) > _FLAT:
        radius = _number(curve.radius)
        large, sweep = int(abs(curve.turn) > np.pi), int(curve.turn < 0)
        return f"a{radius} {radius} 0 {large} {sweep} {_pair(step)}"
    return "l" + _pair(step)


def _relative(here: Floats, stops: Floats) -> list[tuple[Floats, Floats]]:
    """The control points of cubics, each with the point from which it counts: the start of its cubic."""
    stops = np.concatenate([here[None], stops[1:]])
    return [(stops[k], stops[3 * ((k - 1) // 3)]) for k in range(1, len(stops))]


def _pair(point: Floats) -> str:
    x, y = _number(point[0]), _number(point[1])
    return x + y if y.startswith("-") else f"{x} {y}"


def _number(value: float) -> str:
    text = f"{value:.{_DECIMALS}f}".rstrip("0").rstrip(".")
    text = text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text
    return "0" if text in ("-0", "-", "") else text


def _png(colours: NDArray[np.uint8]) -> bytes:
    """An image with transparency as PNG, every row as the difference from the row above, without dates."""
    height, width, _ = colours.shape
    above = np.concatenate([np.zeros_like(colours[:1]), colours[:-1]])
    rows = np.concatenate([np.full((height, 1), 2, np.uint8), (colours - above).reshape(height, -1)], axis=1)
    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    chunks = [(b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes(), 9)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in chunks)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
