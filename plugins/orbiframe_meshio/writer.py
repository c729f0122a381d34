"""Writer: a polyhedron to a file that meshio can write."""

from __future__ import annotations

import warnings
from pathlib import Path

from orbiframe import Polyhedron
from orbiframe.files import confined_write


def write(path: Path, polyhedron: Polyhedron, *, seconds: float = 60.0) -> None:
    """Write the polygons and read them again, so that nothing is lost unsaid.

    seconds: the most time that it may take for a small file; each megabyte adds a second. Raises FormatError for
    polygons that the format cannot hold. Normals and colours are left out, with a warning.
    """
    if any(table is not None for table in (polyhedron.normals, polyhedron.colors, polyhedron.face_colors)):
        warnings.warn(f"{path.name}: normals and colours are left out; PLY keeps them", stacklevel=2)
    confined_write("orbiframe_meshio.cells:save", path, polyhedron, seconds=seconds)
