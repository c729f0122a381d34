"""Colours that print: dark ones for lines, tints for areas, told apart in grey and by colour-blind readers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

INK = "#1a1a1a"
GREY = "#8a8f94"
PAPER = "#fbf6e9"
# After Okabe and Ito, in an order in which neighbours differ in lightness; without their yellow, too pale for lines.
_LINES = ("#0072b2", "#d98200", "#6a1b5e", "#2a9d78", "#d1440c", "#58aee0", "#96763f", "#c9699f", "#3d4a52", "#8c9a2b")
# The lowest, the middle and the highest value of a function: they differ from white to either side.
_LOW, _HIGH = (0x0B, 0x4F, 0x8A), (0xB8, 0x45, 0x0A)


def line_colour(label: int) -> str:
    """The colour of a letter, from 1 on; after ten letters they come again."""
    return _LINES[(label - 1) % len(_LINES)]


def mixed(colours: Sequence[str]) -> str:
    """The mean of some colours."""
    return hexadecimal(np.mean([channels(colour) for colour in colours], axis=0))


def tint(colour: str, share: float) -> str:
    """A colour mixed with white: 1 is the colour itself, 0 is white."""
    return hexadecimal(255 - share * (255 - np.array(channels(colour))))


def channels(colour: str) -> tuple[int, int, int]:
    """Red, green and blue, 0 to 255, of a colour like #0072b2."""
    red, green, blue = bytes.fromhex(colour[1:])
    return red, green, blue


def hexadecimal(rgb: ArrayLike) -> str:
    """A colour like #0072b2 of red, green and blue."""
    return "#" + bytes(np.clip(np.round(np.asarray(rgb, dtype=np.float64)), 0, 255).astype(np.uint8)).hex()


def diverging(values: Floats) -> Floats:
    """Colours (..., 3) of values in [-1, 1]: blue below 0, white at 0, orange above."""
    t = np.clip(values, -1, 1)[..., None]
    end = np.where(t < 0, np.array(_LOW, dtype=np.float64), np.array(_HIGH, dtype=np.float64))
    return np.asarray(255 - np.abs(t) ** 0.8 * (255 - end))
