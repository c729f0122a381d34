"""Number pictures: meshes whose colours are numbers at their vertices, one beside the other."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe.files import write_bytes
from orbiframe.surfaces import ColourScale, ShadedPicture, shaded_picture

Floats = NDArray[np.float64]

_WIDTH, _IN_A_ROW = 360, 4
_LEVELS = 24


def write_pictures(path: Path, mesh: Polyhedron, scales: list[tuple[ColourScale, Floats]]) -> None:
    """Write one picture of the mesh for each scale and its numbers (V,), at most four in a row, as PNG."""
    made = [shaded_picture(mesh, width=_WIDTH, colours=scale.colours(values)).pixels for scale, values in scales]
    height = max(pixels.shape[0] for pixels in made)
    width = max(pixels.shape[1] for pixels in made)
    across = min(_IN_A_ROW, len(made))
    sheet = np.zeros((height * math.ceil(len(made) / across), width * across, 4), dtype=np.uint8)
    for number, pixels in enumerate(made):
        row, column = divmod(number, across)
        place = sheet[row * height :, column * width :]
        place[: pixels.shape[0], : pixels.shape[1]] = pixels
    write_bytes(path, ShadedPicture(sheet).png)


def write_levels(path: Path, mesh: Polyhedron, values: Floats) -> None:
    """Write a picture of numbers as colours, with lines where they are whole parts of the largest one, as PNG."""
    scale, lines = ColourScale.rising(values, 0.0), []
    most = float(values[np.isfinite(values)].max(initial=0.0))
    for level in np.arange(1, _LEVELS) * most / _LEVELS:
        lines += level_segments(mesh, values, level)
    write_bytes(path, shaded_picture(mesh, width=2 * _WIDTH, colours=scale.colours(values), lines=lines).png)


def level_segments(mesh: Polyhedron, values: Floats, level: float) -> list[Floats]:
    """The segments (2, 3) in which the triangles of a mesh have this value."""
    corners = mesh.triangles
    above = values[corners] > level
    crossed = corners[np.isfinite(values[corners]).all(axis=1) & above.any(axis=1) & ~above.all(axis=1)]
    up = values[crossed] > level
    # The corner that lies alone on its side of the level goes first; then its two sides are cut.
    alone = np.where(up.sum(axis=1) == 1, up.argmax(axis=1), (~up).argmax(axis=1))
    first, *others = (np.take_along_axis(crossed, (alone[:, None] + k) % 3, axis=1)[:, 0] for k in range(3))
    x = mesh.vertices
    ends = []
    for other in others:
        share = ((level - values[first]) / (values[other] - values[first]))[:, None]
        ends.append((1 - share) * x[first] + share * x[other])
    return list(np.stack(ends, axis=1))
