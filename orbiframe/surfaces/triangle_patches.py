"""Triangle patches: a surface of piecewise polynomials as rational Bezier triangles, exactly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from math import comb, factorial

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import FitError
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
from orbiframe.surfaces.patch_gluing import Gluing, alike, micro_gluing, quartered
from orbiframe.surfaces.quadrilateral_patches import QuadrilateralPatches
from orbiframe.surfaces.surface import OrbifoldSurface

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
    turned = np.linalg.det(basis.micro_triangles) * sign[:, None] < 0
    corners = np.where(turned[..., None], [0, 2, 1], [0, 1, 2])
    micro_triangles = np.take_along_axis(basis.micro_triangles, corners[..., None], 2)
    order = np.where(turned.reshape(-1, 1), _swapped(basis.degree), np.arange(count))
    return TrianglePatches(
        basis.degree,
        np.take_along_axis(points.reshape(-1, count, 3), order[..., None], 1),
        np.take_along_axis(weights.reshape(-1, count), order, 1),
        micro_gluing(basis.domain, micro_triangles, sign),
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
    x, k = basis.micro_triangles, basis.domain.geometry.curvature
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
