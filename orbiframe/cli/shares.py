"""Shares: how much of a work is done, and how long the rest will take."""

from __future__ import annotations

import math
import time

# What the stages of a fit take, relative to one another, on an ordinary mesh with the default configuration.
_WEIGHTS = {
    "read": 1,
    "topology": 1,
    "triangles": 1,
    "refinement": 1,
    "map": 10,
    "shape": 20,
    "basis": 2,
    "samples": 2,
    "fit": 45,
    "error": 20,
    "tessellation": 5,
    "inspection": 12,
}
_OPTIONAL, _LAST = ("shape",), ("tessellation", "inspection")
_ALL = sum(weight for stage, weight in _WEIGHTS.items() if stage not in _OPTIONAL)
_END = sum(_WEIGHTS[stage] for stage in _LAST)
# Before that much is done nobody knows how long the rest takes.
_KNOWN_SHARE, _KNOWN_SECONDS = 0.02, 1.0
# Seconds for a unit of weight, at least.
_LEAST_PACE = 0.01


class FitShare:
    """The share of a fit that is done, by its stages; of several parts, by those of each. It never falls."""

    def __init__(self) -> None:
        self._begun, self._stage, self._stage_begun = 0.0, "", 0.0
        self._done, self._ended, self._share, self._part = 0.0, 0.0, 0.0, ""

    def begins(self, stage: str) -> None:
        """Hear that a stage begins."""
        now = time.monotonic()
        self._begun, self._stage, self._stage_begun = self._begun or now, stage, now
        if stage.startswith(_LAST) and not self._ended:
            self._ended = float(_ALL - _END)

    def ends(self, stage: str) -> None:
        """Hear that a stage has ended."""
        name, _, part = stage.partition(" ")
        if part != self._part:
            self._part, self._done, self._ended = part, 0.0, 0.0
        self._done += _WEIGHTS.get(name, 0)
        self._ended += _WEIGHTS.get(name, 0) if self._ended else 0
        self._stage = ""

    @property
    def share(self) -> float:
        """Between 0 and 1; while a stage goes on it grows, by less and less."""
        now = time.monotonic()
        weight, spent = _WEIGHTS.get(self._stage.partition(" ")[0], 0), now - self._stage_begun
        expected = weight * max((self._stage_begun - self._begun) / max(self._done, 1.0), _LEAST_PACE)
        grown = weight * spent / (spent + expected) if weight and spent > 0 else 0.0
        number, _, count = self._part.partition("/")
        parts = int(count) if number.isdecimal() and count.isdecimal() else 1
        before = int(number) - 1 if parts > 1 else 0
        own = self._ended + grown if self._ended else _foreseen(self._done + grown)
        self._share = max(self._share, (before + min(own / _ALL, 0.99)) / parts)
        return self._share

    @property
    def left(self) -> float | None:
        """Seconds that the rest will take, about; None while nobody knows."""
        return left(self.share, time.monotonic() - self._begun)


def _foreseen(done: float) -> float:
    """How much is done before the last stages begin, which nobody knows: smooth meshes have most stages twice."""
    before = _ALL - _END
    return before * (1 - math.exp(-1.2 * done / before)) / (1 - math.exp(-2.4))


def left(share: float, elapsed: float) -> float | None:
    """Seconds that the rest of a work will take if it goes on like this; None while nobody knows."""
    if share < _KNOWN_SHARE or elapsed < _KNOWN_SECONDS:
        return None
    return elapsed * (1 - share) / share


def in_words(seconds: float | None) -> str:
    """A time that is left, in words; empty where it is not known."""
    if seconds is None:
        return ""
    for size, unit in ((86400, "d"), (3600, "h"), (60, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.0f} {unit} left"
    return f"{seconds:.0f} s left"
