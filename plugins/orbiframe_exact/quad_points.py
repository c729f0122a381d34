"""Quad points: where the points of quadrilaterals of X lie on a surface, with derivatives along their sides."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe import FitError, Geometry, OrbifoldSurface, Points
from orbiframe.functions import DifferentiableBasis
from orbiframe_exact.rim_sides import RimSide

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_NEWTON = 12


@dataclass(frozen=True, eq=False)
class QuadPoints:
    """Quadrilaterals of X, each in a frame, and the surface over them before it is placed in space.

    corners: (Q, 4, 3), counterclockwise vectors on the rays of points of X; patch: (Q,) and placement: (Q, 3, 3), the
    isometry from the frame of each to that of a patch. The point (s, t) of a quadrilateral is the projection to X of
    the bilinear combination of its corners, so that a side depends on its two ends alone. rim: the sides that run along
    the boundary of the surface, whose quadrilaterals are filled out to them (Coons).
    """

    surface: OrbifoldSurface
    corners: Floats
    patch: Ints
    placement: Floats
    rim: tuple[RimSide, ...] = ()

    def jets(self, quad: Ints, s: Floats, t: Floats, order: int) -> list[Floats]:
        """The surface at points (n,) of quadrilaterals: F; and F_s, F_t for order 1; and F_st for order 2; (n, 3) each.

        F_st is the covariant Hessian in the two directions and the derivative along their own covariant change.
        """
        basis = self.surface.basis
        if not isinstance(basis, DifferentiableBasis):
            raise FitError("the functions have no derivatives, which smooth faces need; use others, such as 'gaussian'")
        geometry = self.surface.orbifold.geometry
        x, *vectors = projected(geometry, *self._flat(quad, s, t))
        place = geometry.settle(geometry.act(self.placement[quad], x))
        points, step = settled(self.surface, Points(self.patch[quad], place))
        frame = geometry.frame(points.x)
        g = step @ self.placement[quad]
        along = []
        for vector in vectors[: (0, 2, 3)[order]]:
            there = geometry.act(g, vector)
            along.append(np.stack([geometry.inner(points.x, there, frame[..., k]) for k in (0, 1)], axis=0)[..., None])
        d = basis.jets(points, self.surface.coefficients, order)
        found = [d[0], *(a[0] * d[1] + a[1] * d[2] for a in along[:2])]
        if order == 2:
            a, b, c = along
            bend = a[0] * b[0] * d[3] + (a[0] * b[1] + a[1] * b[0]) * d[4] + a[1] * b[1] * d[5]
            found.append(bend + c[0] * d[1] + c[1] * d[2])
        return found

    def parameters(self, quad: Ints, x: Floats) -> tuple[Floats, Floats]:
        """The parameters s and t, from 0 to 1, at points x (n, 3) of quadrilaterals, in the frame of each.

        By Newton's steps for <e, p(s, t)> = 0 with two vectors e that are orthogonal to x.
        """
        least = np.eye(3)[np.abs(x).argmin(axis=1)]
        one = np.cross(x, least)
        one /= np.linalg.norm(one, axis=1, keepdims=True)
        other = np.cross(x, one)
        s, t = np.full(len(x), 0.5), np.full(len(x), 0.5)
        for _ in range(_NEWTON):
            p, ps, pt, _ = self._flat(quad, s, t)
            (a, b), (c, d), (f, g) = ([np.einsum("ni,ni->n", e, v) for e in (one, other)] for v in (ps, pt, p))
            determinant = a * d - b * c
            step = np.where(determinant == 0, 0.0, 1 / np.where(determinant == 0, 1.0, determinant))
            s = np.clip(s - step * (d * f - c * g), 0, 1)
            t = np.clip(t - step * (a * g - b * f), 0, 1)
        return s, t

    def _flat(self, quad: Ints, s: Floats, t: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """What is projected: p, p_s, p_t and p_st."""
        found = _bilinear(self.corners[quad], s[:, None], t[:, None])
        for rim in self.rim:
            own = np.flatnonzero(quad == rim.quad)
            for table, more in zip(found, rim.added(s[own], t[own]), strict=True):
                table[own] += more
        return found


def _bilinear(corners: Floats, s: Floats, t: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """The bilinear combination p of four corners, p_s, p_t and p_st."""
    a, b, c, d = np.moveaxis(corners, 1, 0)
    p = (1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d
    return p, (1 - t) * (b - a) + t * (c - d), (1 - s) * (d - a) + s * (c - b), a - b + c - d


def projected(geometry: Geometry, p: Floats, ps: Floats, pt: Floats, pst: Floats) -> list[Floats]:
    """The projection x = p / r of a map p to X, x_s, x_t, and the tangent vector by which x_st enters a Hessian.

    r^2 = <p, p> in the form of X, r r_s = <p, p_s>, x_s = (p_s - x r_s) / r, and so on. That is the
    tangent part of x_st: what it has along x means nothing to functions on X.
    """
    form = np.array([1.0, geometry.curvature, geometry.curvature])

    def product(v: Floats, w: Floats) -> Floats:
        return np.asarray((v * w) @ form)[:, None]

    r = np.sqrt(product(p, p))
    x, rs, rt = p / r, product(p, ps) / r, product(p, pt) / r
    xs, xt = (ps - x * rs) / r, (pt - x * rt) / r
    rst = (product(ps, pt) + product(p, pst) - rs * rt) / r
    bend = (pst - xs * rt - xt * rs - x * rst) / r
    return [x, xs, xt, bend - x * product(x, bend)]


def settled(surface: OrbifoldSurface, points: Points) -> tuple[Points, Floats]:
    """Points in the nearest patches, as `Orbifold.settled`, and the isometries from the old frames, (n, 3, 3)."""
    orbifold, geometry = surface.orbifold, surface.orbifold.geometry
    patch, x = np.array(points.patch), np.array(points.x)
    step = np.tile(np.eye(3), (len(patch), 1, 1))
    far = np.flatnonzero(geometry.distance(geometry.origin, x) > orbifold.atlas.radius[patch])
    while len(far):
        parent, transition = orbifold.steps(patch[far])
        back = orbifold.atlas.isometry[orbifold.atlas.inverse[transition]]
        place = geometry.act(back, x[far[parent]])
        away = geometry.distance(geometry.origin, place)
        order = np.lexsort((away, parent))
        best = order[np.unique(parent[order], return_index=True)[1]]
        moving = far[parent[best]]
        nearer = away[best] < geometry.distance(geometry.origin, x[moving]) * (1 - 1e-9)
        far, best = moving[nearer], best[nearer]
        patch[far], x[far] = orbifold.atlas.head[transition[best]], geometry.settle(place[best])
        step[far] = back[best] @ step[far]
    return Points(patch, x), step
