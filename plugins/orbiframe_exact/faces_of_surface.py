"""Faces of a surface: how many, how near, and what came out, in numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from orbiframe import OrbifoldSurface, Points
from orbiframe.meshes import blocks_near
from orbiframe_exact.few_faces import ANGLE, FewFaces
from orbiframe_exact.quad_domain import default_count, quad_domain

# The corners of quads of the input, as exporters are given them.
Quads = tuple[tuple[int, int, int, int], ...]


def fitted(surface: OrbifoldSurface, count: int | None = None, tolerance: float = 1e-4, quads: Quads = ()) -> FewFaces:
    """A surface as about `count` faces, within a tolerance relative to its box; as many as its topology suggests else.

    tolerance: the largest distance, as a share of the diagonal of the bounding box; quads: the faces of the input, if
    all have four corners. Blocks of them become faces where that makes about as many, and none far from square.
    """
    flat = surface.triangulation
    places = surface.basis.values(Points(flat.patch, flat.points), surface.coefficients)
    diagonal = float(np.linalg.norm(np.ptp(places, axis=0)))
    wanted = count or default_count(surface)
    blocks = blocks_near(np.array(quads, dtype=np.intp), wanted) if quads else None
    domain = quad_domain(surface, wanted, blocks)
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
