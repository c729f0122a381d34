"""Pictures as PNG and PDF, by matplotlib."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import PluginError
from orbiframe_drawing.picture import Curve, Item, Label, Picture, Shape

Floats = NDArray[np.float64]

_RESOLUTION = 132  # dots per inch
_COLOURS = 128
# An arc becomes cubics of at most this angle; they are within 4e-6 of its radius.
_STEP = np.pi / 4
_MOVE, _LINE, _CUBIC, _CLOSE = 1, 2, 4, 79


def png_bytes(picture: Picture) -> bytes:
    """The picture as PNG with a palette, which makes small files of line drawings."""
    figure = _figure(picture)
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    canvas: Any = FigureCanvasAgg(figure)
    canvas.draw()
    image = Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy())
    file = io.BytesIO()
    image.quantize(_COLOURS, dither=Image.Dither.NONE).save(file, "png", optimize=True)
    return file.getvalue()


def pdf_bytes(picture: Picture) -> bytes:
    """The picture as PDF, without a date."""
    figure = _figure(picture)
    file = io.BytesIO()
    figure.savefig(file, format="pdf", metadata={"CreationDate": None, "Producer": None, "Creator": None})
    return file.getvalue()


def _figure(picture: Picture) -> Any:
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise PluginError(
            "PNG and PDF need matplotlib: run `pip install 'orbiframe[pictures]'`, or name a file with .svg"
        ) from error
    width, height = picture.size
    figure = Figure(figsize=(width / 72, height / 72), dpi=_RESOLUTION, facecolor="white")
    axes = figure.add_axes((0, 0, 1, 1))
    left, bottom, right, top = picture.box
    axes.set(xlim=(left, right), ylim=(bottom, top))
    axes.axis("off")
    for order, item in enumerate(picture.items):
        _add(axes, item, order)
    # Images would set the limits anew.
    axes.set(xlim=(left, right), ylim=(bottom, top))
    return figure


def _add(axes: Any, item: Item, order: int) -> None:
    if isinstance(item, Shape):
        _add_shape(axes, item, order)
    elif isinstance(item, Label):
        style = {"family": ["DejaVu Serif"], "style": "italic", "ha": "center", "va": "center_baseline"}
        text = axes.text(*item.place, item.text, fontsize=item.size, color=item.colour, zorder=order, **style)
        if item.halo:
            from matplotlib.patheffects import withStroke

            text.set_path_effects([withStroke(linewidth=3, foreground="white")])
    else:
        left, bottom, right, top = item.box
        axes.imshow(
            item.colours, extent=(left, right, bottom, top), zorder=order, interpolation="antialiased", aspect="auto"
        )


def _add_shape(axes: Any, shape: Shape, order: int) -> None:
    from matplotlib.patches import PathPatch

    patch = PathPatch(
        _path(shape.paths, shape.closed),
        facecolor=shape.fill or "none",
        edgecolor=shape.stroke or "none",
        linewidth=shape.width if shape.stroke else 0,
        # matplotlib counts dashes in widths of the line.
        linestyle=(0, tuple(length / shape.width for length in shape.dash)) if shape.dash else "-",
        alpha=shape.opacity,
        joinstyle="round",
        capstyle="round",
        zorder=order,
    )
    axes.add_patch(patch)
    if shape.clip:
        patch.set_clip_path(_path([shape.clip], True), axes.transData)


def _path(paths: Sequence[Sequence[Curve]], closed: bool) -> Any:
    from matplotlib.path import Path

    points, codes = [], []
    for path in paths:
        points.append(path[0].points[:1])
        codes.append([_MOVE])
        for curve in path:
            more = _as_cubics(curve)
            points.append(more)
            codes.append([_LINE] if len(more) == 1 else [_CUBIC] * len(more))
        if closed:
            points.append(path[0].points[:1])
            codes.append([_CLOSE])
    return Path(np.concatenate(points), np.concatenate(codes))


def _as_cubics(curve: Curve) -> Floats:
    """The control points of a curve after its start; one for a segment."""
    if not curve.turn:
        return curve.points[1:]
    count = int(np.ceil(abs(curve.turn) / _STEP))
    stops = curve.at(np.arange(count + 1) / count)
    arm = stops - curve.centre
    tangent = np.stack([-arm[:, 1], arm[:, 0]], axis=1) * (4 / 3 * np.tan(curve.turn / count / 4))
    return np.stack([stops[:-1] + tangent[:-1], stops[1:] - tangent[1:], stops[1:]], axis=1).reshape(-1, 2)
