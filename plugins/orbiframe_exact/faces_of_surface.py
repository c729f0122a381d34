"""Faces of a surface: how many, how near, and what came out, in numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from orbiframe import OrbifoldSurface, Points
from orbiframe.meshes import blocks_near
from orbiframe_exact.creased_domain import creased_domain
from orbiframe_exact.creased_faces import CreasedFaces
from orbiframe_exact.few_faces import ANGLE, FewFaces
from orbiframe_exact.quad_domain import default_count, quad_domain

# The corners of quads of the input, as exporters are given them.
Quads = tuple[tuple[int, int, int, int], ...]


def fitted(surface: OrbifoldSurface, count: int | None = None, tolerance: float = 1e-4, quads: Quads = ()) -> FewFaces:
    """A surface as about `count` faces, within a tolerance relative to its box; as many as its topology suggests else.

    tolerance: the largest distance, as a share of the diagonal of the bounding box; quads: the faces of the input, if
    all have four corners. Blocks of them become faces where that makes about as many, and none far from square.
    """
    diagonal = diagonal_of(surface)
    wanted = count or default_count(surface)
    blocks = blocks_near(np.array(quads, dtype=np.intp), wanted) if quads else None
    domain = quad_domain(surface, wanted, blocks)
    found = FewFaces(domain, tolerance * diagonal)
    found.fit()
    return found


def fitted_between_creases(surface: OrbifoldSurface, tolerance: float = 1e-4) -> CreasedFaces:
    """A surface with creases as planes, and B-spline faces within a tolerance relative to its box, see `fitted`."""
    absolute = tolerance * diagonal_of(surface)
    found = CreasedFaces(creased_domain(surface, absolute), absolute)
    if found.domain.count:
        found.fit()
    return found


def diagonal_of(surface: OrbifoldSurface) -> float:
    """The diagonal of the box of a surface, before it is placed in space."""
    flat = surface.triangulation
    places = surface.basis.values(Points(flat.patch, flat.points), surface.coefficients)
    return float(np.linalg.norm(np.ptp(places, axis=0)))


def described(found: FewFaces, surface: OrbifoldSurface, tolerance: float) -> dict[str, Any]:
    """Faces in numbers, as plain data: faces, poles, error (of the diagonal), angle (degrees), reached, worst place.

    Of a surface with creases also how many faces are planes, and the angle is that where there is no crease.
    """
    error = max(found.error.values(), default=0.0) * tolerance / found.tolerance
    angle = float(found.angle.max(initial=0.0))
    planes = {"planes": found.domain.planes.number} if isinstance(found, CreasedFaces) else {}
    return planes | {
        "faces": found.domain.count + planes.get("planes", 0),
        "control_points": sum(poles.shape[0] * poles.shape[1] for _, poles in found.faces.values()),
        "error": error,
        "angle": angle,
        "reached": bool(error <= tolerance and angle <= ANGLE),
        "worst": (surface.origin + surface.scale * found.worst).tolist(),
    }
