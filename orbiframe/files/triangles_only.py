"""Triangles only: what formats without larger faces say of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from orbiframe.errors import FormatError
from orbiframe.meshes.polyhedron import Polyhedron


def require_triangles(path: Path, polyhedron: Polyhedron, format: str = "this format") -> None:
    """Raise FormatError, with the first larger face and their number, unless every face is a triangle.

    path, format: the file and the name of its format, for the message.
    """
    larger = np.flatnonzero(polyhedron.face_sizes != 3)
    if len(larger):
        raise FormatError(
            f"{path}: {format} holds triangles only, but face {larger[0]} has {polyhedron.face_sizes[larger[0]]} "
            f"corners ({len(larger)} such faces); write OFF, OBJ or PLY, or triangulate it first (convert "
            "--triangulate)"
        )
