"""Samples: values of functions at points of X/H, with weights."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe.atlas import Points

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Samples:
    """What a fitter approximates: d functions at n points of X/H.

    points: n points of X/H; values: (n, d); weights: (n,), positive, of any scale (area in space, say); stretch: (n,),
    area in X per area in space near each point, which turns Laplacians on X/H into Laplacians on the surface.
    """

    points: Points
    values: Floats
    weights: Floats
    stretch: Floats
