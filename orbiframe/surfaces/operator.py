"""Operators: the sparse matrices that take coefficients of a surface to its points and derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array, vstack

from orbiframe.components.one_line import one_line
from orbiframe.errors import FitError
from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]

_KINDS = ("value", "D1", "D2", "D11", "D12", "D22")
_OF_ORDER = (1, 3, 6)


@dataclass(frozen=True, eq=False)
class SurfaceOperator:
    """What is linear in the coefficients of a surface, at n points of X/H.

    matrices: by name, sparse (n, size): "value", with which the points are origin + value @ coefficients; from order 1
    on "D1" and "D2", the derivatives along the orthonormal frame (e1, e2) = `geometry.frame(x)` of X; from order 2 on
    "D11", "D12" and "D22", the covariant Hessian in that frame. All are in the unit of the surface in space: its scale
    is in them. origin: (3,).

    >>> import numpy as np
    >>> from orbiframe import fit
    >>> surface = fit("dataset:torus", size=100).surface
    >>> points = surface.points([0, 7], [[1, 0, 0], [0, 1, 0]])
    >>> operator = surface.operator(points, 1)
    >>> list(operator.matrices), operator.matrices["D1"].shape == (2, surface.basis.size)
    (['value', 'D1', 'D2'], True)
    >>> jets = operator(surface.coefficients)  # (3, 2, 3): kind, point, coordinate
    >>> bool(np.allclose(surface.origin + jets[0], surface.evaluate(points)))
    True
    """

    matrices: dict[str, csr_array]
    origin: Floats

    __repr__ = one_line

    def __call__(self, coefficients: ArrayLike) -> Floats:
        """All jets of coefficients (size, q), as (kinds, n, q), or of a batch (..., size, q), as (..., kinds, n, q)."""
        given = np.asarray(coefficients, dtype=np.float64)
        kinds, (count, size) = len(self.matrices), self.matrices["value"].shape
        if given.ndim < 2 or given.shape[-2] != size:
            raise FitError(f"coefficients have the shape {given.shape}; give ({size}, q), or a batch (..., {size}, q)")
        batch, width = given.shape[:-2], given.shape[-1]
        side_by_side = np.moveaxis(given.reshape(-1, size, width), 0, 1).reshape(size, -1)
        found = (self.stacked @ side_by_side).reshape(kinds, count, -1, width)
        return np.asarray(np.moveaxis(found, 2, 0).reshape(*batch, kinds, count, width))

    @property
    def stacked(self) -> csr_array:
        """One matrix (kinds n, size), the matrices one below the other: for other libraries, and for least squares."""
        return csr_array(vstack(list(self.matrices.values())))


def surface_operator(surface: OrbifoldSurface, points: Points, order: int = 0) -> SurfaceOperator:
    """The operator of a surface at points, with derivatives up to order 0, 1 or 2.

    Raises FitError for another order, and for derivatives of functions that have none.
    """
    if order not in range(len(_OF_ORDER)):
        raise FitError(f"the order is {order}; give 0 for values, 1 or 2 for derivatives")
    basis = surface.basis
    if order and not isinstance(basis, DifferentiableBasis):
        raise FitError("this basis knows no derivatives; ask for order 0, or use one that does, such as 'ps6'")
    found = (
        basis.jet_matrices(points, order) if isinstance(basis, DifferentiableBasis) else [basis.design_matrix(points)]
    )
    scaled = {name: csr_array(surface.scale * matrix) for name, matrix in zip(_KINDS, found, strict=False)}
    return SurfaceOperator(scaled, surface.origin)
