"""Surface integrals: places all over a surface in space that together stand for its area."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions.basis import Basis
from orbiframe.orbifolds.atlas import Points
from orbiframe.planes.quadrature import triangle_points
from orbiframe.splines.element_basis import ElementBasis
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]

# On the triangles of the map, where functions have no triangles of their own.
_POINTS, _ON_MAP = 2, 3
# The element is taken to be no smaller than this share of its mean: where it vanishes, the surface is not immersed.
_LEAST_ELEMENT = 1e-3


class Integration(NamedTuple):
    """Points of X/H with the area that each stands for on X and on the surface in space, (n,) each.

    The sum of area times a function is its integral.
    """

    points: Points
    area_on_x: Floats
    area: Floats

    @property
    def stretch(self) -> Floats:
        """Area on X per area in space."""
        return self.area_on_x / self.area


def integration(surface: OrbifoldSurface, basis: Basis, number: int | None = None) -> Integration:
    """Gauss points for integrals of functions of a basis and of squares of their derivatives.

    Piecewise polynomials of degree d have d - 2 points along each direction of every micro triangle, and two at least,
    so that in the flat plane squares of third derivatives are integrated exactly; other functions have four points on
    each triangle of the map. number: as many along each direction instead. Surfaces scaled to unit size are meant, as
    their coefficients are.
    """
    if isinstance(basis, ElementBasis):
        geometry, micro = surface.orbifold.geometry, basis.micro_triangles
        corners = np.einsum("fij,fmcj->fmci", basis.domain.placement, micro).reshape(-1, 3, 3)
        patch, few = np.repeat(basis.domain.patch, micro.shape[1]), max(basis.degree - 2, 2)
        return _over(surface, geometry.project(corners), patch, few if number is None else number)
    return over_faces(surface, np.arange(len(surface.triangulation.lifts)), _POINTS if number is None else number)


def within(surface: OrbifoldSurface, basis: Basis, number: int) -> Integration:
    """Gauss points as `integration` has them, number along each direction; of a surface with a boundary alone.

    There they lie on the triangles of the map, whose edges the boundary is, three along each direction.
    """
    own = surface.triangulation.inside
    return integration(surface, basis, number) if own is None else over_faces(surface, np.flatnonzero(own), _ON_MAP)


def over_faces(surface: OrbifoldSurface, faces: NDArray[np.intp], number: int) -> Integration:
    """Gauss points on some triangles of the map, number along each direction, as in `integration`."""
    flat = surface.triangulation
    return _over(surface, flat.lifts[faces], flat.patch[flat.polyhedron.triangles[faces, 0]], number)


def _over(surface: OrbifoldSurface, corners: Floats, patch: NDArray[np.intp], number: int) -> Integration:
    """Gauss points on triangles of X, (m, 3, 3) in the frames of patches (m,)."""
    x, weights = triangle_points(surface.orbifold.geometry, corners, number)
    points = Points(np.repeat(patch, number**2), x.reshape(-1, 3))
    element = surface.curvature(points).element / surface.scale**2
    area_on_x = np.abs(weights).ravel()
    mean = float(area_on_x @ element) / area_on_x.sum()
    return Integration(points, area_on_x, area_on_x * np.maximum(element, _LEAST_ELEMENT * mean))
