"""Writer: a triangulated polyhedron to a file that Open3D can write."""

from __future__ import annotations

import warnings
from pathlib import Path

from orbiframe import Polyhedron
from orbiframe.files import confined_write, require_triangles

# Open3D takes address space for its threads.
MEMORY = 2**33


def write(path: Path, polyhedron: Polyhedron, *, seconds: float = 60.0) -> None:
    """Write triangles and the normals of their vertices, as float32.

    seconds: the most time that it may take for a small file; each megabyte adds a second. Raises FormatError for faces
    that are no triangles, and where Open3D fails; PluginError where it is not installed or lacks a system library.
    Colours are left out, with a warning.
    """
    require_triangles(path, polyhedron)
    if any(table is not None for table in (polyhedron.colors, polyhedron.face_colors)):
        warnings.warn(f"{path.name}: colours are left out; PLY keeps them", stacklevel=2)
    confined_write("orbiframe_open3d.triangles:save", path, polyhedron, seconds=seconds, memory=MEMORY)
