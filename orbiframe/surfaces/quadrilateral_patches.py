"""Quadrilateral patches: rational tensor product Bezier patches."""

from __future__ import annotations

from dataclasses import dataclass
from math import comb

import numpy as np
from numpy.typing import NDArray

from orbiframe.surfaces.patch_gluing import Gluing

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class QuadrilateralPatches:
    """Rational tensor product Bezier patches: points (N, d + 1, d + 1, 3), [patch, s, t]; weights; gluing.

    Sides 0 to 3 of a patch run along s at t = 0, along t at s = 1, and back.
    """

    points: Floats
    weights: Floats
    gluing: Gluing

    @property
    def degree(self) -> int:
        """The degree in either direction."""
        return int(self.weights.shape[1]) - 1

    def evaluate(self, s: Floats, t: Floats) -> Floats:
        """The points at parameters (m,) of every patch, (N, m, 3)."""
        a, b = (_bernstein(self.degree, x) for x in (s, t))
        values = self.weights * (a[:, None, :, None] * b[:, None, None, :])
        return np.asarray(np.einsum("mnst,nstk->nmk", values, self.points) / values.sum(axis=(2, 3)).T[..., None])

    @property
    def volume(self) -> float:
        """The signed volume inside, of triangles between 8 times 8 points on each patch."""
        basis = _bernstein(self.degree, np.linspace(0, 1, 8))
        centred = self.points - self.points.mean(axis=(0, 1, 2))
        homogeneous = self.weights[..., None] * np.insert(centred, 3, 1.0, axis=-1)
        found = np.einsum("as,nstk,bt->nabk", basis, homogeneous, basis, optimize=True)
        p = found[..., :3] / found[..., 3:]
        a, b, c, d = p[:, :-1, :-1], p[:, 1:, :-1], p[:, 1:, 1:], p[:, :-1, 1:]
        return float(np.sum(np.cross(b, c) * a + np.cross(c, d) * a) / 6)


def _bernstein(degree: int, x: Floats) -> Floats:
    """The Bernstein polynomials of one variable at (m,) parameters, (m, degree + 1)."""
    k = np.arange(degree + 1)
    binomial = np.array([float(comb(degree, i)) for i in k])
    return np.asarray(binomial * x[:, None] ** k * (1 - x[:, None]) ** (degree - k))
