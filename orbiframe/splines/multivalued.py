"""Multivalued functions: piecewise polynomials with one branch on every triangle, and constant jumps across edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, eye_array

from orbiframe.errors import FitError
from orbiframe.splines.bernstein import coefficient_count, exponent_number, exponents, multinomials
from orbiframe.splines.element_basis import ElementBasis
from orbiframe.triangulations.cocycles import corner_values

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def branches(basis: ElementBasis) -> ElementBasis:
    """The same polynomials on every triangle for itself: its unknowns are the Bernstein coefficients, (F n,).

    Raises FitError unless the functions are continuous polynomials on whole triangles, among them the constants, and
    no more than continuous.
    """
    flat = basis.orbifold.geometry.curvature == 0
    if basis.smoothness != 0 or basis.micro_triangles.shape[1] != 1 or (basis.degree % 2 and not flat):
        raise FitError(
            "multivalued functions are made of continuous polynomials that contain the constants; take the functions "
            "'bernstein' of an even degree"
        )
    count = basis.domain.face_count * coefficient_count(basis.degree)
    matrix = csr_array(eye_array(count, format="csr"))
    return ElementBasis(basis.domain, basis.degree, basis.micro_triangles, matrix, -1, rational=False)


def jumping(basis: ElementBasis, jumps: Ints) -> Floats:
    """Multivalued functions with these jumps (k, 3 F), as coefficients (F n, k) of `branches`.

    On the edges they are the jump times the constant 1, so that all others come by adding functions of the basis.
    """
    domain, a = basis.domain, exponents(basis.degree)
    corner = corner_values(domain, jumps)
    edge = np.where(domain.reference, 0, jumps).reshape(len(jumps), domain.face_count, 3)
    net = np.zeros((len(jumps), domain.face_count, len(a)))
    for c in range(3):
        net[..., np.flatnonzero(a[:, c] == basis.degree)] = corner[..., c, None]
        on_edge = (a[:, (c + 2) % 3] == 0) & (a[:, c] > 0) & (a[:, (c + 1) % 3] > 0)
        net[..., np.flatnonzero(on_edge)] = edge[..., c, None]
    constant = one(basis)
    return np.asarray((net * constant).reshape(len(jumps), constant.size).T)


def one(basis: ElementBasis) -> Floats:
    """The Bernstein coefficients of the constant 1 on every triangle, (F, n): those of beta(x, x)^(degree / 2)."""
    corners, k = basis.domain.corners, basis.orbifold.geometry.curvature
    if k == 0:
        return np.ones((len(corners), coefficient_count(basis.degree)))
    form = np.einsum("fai,i,fbi->fab", corners, [1.0, k, k], corners)
    power = np.ones((len(corners), 1))
    for degree in range(2, basis.degree + 1, 2):
        power = _times(power, degree - 2, form)
    return power / multinomials(basis.degree)


def _times(monomials: Floats, degree: int, form: Floats) -> Floats:
    """The coefficients of the monomials of a polynomial times the quadratic form (F, 3, 3)."""
    product = np.zeros((len(form), coefficient_count(degree + 2)))
    a = exponents(degree)
    for i in range(3):
        for j in range(3):
            up = [exponent_number(k[1] + (i == 1) + (j == 1), k[2] + (i == 2) + (j == 2)) for k in a]
            product[:, up] += form[:, i, j, None] * monomials
    return product
