"""Atlas: X/H as patches with frames near the origin, and the transitions between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.one_line import one_line
from orbiframe.planes.geometry import Geometry

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


class Points(NamedTuple):
    """Points of X/H: the patch of each, (n,), and its coordinates in the frame of that patch, (n, 3)."""

    patch: Ints
    x: Floats


@dataclass(frozen=True, eq=False)
class Atlas:
    """Patches of X/H, each with a frame of its own, and the isometries that carry one frame to the next.

    Transition t takes coordinates in the frame of patch `head[t]` to coordinates in the frame of patch `tail[t]`:
    x_tail = isometry[t] x_head. Transition 0 is the identity (tail and head -1: it stands for "the same patch");
    `inverse[t]` is the transition the other way. A fundamental polygon with its side pairings is the atlas with one
    patch. patch_count: number of patches; tail, head, inverse: (T,); isometry: (T, 3, 3); radius: (patch_count,),
    every point of X/H lies within radius[p] of the origin of the frame of some patch p.
    """

    geometry: Geometry
    radius: Floats
    tail: Ints
    head: Ints
    inverse: Ints
    isometry: Floats

    __repr__ = one_line

    @property
    def patch_count(self) -> int:
        """Number of patches."""
        return len(self.radius)
