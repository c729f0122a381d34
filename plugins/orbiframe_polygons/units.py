"""Units of length: a format that has one gets its coordinates in it."""

from __future__ import annotations

import warnings
from pathlib import Path

from orbiframe import Notice, Polyhedron


def in_unit(path: Path, polyhedron: Polyhedron, unit: str) -> Polyhedron:
    """The polyhedron in the unit of a format, with a notice where it was in another one; in none, it stays as it is."""
    if polyhedron.unit in (None, unit):
        return polyhedron
    factor = 1000.0 if unit == "millimetre" else 1e-3
    warnings.warn(
        f"{path.name}: coordinates are converted from {polyhedron.unit}s to {unit}s (times {factor:g})",
        Notice,
        stacklevel=3,
    )
    return polyhedron.with_vertices(factor * polyhedron.vertices, polyhedron.normals)
