"""Periodic patch: a surface of tensor products as one periodic B-spline surface, exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe.splines.tensor_basis import TensorBasis
from orbiframe.surfaces.patch_gluing import periodic_grid
from orbiframe.surfaces.quadrilateral_patches import QuadrilateralPatches
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PeriodicPatch:
    """One periodic tensor product B-spline surface: S(u, v) = sum P_ij N_i(u) N_j(v) of one degree.

    knots: those of one period in u and in v, rising; N_j has the knots j, ..., j + degree + 1. points: (n_u, n_v, 3).
    periods: 1 and 1 on a torus; 2 and 1 on a Klein bottle, where glide is true and S(u + 1, -v) = S(u, v), so that any
    interval of length 1 of u is the whole surface. On a torus the normal S_u x S_v points outward.
    """

    degree: int
    knots: tuple[Floats, Floats]
    points: Floats
    periods: tuple[float, float]
    glide: bool

    def quadrilaterals(self) -> QuadrilateralPatches:
        """The polynomial pieces as Bezier patches of weight 1, each part of the surface once."""
        u, v = (np.unique(knots) for knots in self.knots)
        rows, columns = (_pieces(k, self.degree, p) for k, p in zip(self.knots, self.periods, strict=True))
        if self.glide:
            rows, u = rows[: len(u) // 2], u[: len(u) // 2]
        points = np.einsum("pai,qbj,ijk->pqabk", rows, columns, self.points)
        points = points.reshape(-1, self.degree + 1, self.degree + 1, 3)
        mirror = (len(v) - 1 - (v[0] > 0) - np.arange(len(v))) % len(v) if self.glide else None
        return QuadrilateralPatches(points, np.ones(points.shape[:3]), periodic_grid((len(u), len(v)), mirror))

    def transposed(self) -> PeriodicPatch:
        """The same surface with u and v exchanged, and the other side outside; not on a Klein bottle."""
        (u, v), (p, q) = self.knots, self.periods
        return PeriodicPatch(self.degree, (v, u), np.swapaxes(self.points, 0, 1), (q, p), self.glide)


def periodic_patch(surface: OrbifoldSurface, basis: TensorBasis) -> PeriodicPatch:
    """The periodic patch of a tensor product on a torus or Klein bottle."""
    points = surface.scale * basis.net(surface.coefficients) + surface.origin
    glide = basis.lattice.glide
    patch = PeriodicPatch(basis.degree, basis.knots, points, (2.0 if glide else 1.0, 1.0), glide)
    return patch if glide or patch.quadrilaterals().volume > 0 else patch.transposed()


def _pieces(knots: Floats, degree: int, period: float) -> Floats:
    """The Bezier points of the pieces between knots from the control points of a period: (pieces, degree + 1, n).

    Point k of the piece on [a, b] is the blossom with k arguments b and degree - k arguments a (de Boor's algorithm).
    """
    count = len(knots)
    place = np.arange(-degree, 2 * count + degree + 1)
    line = knots[place % count] + period * (place // count)
    span = degree + np.flatnonzero(np.diff(line[degree : degree + count + 1]) > 0)
    ends = line[span], line[span + 1]
    forms = np.zeros((len(span), degree + 1, count))
    for k in range(degree + 1):
        table = np.eye(count)[(span[:, None] - 2 * degree + np.arange(degree + 1)) % count]
        for r in range(degree):
            j = span[:, None] - degree + np.arange(r + 1, degree + 1)
            share = (ends[int(r < k)][:, None] - line[j]) / (line[j + degree - r] - line[j])
            table = (1 - share[..., None]) * table[:, :-1] + share[..., None] * table[:, 1:]
        forms[:, k] = table[:, 0]
    return forms
