"""Functions on X/H as colours over a picture of X."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from orbiframe_drawing.colours import channels, diverging
from orbiframe_drawing.picture import Raster

Floats = NDArray[np.float64]

Function = Callable[[Floats], Floats]
"""Values (n,) at points (n, 3) of X."""

_PIXELS = 560
_BANDS = 8  # of one colour each, on either side of 0
_ZERO = np.array(channels("#1a1a1a"))
# Farther out all periods are smaller than a pixel, and group elements lose their digits: cosh 7.6.
_FARTHEST = 1000.0


def function_image(function: Function, points: Callable[[Floats], Floats], half: float) -> Raster:
    """An image of the square from -half to half, white at the value 0, blue below it and orange above.

    points: the points of X (n, 3) at places (n, 2) of the square, nan where there is none. Colours come in bands, as
    many as print can show, and the line where the function is 0 is dark.
    """
    middles = half * ((2 * np.arange(_PIXELS) + 1) / _PIXELS - 1)
    place = np.stack(np.meshgrid(middles, -middles), axis=-1).reshape(-1, 2)
    x = points(place)
    there = np.isfinite(x).all(axis=1) & (x[:, 0] < _FARTHEST)
    values = np.full(len(x), np.nan)
    values[there] = function(x[there])
    values = (values / np.nanmax(np.abs(values))).reshape(_PIXELS, _PIXELS)
    colours = np.zeros((_PIXELS, _PIXELS, 4), dtype=np.uint8)
    shown = np.nan_to_num(values)
    bands = np.sign(shown) * (np.floor(np.minimum(np.abs(shown), 1 - 1e-9) * _BANDS) + 0.5) / _BANDS
    colours[..., :3] = np.where(_changes_sign(shown)[..., None], _ZERO, diverging(bands))
    colours[..., 3] = np.where(np.isfinite(values), 255, 0)
    return Raster(colours, (-half, -half, half, half))


def _changes_sign(values: Floats) -> NDArray[np.bool_]:
    """Which pixels have a neighbour to the right or below with a value of the other sign."""
    changes = np.zeros(values.shape, dtype=np.bool_)
    changes[:, :-1] |= values[:, :-1] * values[:, 1:] < 0
    changes[:-1] |= values[:-1] * values[1:] < 0
    return changes
