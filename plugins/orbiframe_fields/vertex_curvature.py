"""Vertex curvature: how the smooth surface through the vertices of a mesh bends at each of them."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe import Notice, OrbifoldSurface, Polyhedron, Registry
from orbiframe.meshes import oriented
from orbiframe.surfaces import PrincipalCurvature, fit_field, nearest_points, principal_curvature
from orbiframe_fields.fitted_surfaces import FittedSurface

Floats = NDArray[np.float64]

_FITTER = "smoothing"
# So much of 2 pi may be missing from the total curvature.
_FOLDED = 0.02
_NUMBERS = ("k1", "k2", "gaussian", "mean", "distance")


class VertexCurvature(NamedTuple):
    """A mesh, the numbers (V,) and vectors (V, 3) at its vertices by name, and the total curvature found and known,
    with the turning of the boundary where there is one.

    k1 >= k2 and their directions, their product and mean, the unit normal, and the distance of the vertex from the
    surface. Numbers are positive where the surface bends away from its normal, as a sphere does whose normals point
    outward. They are nan at vertices in no face.
    """

    mesh: Polyhedron
    columns: dict[str, Floats]
    total: float
    expected: float


def curvature_of(mesh: Polyhedron, fitted: list[FittedSurface], registry: Registry) -> VertexCurvature:
    """The curvature at the vertices of a mesh whose components are fitted.

    The fit says where the vertices lie on X/H; then the smoothest functions with these values there are found, from
    all over the surface and as near to the vertices as cross-validation says, and the foot points of the vertices.
    """
    turned = oriented(mesh)
    count = len(mesh.vertices)
    columns: dict[str, Floats] = {name: np.full(count, np.nan) for name in _NUMBERS}
    vectors: dict[str, Floats] = {name: np.full((count, 3), np.nan) for name in ("normal", "direction1", "direction2")}
    reference, total, expected = _reference_normals(turned), 0.0, 0.0
    for each in fitted:
        surface = _surface(each, registry)
        feet, distance = nearest_points(surface, each.part.vertices)
        bent = inward(principal_curvature(surface, feet), reference[each.vertices])
        numbers = bent.most, bent.least, bent.most * bent.least, (bent.most + bent.least) / 2, distance
        for column, values in zip(columns.values(), numbers, strict=True):
            column[each.vertices] = values
        arrows = -bent.normal, bent.along_most, bent.along_least
        for column, values in zip(vectors.values(), arrows, strict=True):
            column[each.vertices] = values
        total += surface.total_curvature() + surface.boundary_turning()
        expected += 2 * math.pi * (len(each.vertices) - each.part.edge_count + each.part.face_count)
    if abs(total - expected) > _FOLDED * 2 * math.pi * len(fitted):
        warnings.warn(
            f"the total curvature is {total:.6g}, and by Gauss and Bonnet {expected:.6g}: the surface folds somewhere, "
            "most likely where the mesh is coarse for its shape, and numbers there are not to be trusted; refine the "
            "mesh there, or raise basis.size",
            Notice,
            stacklevel=2,
        )
    ordered = {"normal": vectors.pop("normal"), **columns, **vectors}
    return VertexCurvature(turned, ordered, total, expected)


def through_vertices(surface: OrbifoldSurface, vertices: Floats, registry: Registry) -> OrbifoldSurface:
    """The surface of the same functions that goes through the vertices, as smooth as it can be, where they lie now."""
    fitter = registry.load("fitter", _FITTER)()
    feet = nearest_points(surface, vertices)[0]
    wanted = (vertices - surface.origin) / surface.scale
    field = fit_field(surface, feet, wanted, fitter=fitter)
    moved = surface.origin + surface.scale * field.shift
    return replace(surface, coefficients=field.coefficients * field.scale, origin=moved)


def inward(bent: PrincipalCurvature, outward: Floats) -> PrincipalCurvature:
    """The curvature with normals against the directions (n, 3) that are outward."""
    return bent.turned(np.where(np.einsum("ni,ni->n", bent.normal, outward) > 0, -1.0, 1.0))


def _reference_normals(mesh: Polyhedron) -> Floats:
    """At each vertex the normal of its largest face, (V, 3): on a nonorientable surface there is none of all faces."""
    following, corner = mesh.vertices[mesh.head], mesh.vertices[mesh.tail]
    first = mesh.vertices[mesh.tail[mesh.offsets[:-1]]][mesh.face]
    area = np.zeros((mesh.face_count, 3))
    np.add.at(area, mesh.face, np.cross(corner - first, following - first) / 2)
    order = np.argsort(np.linalg.norm(area, axis=1)[mesh.face], kind="stable")
    found = np.zeros((len(mesh.vertices), 3))
    found[mesh.tail[order]] = area[mesh.face[order]]
    return found


def _surface(fitted: FittedSurface, registry: Registry) -> OrbifoldSurface:
    """The surface through the vertices; where facets count too, the one that was fitted to them."""
    if fitted.means == "smooth":
        return through_vertices(fitted.surface, fitted.part.vertices, registry)
    warnings.warn(
        "the mesh has sharp edges, where curvature has no limit: the numbers there are those of a rounded surface and "
        "change with the option size; if its vertices lie on a smooth surface, add --set data.means=smooth",
        Notice,
        stacklevel=3,
    )
    return fitted.surface
