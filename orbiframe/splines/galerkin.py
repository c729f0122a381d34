"""Galerkin matrices: scalar products of piecewise polynomials on X/H and of their derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array, csc_array, csr_array
from scipy.sparse.linalg import splu

from orbiframe.planes.quadrature import triangle_rule
from orbiframe.splines.bernstein import bernstein_gradients, bernstein_values, coefficient_count
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]

_CHUNK = 1 << 22  # numbers in memory at a time
# Gauss points along a direction beyond the degree, for micro triangles up to these diameters h: the error falls by
# about 0.06 h^2 with every point, and ten digits are wanted.
_MORE_POINTS = ((0.15, 4), (0.35, 5), (0.7, 6), (1.0, 8), (1.3, 10), (2.0, 14), (2.6, 19), (np.inf, 28))


class PiecewisePolynomials(Protocol):
    """What the scalar products need: the triangles, the degree, the micro triangles and the matrix C."""

    domain: GeodesicTriangulation
    degree: int
    micro_triangles: Floats
    matrix: csr_array


class _Rule(NamedTuple):
    """Quadrature on some micro triangles: area weights and 1/rho (N, q), dual metrics (N, 3, 3)."""

    weights: Floats
    shrink: Floats
    metric: Floats


def mass(space: PiecewisePolynomials) -> csr_array:
    """The scalar products of the functions, the integrals of b_i b_j over X/H: sparse (size, size)."""

    def local(rule: _Rule, tables: _Tables) -> Floats:
        scale = rule.weights * rule.shrink ** (2 * space.degree)
        return _gram(tables.values, scale, tables.values)

    return _assembled(space, local)


def stiffness(space: PiecewisePolynomials) -> csr_array:
    """The integrals of <grad b_i, grad b_j> over X/H: Q(dF, dG) - K d^2 F G on X, with Q = diag(K, 1, 1)."""
    degree, curvature = space.degree, space.domain.geometry.curvature

    def local(rule: _Rule, tables: _Tables) -> Floats:
        scale = rule.weights * rule.shrink ** (2 * degree - 2)
        found = -curvature * degree**2 * _gram(tables.values, scale * rule.shrink**2, tables.values)
        for i in range(3):
            for j in range(3):
                entry = rule.metric[:, i, j, None] * scale
                found += _gram(tables.gradients[:, i], entry, tables.gradients[:, j])
        return found

    return _assembled(space, local)


def integrals(space: PiecewisePolynomials) -> Floats:
    """The integral of every function over X/H, (size,)."""
    parts = [
        (rule.weights * rule.shrink**space.degree) @ tables.values for rule, tables in _chunks(space, _points(space))
    ]
    return np.asarray(space.matrix.T @ np.concatenate(parts).ravel())


def nearest_to_one(space: PiecewisePolynomials) -> Floats:
    """The coefficients (size,) of the function of the space that is nearest to 1 in the mean square."""
    factor = splu(csc_array(mass(space)), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    return np.asarray(factor.solve(integrals(space)))


class _Tables(NamedTuple):
    """Bernstein polynomials at the points of the rule: values (q, a) and gradients (q, 3, a)."""

    values: Floats
    gradients: Floats


def _points(space: PiecewisePolynomials) -> int:
    """Gauss points along each direction, enough for products to be right to ten digits; one number for all forms."""
    geometry = space.domain.geometry
    if geometry.curvature == 0:
        return space.degree + 1
    flat = space.micro_triangles.reshape(-1, 3, 3)
    corners = geometry.project(flat)
    diameter = float(geometry.distance(corners, np.roll(corners, -1, axis=1)).max())
    return space.degree + next(more for bound, more in _MORE_POINTS if diameter <= bound)


def _chunks(space: PiecewisePolynomials, points: int) -> Iterator[tuple[_Rule, _Tables]]:
    """The rule on the micro triangles, some at a time, with the tables that all share."""
    barycentric, weights = triangle_rule(points)
    tables = _Tables(bernstein_values(space.degree, barycentric), bernstein_gradients(space.degree, barycentric))
    micro_triangles = space.micro_triangles.reshape(-1, 3, 3)
    at_once = max(_CHUNK // (len(weights) * coefficient_count(space.degree)), 1)
    for begin in range(0, len(micro_triangles), at_once):
        yield (
            _rule(space.domain.geometry.curvature, micro_triangles[begin : begin + at_once], barycentric, weights),
            tables,
        )


def _rule(curvature: int, corners: Floats, barycentric: Floats, weights: Floats) -> _Rule:
    """Points p = sum lambda_i v_i, dA = |det(v1, v2, v3)| / rho(p)^3 dlambda1 dlambda2 and the metric V^-1 Q V^-T."""
    form = np.array([1.0, curvature, curvature])
    flat = barycentric @ corners
    shrink = 1 / np.sqrt((flat**2 * form).sum(axis=-1))
    volume = np.abs(np.linalg.det(corners))
    inverse = np.linalg.inv(np.swapaxes(corners, 1, 2))
    metric = (inverse * np.array([curvature, 1.0, 1.0])) @ np.swapaxes(inverse, 1, 2)
    return _Rule(volume[:, None] * shrink**3 * weights / 2, shrink, metric)


def _gram(left: Floats, weights: Floats, right: Floats) -> Floats:
    """Sum over the points q of left[q, a] weights[n, q] right[q, b], (N, a, b)."""
    return np.asarray(left.T @ (weights[..., None] * right))


def _assembled(space: PiecewisePolynomials, local: Callable[[_Rule, _Tables], Floats]) -> csr_array:
    """C^T blockdiag(local matrices) C."""
    blocks = np.concatenate([local(*part) for part in _chunks(space, _points(space))])
    count = len(blocks)
    diagonal = bsr_array((blocks, np.arange(count), np.arange(count + 1)))
    return csr_array(space.matrix.T @ (diagonal.tocsr() @ space.matrix))
