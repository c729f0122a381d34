"""Exact patches: those of any surface that has them."""

from __future__ import annotations

from orbiframe.errors import FitError
from orbiframe.splines.element_basis import ElementBasis
from orbiframe.splines.tensor_basis import TensorBasis
from orbiframe.surfaces.periodic_patch import PeriodicPatch, periodic_patch
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.surfaces.triangle_patches import TrianglePatches, triangle_patches


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
