"""Exact patches: a surface of piecewise polynomials as rational Bezier triangles, quadrilaterals, or one NURBS."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from math import comb, factorial

import numpy as np
from numpy.typing import NDArray

from orbiframe.splines.bernstein import (
    bernstein_values,
    blossom,
    coefficient_count,
    degree_of,
    exponent_number,
    exponents,
    multinomials,
)
from orbiframe.splines.element_basis import ElementBasis
from orbiframe.errors import FitError
from orbiframe.surfaces.patch_gluing import Gluing, alike, cell_gluing, periodic_grid, quartered
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.splines.tensor_basis import TensorBasis

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class TrianglePatches:
    """Rational Bezier triangles: S(lambda) = sum w_a P_a B_a(lambda) / sum w_a B_a(lambda), lambda of sum 1.

    degree; points: (N, n, 3), control points in the order of `exponents(degree)`; weights: (N, n), positive; gluing:
    of their sides. On an orientable surface the corners of all patches run counterclockwise seen from outside, where
    the signed volume is positive.
    """

    degree: int
    points: Floats
    weights: Floats
    gluing: Gluing

    def evaluate(self, barycentric: Floats) -> Floats:
        """The points at barycentric coordinates (m, 3) of every patch, (N, m, 3)."""
        values = bernstein_values(self.degree, barycentric) * self.weights[:, None, :]
        return np.asarray(values @ self.points / values.sum(axis=2, keepdims=True))

    def quadrilaterals(self) -> QuadrilateralPatches:
        """Every triangle as three tensor product patches of the same degree in both directions, exactly."""
        homogeneous = np.concatenate([self.weights[..., None] * self.points, self.weights[..., None]], axis=2)
        made = _quadrilateral_forms(self.degree) @ homogeneous[:, None]
        side = self.degree + 1
        weights = made[..., 3].reshape(-1, side, side)
        points = made[..., :3].reshape(-1, side, side, 3) / weights[..., None]
        return QuadrilateralPatches(points, weights, quartered(self.gluing))


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


def has_exact_patches(basis: object) -> bool:
    """Whether a component makes functions with exact patches."""
    return isinstance(basis, type) and issubclass(basis, ElementBasis | TensorBasis)


def patches_of(surface: OrbifoldSurface) -> TrianglePatches | PeriodicPatch:
    """The exact patches of a surface of piecewise polynomials: triangles, or one periodic patch of a tensor product.

    Raises FitError for other functions, polynomials of odd degree that are not divided by W, and where a weight is not
    positive.
    """
    if isinstance(surface.basis, TensorBasis):
        return periodic_patch(surface, surface.basis)
    if isinstance(surface.basis, ElementBasis):
        return triangle_patches(surface, surface.basis)
    raise FitError(
        f"the functions of '{surface.basis_name or type(surface.basis).__name__}' are neither polynomials on triangles "
        "nor tensor products, so the surface has no exact patches; choose --basis ps2 or ps6, or write a mesh"
    )


def periodic_patch(surface: OrbifoldSurface, basis: TensorBasis) -> PeriodicPatch:
    """The periodic patch of a tensor product on a torus or Klein bottle."""
    points = surface.scale * basis.net(surface.coefficients) + surface.origin
    glide = basis.lattice.glide
    patch = PeriodicPatch(basis.degree, basis.knots, points, (2.0 if glide else 1.0, 1.0), glide)
    return patch if glide or patch.quadrilaterals().volume > 0 else patch.transposed()


def triangle_patches(surface: OrbifoldSurface, basis: ElementBasis) -> TrianglePatches:
    """The rational Bezier triangles of a surface of piecewise polynomials, one for each micro triangle.

    On a triangle of R^3 the surface is F(x) / rho(x)^d. For even degree, and in E^2, the weights are the coefficients
    of rho^d, a product of quadratic forms (in E^2: of linear ones); in the rational space S/W they are those of W.
    """
    weights = _weights(basis)
    _require_positive(weights)
    points = surface.scale * basis.net(surface.coefficients) / weights[..., None] + surface.origin
    sign = alike(basis.domain.twin, basis.domain.same)
    patches = _turned(basis, points, weights, sign)
    if patches.gluing.same.any() or patches.quadrilaterals().volume > 0:
        return patches
    return _turned(basis, points, weights, -sign)


def _turned(basis: ElementBasis, points: Floats, weights: Floats, sign: Ints) -> TrianglePatches:
    """The patches with their corners in the order that the signs of the triangles, (F,), ask for."""
    count = coefficient_count(basis.degree)
    turned = np.linalg.det(basis.cells) * sign[:, None] < 0
    corners = np.where(turned[..., None], [0, 2, 1], [0, 1, 2])
    cells = np.take_along_axis(basis.cells, corners[..., None], 2)
    order = np.where(turned.reshape(-1, 1), _swapped(basis.degree), np.arange(count))
    return TrianglePatches(
        basis.degree,
        np.take_along_axis(points.reshape(-1, count, 3), order[..., None], 1),
        np.take_along_axis(weights.reshape(-1, count), order, 1),
        cell_gluing(basis.domain, cells, sign),
    )


def _require_positive(weights: Floats) -> None:
    if not (weights > 0).all():
        worst = np.unravel_index(int(weights.argmin()), weights.shape)
        raise FitError(
            f"weight {worst[2]} of micro triangle {worst[1]} of triangle {worst[0]} is {weights[worst]:.3g}, and exact "
            "patches need positive ones; use more functions"
        )


def _weights(basis: ElementBasis) -> Floats:
    """The coefficients of the function of the space that the numerator is divided by, (F, m, n)."""
    if basis.weights is not None:
        return basis.net(basis.weights[:, None])[..., 0]
    x, k = basis.cells, basis.domain.geometry.curvature
    if k == 0:
        linear = x[..., 0]
        return np.asarray(np.prod(linear[..., None, :] ** exponents(basis.degree), axis=-1))
    if basis.degree % 2:
        raise FitError(
            f"polynomials of odd degree {basis.degree} have no exact patches in S^2 and H^2 unless they are divided; "
            "use the rational space"
        )
    form = np.einsum("...ai,i,...bi->...ab", x, np.array([1.0, k, k]), x)
    a = exponents(2)
    quadratic = np.stack([form[..., i, j] for i, j in (np.repeat(range(3), row) for row in a)], axis=-1)
    power = quadratic
    for _ in range(basis.degree // 2 - 1):
        power = multiplied(power, quadratic)
    return np.asarray(power)


def multiplied(first: Floats, second: Floats) -> Floats:
    """The coefficients of the product of two homogeneous polynomials, (..., n), from theirs."""
    d1, d2 = (degree_of(c.shape[-1]) for c in (first, second))
    result = np.zeros((*np.broadcast_shapes(first.shape[:-1], second.shape[:-1]), coefficient_count(d1 + d2)))
    left, right = first * multinomials(d1), second * multinomials(d2)
    for i, a in enumerate(exponents(d1)):
        target = [exponent_number(a[1] + b[1], a[2] + b[2]) for b in exponents(d2)]
        result[..., target] += left[..., i, None] * right
    return np.asarray(result / multinomials(d1 + d2))


def _swapped(degree: int) -> NDArray[np.intp]:
    """The numbers of the exponents with the second and third corner exchanged."""
    return np.array([exponent_number(a[2], a[1]) for a in exponents(degree)], dtype=np.intp)


@lru_cache(maxsize=16)
def _quadrilateral_forms(degree: int) -> Floats:
    """The control net of each of three quadrilaterals from that of the triangle, (3, (d + 1)^2, n).

    Quadrilateral c has the corners v_c, the middle of the edge after it, the centroid, the middle of the edge before.
    Its map to barycentric coordinates is bilinear, so that the coefficient (a, b) is the mean of the blossoms with n11
    times the centroid, a - n11 times the middle after, b - n11 times the middle before and v_c else.
    """
    corners = np.eye(3)
    unit = np.eye(coefficient_count(degree))
    forms = np.zeros((3, degree + 1, degree + 1, len(unit)))
    for c in range(3):
        after, before = (corners[c] + corners[(c + 1) % 3]) / 2, (corners[c] + corners[(c + 2) % 3]) / 2
        places = corners[c], after, before, np.full(3, 1 / 3)
        for a, b in product(range(degree + 1), repeat=2):
            for both in range(max(0, a + b - degree), min(a, b) + 1):
                counts = degree - a - b + both, a - both, b - both, both
                share = factorial(degree) / np.prod([float(factorial(n)) for n in counts])
                arguments = [place for place, n in zip(places, counts, strict=True) for _ in range(n)]
                forms[c, a, b] += share / (comb(degree, a) * comb(degree, b)) * blossom(unit, arguments)
    return forms.reshape(3, -1, len(unit))


def _bernstein(degree: int, x: Floats) -> Floats:
    """The Bernstein polynomials of one variable at (m,) parameters, (m, degree + 1)."""
    k = np.arange(degree + 1)
    binomial = np.array([float(comb(degree, i)) for i in k])
    return np.asarray(binomial * x[:, None] ** k * (1 - x[:, None]) ** (degree - k))


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
