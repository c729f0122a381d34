"""Faces of a surface: how many, how near, and what came out, in numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from orbiframe import OrbifoldSurface, Points
from orbiframe_exact.few_faces import ANGLE, FewFaces
from orbiframe_exact.quad_domain import default_count, quad_domain


def fitted(surface: OrbifoldSurface, count: int | None = None, tolerance: float = 1e-4) -> FewFaces:
    """A surface as about `count` faces, within a tolerance relative to its box; as many as its topology suggests else.

    tolerance: the largest distance, as a share of the diagonal of the bounding box.
    """
    flat = surface.triangulation
    places = surface.basis.values(Points(flat.patch, flat.points), surface.coefficients)
    diagonal = float(np.linalg.norm(np.ptp(places, axis=0)))
    domain = quad_domain(surface, count or default_count(surface))
    found = FewFaces(domain, tolerance * diagonal)
    found.fit()
    return found


def described(found: FewFaces, surface: OrbifoldSurface, tolerance: float) -> dict[str, Any]:
    """Faces in numbers, as plain data: faces, poles, error (of the diagonal), angle (degrees), reached, worst place."""
    error = max(found.error.values()) * tolerance / found.tolerance
    angle = float(found.angle.max())
    return {
        "faces": found.domain.count,
        "control_points": sum(poles.shape[0] * poles.shape[1] for _, poles in found.faces.values()),
        "error": error,
        "angle": angle,
        "reached": bool(error <= tolerance and angle <= ANGLE),
        "worst": (surface.origin + surface.scale * found.worst).tolist(),
    }
