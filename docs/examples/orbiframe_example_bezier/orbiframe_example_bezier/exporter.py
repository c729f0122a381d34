"""The exact patches of a surface as JSON: degree, control points and weights."""

from __future__ import annotations

import json
from pathlib import Path

from orbiframe import OrbifoldSurface
from orbiframe.surfaces import PeriodicPatch, patches_of


def export(path: Path, surface: OrbifoldSurface) -> None:
    """Rational Bezier triangles, or quadrilaterals of a tensor product, with all digits.

    Raises FitError for functions that have no exact patches.
    """
    patches = patches_of(surface)
    shape = "triangle"
    if isinstance(patches, PeriodicPatch):
        patches, shape = patches.quadrilaterals(), "quadrilateral"
    content = {
        "shape": shape,
        "degree": patches.degree,
        "points": patches.points.tolist(),
        "weights": patches.weights.tolist(),
    }
    path.write_text(json.dumps(content), encoding="ascii")
