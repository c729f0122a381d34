"""Orbifold X/H: a geometry, an atlas, and the lifts of points within a radius."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe.atlas import Atlas
from orbiframe.geometry import Geometry

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Orbifold:
    """A closed surface X/H: the atlas of its patches, its Euler characteristic, whether it is orientable, its area.

    area: 2 pi |euler_characteristic| in S^2 and H^2 (Gauss-Bonnet), the area of a fundamental domain in E^2.
    """

    atlas: Atlas
    euler_characteristic: int
    orientable: bool
    area: float

    @property
    def geometry(self) -> Geometry:
        """The plane of constant curvature that covers the surface."""
        return self.atlas.geometry

    def lifts(self, patch: int, radius: float) -> tuple[Ints, Floats]:
        """Every copy of a patch frame whose origin lies within `radius` of the origin of the frame of `patch`.

        Returns the patch of each copy, (k,), and the isometry from its frame to the frame of `patch`, (k, 3, 3), each
        once; the first is the patch itself with the identity. Found by walking from patch to patch.
        """
        raise NotImplementedError
