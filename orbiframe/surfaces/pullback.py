"""Pullbacks: how a number that depends on points of a surface depends on its coefficients, and on the parameters."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import FitError
from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def surface_values(surface: OrbifoldSurface, coefficients: Floats, patch: Ints, x: Floats) -> Floats:
    """The points (n, q) of a surface with other coefficients (size, q), over x / rho(x) for x (n, 3)."""
    on_x = np.asarray(surface.orbifold.geometry.project(x))
    return np.asarray(surface.origin + surface.scale * surface.basis.values(Points(patch, on_x), coefficients))


def pulled_back(
    surface: OrbifoldSurface, coefficients: Floats, patch: Ints, x: Floats, slopes: Floats
) -> tuple[Floats, Floats]:
    """The derivatives by the coefficients (size, 3) and by x (n, 3) of a number with the derivatives slopes (n, 3).

    slopes: by the points of `surface_values`. Those by x are covectors of R^3 and vanish along x, as moving along a ray
    moves no point of X.
    """
    geometry = surface.orbifold.geometry
    on_x = np.asarray(geometry.project(x))
    jets = require_slopes(surface).jet_matrices(Points(patch, on_x), 1)
    scaled = surface.scale * slopes
    along = np.stack([np.einsum("ni,ni->n", scaled, matrix @ coefficients) for matrix in jets[1:]], axis=1)
    covectors = np.swapaxes(geometry.frame(on_x), 1, 2) * [geometry.curvature, 1.0, 1.0]
    if geometry.curvature == 0:
        covectors[:, :, 0] -= np.einsum("nki,ni->nk", covectors, on_x)
    # rho(x), from a coordinate that is not 0.
    largest = np.abs(on_x).argmax(axis=1)[:, None]
    rho = np.take_along_axis(x, largest, axis=1) / np.take_along_axis(on_x, largest, axis=1)
    return np.asarray(jets[0].T @ scaled), np.einsum("nk,nki->ni", along, covectors) / rho


def require_slopes(surface: OrbifoldSurface) -> DifferentiableBasis:
    """The basis. Raises FitError for one without derivatives."""
    if not isinstance(surface.basis, DifferentiableBasis):
        raise FitError("this basis knows no derivatives, which gradients need; use one that does, such as 'ps6'")
    return surface.basis
