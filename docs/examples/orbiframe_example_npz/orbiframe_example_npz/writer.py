"""Writes a polyhedron as a NumPy archive."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from orbiframe import Polyhedron


def write(path: Path, polyhedron: Polyhedron) -> None:
    """Write vertices, offsets and corners, and normals and colours where there are any; complete or not at all."""
    arrays = {"vertices": polyhedron.vertices, "offsets": polyhedron.offsets, "corners": polyhedron.tail}
    for name in ("normals", "colors", "face_colors"):
        value = getattr(polyhedron, name)
        if value is not None:
            arrays[name] = value
    unfinished = path.with_name(f".{path.name}.unfinished.npz")
    np.savez_compressed(unfinished, **arrays)
    unfinished.replace(path)
