"""Marked edges: those that a file says are sharp, by their ends."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


class MarkedEdges(NamedTuple):
    """Edges of a mesh that are to be sharp: their ends, vertices (n, 2), and how sharp each is, (n,), above 0."""

    ends: Ints
    sharpness: Floats

    @classmethod
    def of(cls, ends: Ints, sharpness: Floats) -> MarkedEdges | None:
        """Those with some sharpness; None where there is none."""
        sharp = sharpness > 0
        return cls(np.asarray(ends, dtype=np.intp)[sharp], sharpness[sharp]) if sharp.any() else None

    def renumbered(self, number: Ints) -> MarkedEdges | None:
        """Those that are left where the vertices have other numbers, (V,), negative for one that is gone."""
        ends = number[self.ends]
        return MarkedEdges.of(ends, np.where((ends >= 0).all(axis=1), self.sharpness, 0.0))

    def among(self, tail: Ints, head: Ints) -> Bools:
        """Which of some edges with two ends (n,) are marked, (n,)."""
        count = 1 + max(int(self.ends.max(initial=0)), int(tail.max(initial=0)), int(head.max(initial=0)))
        keys = [np.minimum(a, b) * np.intp(count) + np.maximum(a, b) for a, b in ((tail, head), self.ends.T)]
        return np.isin(keys[0], keys[1])
