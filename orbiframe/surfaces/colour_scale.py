"""Colour scales: numbers as colours that are told apart in grey and by colour-blind readers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# From dark to bright, after viridis of matplotlib; and from blue over light grey to orange.
_RISING = np.array([[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]]) / 255
_DIVERGING = np.array([[11, 79, 138], [120, 170, 205], [214, 217, 220], [230, 165, 110], [184, 69, 10]]) / 255


class ColourScale(NamedTuple):
    """Colours for numbers from low to high; what lies beyond has the colour of the end."""

    low: float
    high: float
    stops: Floats

    @classmethod
    def rising(cls, values: Floats, low: float | None = None) -> ColourScale:
        """From the smallest number, or another one, to one that 99.5 % of all do not exceed."""
        finite = values[np.isfinite(values)]
        least = float(finite.min(initial=np.inf)) if low is None else low
        return cls(least, float(np.quantile(finite, 0.995)) if len(finite) else 1.0, _RISING)

    @classmethod
    def diverging(cls, values: Floats) -> ColourScale:
        """Light grey at 0, and as far to both sides as 97 % of all numbers reach."""
        finite = np.abs(values[np.isfinite(values)])
        reach = float(np.quantile(finite, 0.97)) if len(finite) else 1.0
        return cls(-reach, reach, _DIVERGING)

    def colours(self, values: Floats) -> Floats:
        """Red, green and blue from 0 to 1, (..., 3); grey for what is no number."""
        width = self.high - self.low
        share = (np.clip(values, self.low, self.high) - self.low) / (width if width > 0 else 1.0)
        at = np.nan_to_num(share) * (len(self.stops) - 1)
        found = np.stack([np.interp(at, np.arange(len(self.stops)), column) for column in self.stops.T], axis=-1)
        return np.where(np.isfinite(values)[..., None], found, 0.6)

    @property
    def gradient(self) -> str:
        """The colours for a page, from left to right."""
        return ", ".join(f"rgb({r:.0f},{g:.0f},{b:.0f})" for r, g, b in 255 * self.stops)
