"""Reader: the polygons of a file that meshio can read."""

from __future__ import annotations

from pathlib import Path

from orbiframe import Polyhedron
from orbiframe.files import confined_read


def read(path: Path, *, seconds: float = 60.0) -> Polyhedron:
    """The triangles, quads and polygons of a file, read by meshio in a process of its own.

    seconds: the most time that it may take for a small file; each megabyte adds a second. Lines and points are left
    out. Raises FormatError where meshio fails, warns or ends its process, for solid cells, and for XML files with
    entities.
    """
    return confined_read("orbiframe_meshio.cells:polyhedron_of", path, seconds=seconds)
