"""The two groups of isometries of the sphere that act freely."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe import Atlas, Geometry, GeometryError, Group, Word

Floats = NDArray[np.float64]


class FiniteGroup(Group):
    """The trivial group, or {e, antipodal map}: X/H is the sphere or the projective plane.

    The polygon is the whole sphere, or the closed hemisphere x0 >= 0, a polygon of its own kind: it is no convex
    polygon. Built from a geometry of curvature 1 and any word of one of the two surfaces; raises GeometryError
    otherwise.
    """

    def __init__(self, geometry: Geometry, word: Word) -> None:
        if geometry.curvature != 1 or word.euler_characteristic < 1:
            raise GeometryError(
                f"'{word}' is a {word.surface}, wanted in {geometry.name}; the finite groups are those of the sphere "
                "and the projective plane, in s2"
            )
        self.geometry, self.word = geometry, word
        self.area = 2 * np.pi * word.euler_characteristic
        self._elements = np.eye(3)[None] if word.orientable else np.stack([np.eye(3), -np.eye(3)])

    def atlas(self) -> Atlas:
        """One patch; in the projective plane transition 1 is the antipodal map."""
        patch = np.arange(len(self._elements)) - 1
        radius = np.array([np.pi / len(self._elements)])
        return Atlas(self.geometry, radius, patch, patch.copy(), np.arange(len(patch)), self._elements)

    def generator(self, label: int) -> Floats:
        """The antipodal map for a letter that occurs twice with one sign, else the identity."""
        twice = self.word.letters.count(label) == 2 or self.word.letters.count(-label) == 2
        return np.asarray(self._elements[-1 if twice else 0])

    def tiles(self, radius: float) -> Floats:
        """The identity, and from the radius pi/2 on the antipodal map."""
        return np.asarray(self._elements[: 2 if radius >= np.pi / 2 else 1])

    def reduce(self, x: ArrayLike) -> tuple[Floats, Floats]:
        """x or -x; on the boundary of the hemisphere the one whose first coordinate other than zero is positive."""
        points = self.geometry.settle(x)
        lead = np.take_along_axis(points, np.argmax(points != 0, axis=-1)[..., None], axis=-1)[..., 0]
        flip = (lead < 0) & (len(self._elements) > 1)
        return np.where(flip[..., None], -points, points), self._elements[flip.astype(int)]
